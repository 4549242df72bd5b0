"""The paper's fields along the skin against the curves in which their planes cut the mesh.

The published way: a plane through light and target is cut with the triangles, and the chord of the
curve at the target is its tangent ("Offline light field generation"). The plane's second direction
n is computed here apart from the models: the skin's normal at the target (P = n x L of the paper),
(x_S, y_S, 0) of the released code, or the skin's normal at the light. Directions are compared, not
lines: toward the light is the side of the tangent on which the light is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.optics.field.bake import bake_light
from sim.optics.field.lines import normal_at
from sim.optics.light.section_curve import plane_section, tangent_toward
from workbench.core.design.lighting import LedRing, LightModel
from workbench.core.result.light import LightField
from workbench.core.result.results import MembraneMesh, Skin

NEAREST_MM = 2.0
"""Distance from the light below which no section curve is compared [mm]."""
LEAST_PLANE = 0.1
"""Sine of light and normal below which a plane is too ill defined to compare on a mesh [1]."""
TARGETS = 300


@dataclass(frozen=True, kw_only=True, slots=True)
class PlaneCheck:
    """A plane field against the curve in which the plane cuts the mesh."""

    median_deg: float
    """Median angle between field and cut curve, both toward the light; 180 for a reversed one."""
    percentile_95_deg: float
    straight_deg: float
    """The null: the median of the straight line to the light [degree]."""
    targets: int


def plane_closed_form(
    model: LightModel, mesh: MembraneMesh, ring: LedRing, *, seed: int = 7
) -> PlaneCheck:
    """One of the plane models against the cut mesh, at random targets."""
    return against_curves(bake_light(mesh, ring, model=model), model, mesh.seen, seed=seed)


def against_curves(
    light: LightField, model: LightModel, skin: Skin, *, seed: int = 7
) -> PlaneCheck:
    """Any field against the curves that a model's planes cut.

    Targets nearer than 2 mm to the light have no curve to speak of and are left out, as are those
    at which the plane is not defined, and those within a step of the skin's border.
    """
    edges = skin.points_mm[skin.faces[:, 0]] - skin.points_mm[skin.faces[:, 1]]
    step_mm = 1.5 * float(np.linalg.norm(edges, axis=1).mean())
    random = np.random.default_rng(seed)
    angles, straight = [], []
    for vertex in random.choice(len(skin.points_mm), TARGETS, replace=False):
        led = int(random.integers(len(light.led_mm)))
        target, source = skin.points_mm[vertex], light.led_mm[led]
        away_mm = float(np.linalg.norm(source - target))
        line = (source - target) / away_mm
        across = np.cross(_second(model, skin, int(vertex), source), line)
        if away_mm < NEAREST_MM or np.linalg.norm(across) < LEAST_PLANE:
            continue
        curve = plane_section(skin, target, across / np.linalg.norm(across))
        cut = None if curve is None else tangent_toward(curve, target, source, step_mm=step_mm)
        if cut is None:
            continue
        cut = cut * np.sign(cut @ line)
        angles.append(_angle_deg(cut, light.direction[led, vertex]))
        straight.append(_angle_deg(cut, line))
    median, high = np.percentile(angles, (50.0, 95.0))
    return PlaneCheck(
        median_deg=float(median),
        percentile_95_deg=float(high),
        straight_deg=float(np.median(straight)),
        targets=len(angles),
    )


def _second(model: LightModel, skin: Skin, vertex: int, source_mm: np.ndarray) -> np.ndarray:
    """What spans a model's plane with the line to the light: a unit vector, shape (3,)."""
    if model is LightModel("plane_target"):
        return skin.normals[vertex]
    if model is LightModel("plane_normal"):
        return normal_at(skin, source_mm)
    azimuth = np.arctan2(source_mm[1], source_mm[0])
    return np.array([np.cos(azimuth), np.sin(azimuth), 0.0])


def _angle_deg(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.degrees(np.arccos(np.clip(one @ other, -1.0, 1.0))))
