"""Where a data set presses: the paper's two patterns, and points spread over any skin.

The finger (Algorithm 1): four paths from the tip to the base, 90 degrees apart. On the tip the
*surface normal* stands at 0 to 90 degrees to the axis, by 10; the base is met 0 to 12 mm below the
tip, by 1. The paper writes the normal as p / |p|, which holds on a hemisphere about the origin
only; here the skin's own normal decides. The apex belongs to all paths, and 90 degrees is 0 mm:
1 + 4 x 9 + 4 x 12 = 85 positions. `workbench.learning.dataset.algorithms` has the same as presses,
without labels and for a hemisphere only.
Its side wall alone: those of the four paths that lie on the straight part, 52 of them.
The pad (Algorithm 2): a grid from -3 to 3 mm by 1.5, 25 positions.
Anything else: vertices of the skin that lie as far apart as they can (farthest-point sampling, by
straight distance), away from the rim.
Source: SimTac, Supplementary, "Data collection setup". Left out: whether the object fits there; a
press that meets the skin elsewhere first fails and is recorded.
"""

from __future__ import annotations

import enum
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.units import radians
from workbench.core.design.design import SensorDesign
from workbench.core.result.results import Skin
from workbench.learning.dataset.algorithms import BASE_MM, GRID_MM, PATHS, TIP_DEG

AZIMUTH_DEG = tuple(range(0, 360, 360 // PATHS))
MARGIN_MM = 3.0
"""Distance of spread points from the rim of the skin: half the default object [mm]."""


class Pattern(enum.StrEnum):
    """How positions are laid out."""

    FINGER = "finger"
    """The paper's Algorithm 1."""
    PAD = "pad"
    """The paper's Algorithm 2."""
    SIDE = "side"
    """The places of Algorithm 1 on the finger's side wall, where it holds what it grasps."""
    SPREAD = "spread"
    """Evenly over any skin."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Position:
    """One place on the skin."""

    name: str
    """Readable and unique within a data set: `tip40_az090`."""
    target_mm: tuple[float, float, float]
    """Point on the skin, or so near that projection finds it [mm]."""
    labels: Mapping[str, Any] = field(default_factory=dict[str, Any])
    """polar_deg, azimuth_deg and height_mm of a finger, x_mm and y_mm of a pad, also z_mm else."""


def finger_positions(design: SensorDesign) -> list[Position]:
    """Algorithm 1 on a finger.

    A half ellipsoid with radius R and height h has the normal (sin a, cos a) at
    (R^2 sin a, h^2 cos a) / sqrt(R^2 sin^2 a + h^2 cos^2 a).

    Raises:
        DesignError: If the design is no finger, or its straight part is shorter than 12 mm.
    """
    shape = _shape(design, Pattern.FINGER)
    if shape.cylinder_mm <= BASE_MM[-1]:
        raise DesignError(
            f"the straight part is {shape.cylinder_mm:g} mm long; the paper's paths go "
            f"{BASE_MM[-1]:g} mm down it",
            hint="use pattern spread, or raise shape.cylinder_mm",
            at="recipe.pattern",
        )
    radius, tip = shape.outer_radius_mm, shape.tip_mm
    found = []
    for azimuth in AZIMUTH_DEG:
        for polar in TIP_DEG:
            if not polar and azimuth:
                continue
            across, along = radius * math.sin(radians(polar)), tip * math.cos(radians(polar))
            size = math.hypot(across, along)
            place = (radius * across / size, shape.cylinder_mm + tip * along / size)
            labels = {"polar_deg": polar, "azimuth_deg": azimuth, "height_mm": 0.0}
            found.append(_around(f"tip{polar:02.0f}", azimuth, *place, labels))
        for height in BASE_MM[1:]:
            labels = {"polar_deg": 90.0, "azimuth_deg": azimuth, "height_mm": height}
            place = (radius, shape.cylinder_mm - height)
            found.append(_around(f"base{height:02.0f}", azimuth, *place, labels))
    return found


def side_positions(design: SensorDesign) -> list[Position]:
    """The positions of Algorithm 1 whose normal stands at 90 degrees to the axis.

    Raises:
        DesignError: As `finger_positions`.
    """
    return [place for place in finger_positions(design) if place.labels["polar_deg"] == 90.0]


def _around(
    name: str, azimuth_deg: int, across_mm: float, z_mm: float, labels: dict[str, Any]
) -> Position:
    angle = radians(azimuth_deg)
    target = (across_mm * math.cos(angle), across_mm * math.sin(angle), z_mm)
    x, y, z = (round(value, 9) + 0.0 for value in target)
    return Position(name=f"{name}_az{azimuth_deg:03d}", target_mm=(x, y, z), labels=labels)


def pad_positions(design: SensorDesign) -> list[Position]:
    """Algorithm 2 on a pad, on its dome.

    Raises:
        DesignError: If the design is no pad.
    """
    shape = _shape(design, Pattern.PAD)
    top_mm = shape.standoff_mm + design.layers.elastomer_mm + shape.dome_mm
    found = []
    for x_mm in GRID_MM:
        for y_mm in GRID_MM:
            way_mm = math.hypot(x_mm, y_mm)
            curved = math.isfinite(shape.sphere_mm)
            sag_mm = shape.sphere_mm - math.sqrt(shape.sphere_mm**2 - way_mm**2) if curved else 0.0
            target = (x_mm, y_mm, top_mm - sag_mm)
            name = f"x{x_mm:.1f}_y{y_mm:.1f}"
            labels = {"x_mm": x_mm, "y_mm": y_mm}
            found.append(Position(name=name, target_mm=target, labels=labels))
    return found


def _shape(design: SensorDesign, pattern: Pattern) -> Any:
    from designs.family import resolve_shape

    if design.family != pattern.value:
        raise DesignError(
            f"the {pattern.value} pattern is for that family, this design is of the "
            f"family {shown(design.family)}",
            hint="use pattern spread, which takes any membrane",
            at="recipe.pattern",
        )
    return resolve_shape(design.family, design.shape)


def spread_positions(
    skin: Skin, count: int, *, seed: int, margin_mm: float = MARGIN_MM
) -> list[Position]:
    """Vertices as far apart as they can be, each farthest from those before it.

    A longer list begins with a shorter one of the same seed.

    Args:
        skin: The outer skin.
        count: How many.
        seed: Chooses the first vertex.
        margin_mm: Least distance from the rim.

    Raises:
        DesignError: If fewer vertices are that far from the rim.
    """
    places = skin.points_mm[inside_margin(skin, margin_mm)]
    if len(places) < count:
        raise DesignError(
            f"{count} points are asked for, and {len(places)} vertices of the skin lie "
            f"{margin_mm:g} mm from its rim or farther",
            hint="ask for fewer points or a smaller margin",
            at="recipe.points",
        )
    chosen = far_apart(places, count, np.random.default_rng(seed))
    found = []
    for number, index in enumerate(chosen):
        x, y, z = (round(float(value), 6) + 0.0 for value in places[index])
        labels = {"x_mm": x, "y_mm": y, "z_mm": z}
        found.append(Position(name=f"point{number:03d}", target_mm=(x, y, z), labels=labels))
    return found


def far_apart(places: np.ndarray, count: int, rng: np.random.Generator) -> list[int]:
    """Numbers of places (N, 3) that lie as far apart as they can: farthest-point sampling.

    Args:
        places: At least one.
        count: How many are chosen; beyond N some come again.
        rng: Chooses the first.
    """
    chosen = [int(rng.integers(len(places)))]
    nearest_mm = np.linalg.norm(places - places[chosen[0]], axis=1)
    while len(chosen) < count:
        chosen.append(int(np.argmax(nearest_mm)))
        away_mm = np.linalg.norm(places - places[chosen[-1]], axis=1)
        nearest_mm = np.minimum(nearest_mm, away_mm)
    return chosen


def inside_margin(skin: Skin, margin_mm: float) -> np.ndarray:
    """Vertices at least so far from the rim of the skin [mm], shape (V,), bool."""
    from scipy.spatial import KDTree

    edges = np.sort(np.stack([skin.faces, np.roll(skin.faces, -1, axis=1)], axis=2), axis=2)
    pairs, uses = np.unique(edges.reshape(-1, 2), axis=0, return_counts=True)
    rim = np.unique(pairs[uses == 1])
    used = np.zeros(len(skin.points_mm), bool)
    used[skin.faces] = True
    if not len(rim):
        return used
    away_mm, _ = KDTree(skin.points_mm[rim]).query(skin.points_mm)
    return used & (away_mm >= margin_mm)
