"""Photons to a light field: scattered light by direction, and one virtual LED per light.

Each photon that meets the coating adds flux / cosine to the three nodes about its place. Divided by
the nodes' areas that is perpendicular irradiance by direction. Of light that nothing but clear
walls has turned, the sum of direction times flux gives a mean direction per node and light: there,
as far away as the real one, stands a virtual LED, which carries refraction without tracing it
again. Sums are smoothed over neighbouring nodes; a spot sees its LED in one direction anyhow.
"""

from __future__ import annotations

import numpy as np

from sim.optics.light.lights import Leds
from sim.optics.transport.constants import FIXED_POINT
from sim.optics.transport.nodes import Nodes, coarse_nodes, neighbours
from sim.optics.transport.paths import Driver, Photons, trace_paths
from sim.optics.transport.scene import open_scene
from sim.optics.transport.smoothing import smoothed_bins
from sim.optics.transport.sources import Sources, open_sources
from sim.optics.transport.tally import Tally, tally_at_nodes
from workbench.core.base.monitor import Monitor, part, silent
from workbench.core.design.optics import Transport
from workbench.core.result.light import Scattered
from workbench.core.result.results import MembraneMesh

SMOOTHINGS = 1
"""Times that the virtual LEDs are averaged with their neighbours. Against photons, 1 is as good as
0 in dents and at rest, and leaves fewer specks where few photons come; 3 blurs the light beside
the LEDs by 0.7 to 0.9 % of the mean more, 6 by 2 %."""


def gather_light(
    mesh: MembraneMesh,
    leds: Leds,
    transport: Transport,
    *,
    driver: Driver | None = None,
    monitor: Monitor = silent,
) -> tuple[np.ndarray, np.ndarray, Scattered]:
    """Trace the photons of a bake.

    Args:
        mesh: The skins.
        leds: The lights.
        transport: What photons meet, and how many there are.
        driver: None takes the one for the open device.

    Returns:
        Unit vectors from the vertices toward their virtual LEDs, shape (L, V, 3), float32;
        perpendicular irradiance there per unit of power [1/mm2], shape (L, V), float32; the light
        by direction.
    """
    baking = transport.baking
    monitor(0.0, "placing nodes on the skin")
    nodes = coarse_nodes(mesh.seen, baking.nodes)
    scene = open_scene(mesh, transport)
    sources = open_sources(leds, scene)
    tally = tally_at_nodes(nodes, sources.count)
    photons = Photons(count=baking.photons, seed=baking.seed, driver=driver)
    trace_paths(scene, sources, tally, photons, monitor=part(monitor, 0.05, 0.95))
    direction, irradiance = virtual_lights(nodes, sources, tally, mesh.seen.points_mm)
    monitor(1.0, "light gathered")
    return direction, irradiance, scattered_light(nodes, sources, tally)


def scattered_light(nodes: Nodes, sources: Sources, tally: Tally) -> Scattered:
    """The tally's light by direction as perpendicular irradiance."""
    # One photon carries the power of its light over the photons of that light.
    unit = sources.strongest * sources.count / tally.photons / FIXED_POINT
    area = np.maximum(nodes.area_mm2, 1e-9)[:, None, None]
    links = neighbours(nodes)
    first, rest = (
        smoothed_bins((sums * (unit / area)).astype(np.float32), nodes.frame, links)
        for sums in tally.bins
    )
    return Scattered(
        frame=nodes.frame,
        first=first,
        rest=rest,
        nodes=nodes.nodes,
        weights=nodes.weights,
        balance=tally.balance,
        photons=tally.photons,
    )


def virtual_lights(
    nodes: Nodes,
    sources: Sources,
    tally: Tally,
    points_mm: np.ndarray,
    *,
    smoothings: int = SMOOTHINGS,
) -> tuple[np.ndarray, np.ndarray]:
    """Direction (L, V, 3) and irradiance (L, V) per unit of power at the vertices.

    Args:
        points_mm: The vertices [mm], shape (V, 3); where no light arrives, its direction is the
            straight one.
    """
    unit = sources.count / tally.photons / FIXED_POINT
    sums = tally.lamps * (unit / np.maximum(nodes.area_mm2, 1e-9))[:, None, None]
    spread = neighbours(nodes)
    flat = sums.reshape(len(sums), -1)
    for _ in range(smoothings):
        flat = spread @ flat
    sums = flat.reshape(sums.shape)
    direction = np.empty((sources.count, len(points_mm), 3), dtype=np.float32)
    irradiance = np.empty((sources.count, len(points_mm)), dtype=np.float32)
    # Light by light: 512 lights on 50,000 vertices at once would take 3 GB.
    for number, place in enumerate(sources.position_mm):
        here = np.einsum("vk,vkc->vc", nodes.weights, sums[nodes.nodes, number])
        straight = place - points_mm
        straight /= np.linalg.norm(straight, axis=1, keepdims=True)
        size = np.linalg.norm(here[:, :3], axis=1)
        lit = size > 0.0
        mean = here[:, :3] / np.where(lit, size, 1.0)[:, None]
        direction[number] = np.where(lit[:, None], mean, straight)
        # The length of the vector sum: what a matte skin receives along it.
        irradiance[number] = size
    return direction, irradiance
