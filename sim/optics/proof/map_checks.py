"""The map of sensitivity against small dents that are rendered.

A ball of 6 mm pressed 0.1 mm deep touches the skin within a = sqrt(R d) = 0.55 mm. The skin is
moved by Hertz's profile of a half space, slope r / R inside and falling off outside,

    u = d (1 - r^2 / (2 a^2))                                                 for r <= a
    u = d / pi ((2 - r^2 / a^2) asin(a / r) + sqrt(r^2 / a^2 - 1))              for r > a,

and the mean change of the pixels that see the contact, before rounding, is compared with what the
map says there. Source: Johnson, Contact Mechanics, eq. 3.42. The map leaves out shadows and rim.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.optics.field.bake import bake_light
from sim.optics.maps import signal
from sim.optics.maps.display_light import display_light
from sim.optics.proof.specimen import finger
from sim.optics.studio.render import Studio
from workbench.core.design.lighting import LightModel
from workbench.core.design.optics import Optics
from workbench.core.result.results import Skin

EDGE_MM = 0.2
"""Edges of the skin: three in a contact radius."""
REACH = 6.0
"""Radius in contact radii beyond which the dent ends [1]; Hertz leaves 7 % of its depth there."""
LOWEST_MM, NEAREST_MM = 6.0, 5.0
"""Least height of a dent, and least distance between two [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SensitivityCheck:
    """Mean changes at some places [grey level]."""

    mapped: np.ndarray
    """By the map, shape (N,)."""
    rendered: np.ndarray
    """By images, shape (N,)."""

    @property
    def correlation(self) -> float:
        """Pearson's, over the places [1]."""
        return float(np.corrcoef(self.mapped, self.rendered)[0, 1])

    @property
    def ratio(self) -> float:
        """Sum of the rendered over sum of the mapped [1]."""
        return float(self.rendered.sum() / self.mapped.sum())


def sensitivity_check(*, places: int = 10, seed: int = 4) -> SensitivityCheck:
    """The default finger under the `direct` model, at random places that its camera sees."""
    mesh, optics = finger(edge_mm=EDGE_MM), Optics(light_model=LightModel("direct"))
    light = bake_light(mesh, optics.ring, model=LightModel("direct"))
    studio, sensor = Studio(mesh, light, optics), optics.camera.sensor

    skin = mesh.seen
    jacobian = signal.tilt_jacobian(display_light(studio, optics.camera), -skin.normals, sensor)
    mapped = signal.sensitivity_grey(jacobian, signal.dent_slope_deg(signal.DENT_MM))
    radius_mm = float(np.sqrt(signal.BALL_RADIUS_MM * signal.DENT_MM))
    seen_mm = _seen_mm(studio)
    rest = signal.grey(
        studio.exposure * studio.linear(np.zeros((1, *skin.points_mm.shape))), sensor
    )
    found = []
    for vertex in _places(skin, studio.visible, places, seed):
        place = skin.points_mm[vertex]
        moved = hertz_dent(skin, vertex, radius_mm)
        image = signal.grey(studio.exposure * studio.linear(moved[None]), sensor)
        inside = np.linalg.norm(seen_mm - place, axis=1) < radius_mm
        change = np.abs(image - rest).reshape(-1, 3)[inside]
        near = np.linalg.norm(skin.points_mm - place, axis=1) < radius_mm
        found.append((float(mapped[near].mean()), float(change.mean())))
    mapped_at, rendered = np.array(found).T
    return SensitivityCheck(mapped=mapped_at, rendered=rendered)


def hertz_dent(skin: Skin, vertex: int, radius_mm: float) -> np.ndarray:
    """Displacement about a vertex [mm], shape (V, 3), float32, for a contact radius."""
    place, normal = skin.points_mm[vertex], skin.normals[vertex]
    share = np.linalg.norm(skin.points_mm - place, axis=1) / radius_mm
    outer = np.maximum(share, 1.0)
    falling = (2.0 - outer**2) * np.arcsin(1.0 / outer) + np.sqrt(outer**2 - 1.0)
    height = np.where(share <= 1.0, 1.0 - share**2 / 2.0, falling / np.pi)
    # Faded to nothing between half the reach and the reach, so that no step is left.
    height *= np.clip(2.0 - 2.0 * share / REACH, 0.0, 1.0)
    return (-signal.DENT_MM * height[:, None] * normal).astype(np.float32)


def _places(skin: Skin, visible: np.ndarray, count: int, seed: int) -> list[int]:
    """Seen vertices away from the base and from each other."""
    random = np.random.default_rng(seed)
    chosen: list[int] = []
    for vertex in random.permutation(np.flatnonzero(visible & (skin.points_mm[:, 2] > LOWEST_MM))):
        gaps = np.linalg.norm(skin.points_mm[chosen] - skin.points_mm[vertex], axis=1)
        if len(chosen) < count and (gaps > NEAREST_MM).all():
            chosen.append(int(vertex))
    return chosen


def _seen_mm(studio: Studio) -> np.ndarray:
    """Where each pixel's ray meets the skin at rest [mm], shape (N, 3); NaN where it misses."""
    view = studio.imager.raster.view
    has = np.diff(view.layer_start) > 0
    away = np.full(len(has), np.nan)
    away[has] = view.layer_mm[view.layer_start[:-1][has]]
    return view.origin_mm + away[:, None] * view.direction
