"""Light that a bake leaves on the skin, against straight lines, direct shading and photons.

Each check returns what was found over what is exact, as in `transport_checks`.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from geometry.surface.surface import vertex_areas_mm2
from sim.optics.field.bake import light_field
from sim.optics.field.gathered import gathered
from sim.optics.field.lines import toward
from sim.optics.field.model import Baked, Lights
from sim.optics.field.table import look_up, tabulate
from sim.optics.light.coating import glossy
from sim.optics.light.lights import place_leds
from sim.optics.light.lobe import emitted
from sim.optics.proof.specimen import finger
from sim.optics.proof.transport_scenes import BLACK
from sim.optics.transport.gather import gather_light
from sim.optics.transport.paths import Photons
from sim.optics.transport.radiance import trace_radiance
from sim.optics.transport.view import directions_to_camera
from workbench.core.base.monitor import silent
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import Baking, LedMount, LedRing, LightModel
from workbench.core.design.optics import Coating, Transport


def virtual_light_errors(*, photons: int = 1_000_000) -> tuple[float, float]:
    """Virtual LEDs of cavity lights at index 1 against the straight line.

    Median relative difference of irradiance, and median angle [degree], where the skin is lit by
    at least a tenth of the mean.
    """
    mesh = finger(edge_mm=1.0)
    ring = LedRing(count=3, size_mm=0.2, tilt_deg=20.0)
    leds = place_leds(ring)
    transport = Transport(
        coating=BLACK, refractive_index=1.0, baking=Baking(photons=photons, nodes=1500)
    )
    direction, irradiance, _ = gather_light(mesh, leds, transport)
    differences, angles = [], []
    for number, place in enumerate(leds.position_mm):
        line = place - mesh.seen.points_mm
        square = (line**2).sum(axis=1)
        line /= np.sqrt(square)[:, None]
        # Lambert's law: cos / (pi r^2) of an LED of power 1.
        exact = np.maximum(-line @ leds.axis[number], 0.0) / (np.pi * square)
        lit = exact > 0.1 * exact.mean()
        differences.append(np.abs(irradiance[number, lit] / exact[lit] - 1.0))
        cosine = np.einsum("ij,ij->i", direction[number, lit], line[lit])
        angles.append(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
    return float(np.median(np.concatenate(differences))), float(np.median(np.concatenate(angles)))


def direct_table_errors(*, photons: int = 1_000_000) -> tuple[float, float]:
    """The table of unscattered light at index 1 and the undeformed normal against direct shading.

    Root mean square difference of radiance over its root mean square, which is mostly noise of the
    photons at each node, and the relative difference of the means, which is not. Where the skin is
    lit, for a matte coating (the table's bins widen a glossy lobe) and nodes as fine as the skin:
    nodes 2 mm apart alone make 6 % beside an LED.
    """
    mesh, camera = finger(edge_mm=1.0), Camera()
    coating = Coating(specular=0.0)
    leds = place_leds(LedRing(count=3, size_mm=0.2, tilt_deg=20.0))
    transport = Transport(
        coating=coating, refractive_index=1.0, baking=Baking(photons=photons, nodes=5000)
    )
    direction, irradiance, scattered = gather_light(mesh, leds, transport)
    alone = dataclasses.replace(scattered, rest=np.zeros_like(scattered.rest))
    light = light_field(
        leds,
        LightModel("table"),
        Baked(direction=direction, irradiance=irradiance, scattered=alone),
    )
    table = tabulate(light, mesh, (camera,), transport, model=LightModel("table"))
    normals = -mesh.seen.normals
    found = look_up(table.values[0], alone.nodes, alone.weights, alone.frame, normals)
    points = mesh.seen.points_mm
    view = directions_to_camera(points, mesh, camera, 1.0)
    exact = np.zeros_like(found)
    for number, place in enumerate(leds.position_mm):
        line, distance = toward(place, points)
        cone, exponent = float(leds.cone[number]), float(leds.exponent[number])
        received = emitted(line, distance, axis=leds.axis[number], exponent=exponent, cone=cone)
        share = glossy(coating, line, normals, view) * received
        exact += share[:, None] * leds.rgb[number]
    # The base's last row and the shadow's edge lie between lit and unlit nodes.
    lit = (points[:, 2] > 3.0) & (exact.sum(axis=1) > 0.1 * exact.sum(axis=1).mean())
    rms = np.sqrt(np.mean((found - exact)[lit] ** 2) / np.mean(exact[lit] ** 2))
    return float(rms), float(abs(found[lit].mean() / exact[lit].mean() - 1.0))


def table_error(*, in_shell: bool, photons: int = 1_000_000) -> float:
    """The table of all light at rest against photons gathered toward the camera.

    Relative difference of the mean radiance above the base, refraction and all orders of scattering
    included.
    """
    mesh, camera = finger(edge_mm=1.0), Camera()
    mount, radius_mm = (LedMount.SHELL, 12.5) if in_shell else (LedMount.CAVITY, 9.0)
    leds = place_leds(LedRing(count=3, mount=mount, radius_mm=radius_mm))
    transport = Transport(
        coating=Coating(), refractive_index=1.41, baking=Baking(photons=photons, nodes=5000)
    )
    lights = Lights(mesh=mesh, leds=leds, fields=(), transport=transport)
    light = light_field(leds, LightModel("table"), gathered(lights, silent))
    table = tabulate(light, mesh, (camera,), transport, model=LightModel("table"))
    scattered = light.scattered
    assert scattered is not None
    places = scattered.nodes, scattered.weights, scattered.frame
    found = look_up(table.values[0], *places, -mesh.seen.normals)
    others = Photons(count=photons, seed=transport.baking.seed, first=photons)
    traced = trace_radiance(mesh, leds, camera, transport, others)
    exact = traced.radiance * (len(leds.rgb) / traced.photons)
    share = vertex_areas_mm2(mesh.seen.points_mm, mesh.seen.faces) * (
        mesh.seen.points_mm[:, 2] > 3.0
    )
    return float(abs(share @ found.sum(axis=1) / (share @ exact.sum(axis=1)) - 1.0))
