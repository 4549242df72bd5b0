"""Radiance of the skin for tilted normals: traced light collapsed to a table per node and camera.

At a node the light by direction E(w) (perpendicular irradiance) becomes, for each unit normal m in
the table, the radiance L(m) = sum over w of E(w) f(w, v, m) (w . m), with the coating f and the
direction v to the camera. A deformed skin then needs one look-up per vertex.

Horizon fill: a tilted normal sees directions below the undeformed tangent plane, where no light was
gathered. What lies there is the skin next to it, taken as a matte wall that receives what the node
receives: radiance R E0 / pi with the mean reflectance R of the coating and the irradiance E0.

Leaves out: that the deformed skin shadows its own light (the model `hybrid` adds that for the
lights), and that the light by direction changes when the skin moves.
Source: measured against photons in the project's study of light models.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np

from sim.optics.field.model import Shading, model_of
from sim.optics.light.bins import bin_cosines, sharpened
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LightModel
from workbench.core.design.optics import Coating, Transport
from workbench.core.result.light import (
    AZIMUTHS,
    FLATTEST,
    TILT_SPAN,
    TILTS,
    LightField,
    NormalTable,
)
from workbench.core.result.results import MembraneMesh

if TYPE_CHECKING:
    from collections.abc import Sequence

HORIZON = (0.0, -0.06, -0.15, -0.3, -0.5, -0.75, -1.0)
"""Borders of the bins of direction below the horizon, in the cosine to n."""
NODES_AT_ONCE = 500
"""Nodes collapsed between two reports of progress: about 0.2 s on two cores."""


def tabulate(
    light: LightField,
    mesh: MembraneMesh,
    cameras: Sequence[Camera],
    transport: Transport,
    *,
    model: LightModel,
    monitor: Monitor = silent,
) -> NormalTable:
    """The table of a baked light for each camera.

    Args:
        light: With `scattered` light.
        mesh: The skins.
        cameras: The cameras; one table each.
        transport: Coating and refractive index.
        model: One with virtual LEDs leaves out what these give.

    Raises:
        ValueError: If the light field has no scattered light.
    """
    from sim.optics.field.table_kernels import collapse as collapse_nodes
    from sim.optics.transport.view import directions_to_camera

    scattered = light.scattered
    if scattered is None:
        raise ValueError(f"the light field {light.model!r} has no scattered light to tabulate")
    whole = scattered.first + scattered.rest
    gathered = scattered.rest if model_of(model).shading is Shading.HYBRID else whole
    received = filled(gathered, whole, transport.coating)
    directions = bin_directions().astype(np.float32)
    coating = transport.coating
    shape = (len(cameras), len(received), TILTS, TILTS, 3)
    values = np.empty(shape, dtype=np.float32)
    places = node_places(mesh, scattered.nodes, scattered.weights, len(received))
    for number, camera in enumerate(cameras):
        index = transport.refractive_index
        away = directions_to_camera(places, mesh, camera, index)
        views = np.einsum("nij,nj->ni", scattered.frame, away).astype(np.float32)
        for start in range(0, len(received), NODES_AT_ONCE):
            done = (number + start / len(received)) / len(cameras)
            monitor(done, "table of radiance by tilt")
            part = slice(start, start + NODES_AT_ONCE)
            lobes = coating.albedo, coating.specular, coating.roughness
            light_of_part = np.ascontiguousarray(received[part])
            collapse_nodes(light_of_part, directions, views[part], *lobes, values[number, part])
    monitor(1.0, "table ready")
    return NormalTable(values=values)


def node_places(
    mesh: MembraneMesh, nodes: np.ndarray, weights: np.ndarray, count: int
) -> np.ndarray:
    """Where each node lies [mm], shape (N, 3): at the vertex of the skin that it weighs most in."""
    order = np.argsort(weights, axis=None, kind="stable")
    best = np.zeros(count, dtype=np.int64)
    # Later entries overwrite earlier ones, so each node keeps the vertex of greatest weight.
    best[nodes.ravel()[order]] = order // 3
    return mesh.seen.points_mm[best]


@functools.cache
def bin_directions() -> np.ndarray:
    """Unit directions of all bins in a node's frame, then of those below it, shape (D, 3)."""
    below = 0.5 * (np.array(HORIZON)[1:] + np.array(HORIZON)[:-1])
    cosine = np.repeat(np.concatenate([bin_cosines(), below]), AZIMUTHS)
    azimuth = np.tile(2.0 * np.pi * np.arange(AZIMUTHS) / AZIMUTHS, len(cosine) // AZIMUTHS)
    sine = np.sqrt(1.0 - cosine**2)
    return np.column_stack([sine * np.cos(azimuth), sine * np.sin(azimuth), cosine])


def filled(gathered: np.ndarray, whole: np.ndarray, coating: Coating) -> np.ndarray:
    """Light by direction with the horizon fill behind it, shape (N, 3, D), float32.

    Args:
        gathered: Light that the table shall show, shape (N, 3, B).
        whole: All light, which the neighbouring skin reflects, shape (N, 3, B).
        coating: Of the skin.
    """
    cosines = np.repeat(bin_cosines(), AZIMUTHS)
    matte = mean_reflectance(coating) / np.pi * (whole @ cosines)
    solid_angle = np.repeat(-np.diff(HORIZON), AZIMUTHS) * 2.0 * np.pi / AZIMUTHS
    below = matte[:, :, None] * solid_angle
    return np.concatenate([sharpened(gathered), below], axis=2, dtype=np.float32)


def mean_reflectance(coating: Coating) -> float:
    """Share of diffuse light that the coating returns: both lobes, averaged over the hemisphere.

    Schlick's reflectance averages to F0 + (F90 - F0) / 21 over cosine-weighted directions.
    """
    edge_on = min(1.0, 50.0 * coating.specular)
    glossy_share = coating.specular + (edge_on - coating.specular) / 21.0
    return min(coating.albedo * (1.0 - coating.specular) + glossy_share, 1.0)


def look_up(
    values: np.ndarray,
    nodes: np.ndarray,
    weights: np.ndarray,
    frame: np.ndarray,
    normals: np.ndarray,
) -> np.ndarray:
    """Radiance at vertices for unit normals into the sensor, shape (V, 3).

    Args:
        values: The table of one camera, shape (N, TILTS, TILTS, 3).
        nodes: Three nodes of each vertex, shape (V, 3).
        weights: Their weights, shape (V, 3).
        frame: Rows t, b, n of the nodes, shape (N, 3, 3).
        normals: Deformed unit normals, shape (V, 3).
    """
    tilt = np.einsum("vkij,vj->vki", frame[nodes][:, :, :2], normals)
    place = np.clip((tilt / TILT_SPAN + 1.0) * 0.5 * (TILTS - 1), 0.0, TILTS - 1.001)
    low = place.astype(np.int64)
    high_share = place - low
    total = np.zeros((len(normals), 3))
    for i in (0, 1):
        for j in (0, 1):
            across = high_share[..., 0] if i else 1.0 - high_share[..., 0]
            along = high_share[..., 1] if j else 1.0 - high_share[..., 1]
            found = values[nodes, low[..., 0] + i, low[..., 1] + j]
            total += np.einsum("vk,vkc->vc", weights * across * along, found)
    return total


def tilted_normals() -> np.ndarray:
    """Unit normals of the table's entries in the node's frame, shape (TILTS, TILTS, 3)."""
    steps = np.linspace(-TILT_SPAN, TILT_SPAN, TILTS)
    x, y = np.meshgrid(steps, steps, indexing="ij")
    flat = x**2 + y**2
    back = np.sqrt(np.minimum((1.0 - FLATTEST) / np.maximum(flat, 1e-12), 1.0))
    x, y = x * back, y * back
    return np.stack([x, y, np.sqrt(1.0 - x**2 - y**2)], axis=-1)


def collapse(
    received: np.ndarray,
    views: np.ndarray,
    coating: Coating,
) -> np.ndarray:
    """Plain twin of the kernel `collapse`: shape (N, TILTS, TILTS, 3).

    Args:
        received: Perpendicular irradiance, shape (N, 3, D).
        views: Toward the camera in each node's frame, shape (N, 3).
        coating: Of the skin.
    """
    from sim.optics.light.coating import glossy

    toward = bin_directions()
    values = np.zeros((len(received), TILTS, TILTS, 3))
    for (row, column), normal in zip(
        np.ndindex(TILTS, TILTS), tilted_normals().reshape(-1, 3), strict=True
    ):
        for node, view in enumerate(views):
            same = np.broadcast_to(normal, toward.shape), np.broadcast_to(view, toward.shape)
            share = glossy(coating, toward, *same)
            values[node, row, column] = received[node] @ share
    return values
