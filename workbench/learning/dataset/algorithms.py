"""The two motions by which SimTac's data were collected: Algorithm 1 (finger), Algorithm 2 (pad).

Source: SimTac, Supplementary, `Data collection setup`. The object stands perpendicular to the
surface at every contact point, goes in by 0.1 mm a frame, and on the finger is then sheared in
eight directions.

Where the paper slips, the right-hand form is used:
- it takes p / |p| for the normal, which holds on a hemispherical tip only: a press takes the normal
  of the skin at its target;
- it returns to the untouched place between shears, without pressing again: each sheared press here
  goes down to its depth first. A release is not recorded there and makes no difference here,
  since every press starts from the untouched skin;
- the shear goes to 0.5 mm "along the x or y axis", so that diagonals reach 0.71 mm;
- its sample counts (6,538, 8,016, 9,980, 2,548) do not follow from its grids. In full the grids
  give 85 contact points on the finger: the apex once, then on each of four paths nine places of the
  tip (10 to 90 degrees) and twelve of the base (1 to 12 mm; 0 mm is 90 degrees). With 10 depths
  that is 850 normal states and 34,000 sheared ones for each object, and 300 on the pad.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypedDict, Unpack

from workbench.core.base.errors import DesignError
from workbench.core.press.motion import slide
from workbench.core.press.press import Press

STEP_MM = 0.1
"""Depth and shear from frame to frame [mm]. Source: SimTac, Supplementary."""
DIRECTIONS = 8
PATHS = 4
TIP_DEG = tuple(float(angle) for angle in range(0, 91, 10))
BASE_MM = tuple(float(way) for way in range(13))
GRID_MM = (-3.0, -1.5, 0.0, 1.5, 3.0)

Place = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True, slots=True)
class Visit:
    """One press of an algorithm, and which of its frames are recorded."""

    press: Press
    point: int
    """Number of the contact point, from 0."""
    direction: int | None
    """Number of the shear direction at 45 degrees each from U toward V; None without shear."""
    recorded: range
    """Frames that are states of the data; the way down before a shear repeats others."""


class FingerPoints(TypedDict, total=False):
    """Where the finger is touched: the arguments of `finger_points_mm`."""

    outer_radius_mm: float
    cylinder_mm: float
    paths: int
    tip_deg: Sequence[float]
    base_mm: Sequence[float]


def finger_points_mm(
    *,
    outer_radius_mm: float = 15.0,
    cylinder_mm: float = 27.0,
    paths: int = PATHS,
    tip_deg: Sequence[float] = TIP_DEG,
    base_mm: Sequence[float] = BASE_MM,
) -> list[Place]:
    """Contact points of Algorithm 1 from tip to base [mm], each once, sensor frame.

    Args:
        outer_radius_mm: Radius of the skin; the tip is a hemisphere.
        cylinder_mm: Height of the seam between tip and base.
        paths: Contact paths around the axis.
        tip_deg: Angles from the axis on the tip.
        base_mm: Ways from the seam toward the base.

    Raises:
        DesignError: If the base positions are longer than the cylinder.
    """
    if max(base_mm, default=0.0) > cylinder_mm:
        raise DesignError(
            f"contact points {max(base_mm):g} mm below the seam lie under the base; the straight "
            f"part is {cylinder_mm:g} mm long",
            hint="give shorter base_mm",
            at="base_mm",
        )
    profile = [(a, 0.0) for a in tip_deg] + [(90.0, way) for way in base_mm]
    points: dict[Place, None] = {}
    for path, (angle_deg, way_mm) in itertools.product(range(paths), profile):
        azimuth, angle = 2.0 * math.pi * path / paths, math.radians(angle_deg)
        across_mm = outer_radius_mm * math.sin(angle)
        height_mm = cylinder_mm + outer_radius_mm * math.cos(angle) - way_mm
        place = (across_mm * math.cos(azimuth), across_mm * math.sin(azimuth), height_mm)
        # Apex and seam are reached more than once: adding 0 turns -0.0 into 0.0.
        points[round(place[0], 9) + 0.0, round(place[1], 9) + 0.0, round(place[2], 9) + 0.0] = None
    return list(points)


def finger_algorithm(
    *,
    deepest_mm: float = 1.0,
    shear_mm: float = 0.5,
    directions: int = DIRECTIONS,
    step_mm: float = STEP_MM,
    **points: Unpack[FingerPoints],
) -> Iterator[Visit]:
    """Algorithm 1: at each point one press by steps, then each depth sheared in each direction.

    Args:
        deepest_mm: Largest depth.
        shear_mm: Largest shear along U or V.
        directions: Shear directions, 0 for normal contact only.
        step_mm: Depth and shear from frame to frame.
        points: `outer_radius_mm` of the skin, `cylinder_mm` (height of the seam between tip and
            base), `paths` around the axis, `tip_deg` (angles from the axis on the tip) and
            `base_mm` (ways from the seam toward the base), by keyword.
    """
    depths = _steps(deepest_mm, step_mm, at="deepest_mm")
    for point, target_mm in enumerate(finger_points_mm(**points)):
        yield _straight(point, target_mm, depths, deepest_mm)
        for depth, direction in itertools.product(range(1, depths + 1), range(directions)):
            shears = _steps(shear_mm, step_mm, at="shear_mm")
            u_mm, v_mm = shear_way_mm(direction, directions, shear_mm)
            press = Press(
                target_mm=target_mm,
                depth_mm=deepest_mm * depth / depths,
                frames=depth,
                strokes=(slide(u_mm, v_mm, frames=shears),),
            )
            recorded = range(depth, depth + shears)
            yield Visit(press=press, point=point, direction=direction, recorded=recorded)


def pad_algorithm(
    *,
    top_mm: float,
    grid_mm: Sequence[float] = GRID_MM,
    deepest_mm: float = 1.2,
    step_mm: float = STEP_MM,
) -> Iterator[Visit]:
    """Algorithm 2: normal contact on a square grid about the middle of a flat pad.

    Args:
        top_mm: Height of the skin above the base.
        grid_mm: Places along X and along Y.
        deepest_mm: Largest depth.
        step_mm: Depth from frame to frame.
    """
    depths = _steps(deepest_mm, step_mm, at="deepest_mm")
    for point, (x_mm, y_mm) in enumerate(itertools.product(grid_mm, grid_mm)):
        yield _straight(point, (x_mm, y_mm, top_mm), depths, deepest_mm)


def _straight(point: int, target_mm: Place, depths: int, deepest_mm: float) -> Visit:
    press = Press(target_mm=target_mm, depth_mm=deepest_mm, frames=depths)
    return Visit(press=press, point=point, direction=None, recorded=range(depths))


def _steps(way_mm: float, step_mm: float, *, at: str) -> int:
    """Whole number of steps in a way.

    Raises:
        DesignError: If the step does not divide it.
    """
    count = round(way_mm / step_mm) if step_mm > 0.0 else 0
    if count < 1 or abs(count * step_mm - way_mm) > 1e-6:
        raise DesignError(
            f"{way_mm:g} mm is not a whole number of steps of {step_mm:g} mm",
            hint="choose a step that divides depth and shear",
            at=at,
        )
    return count


def shear_way_mm(direction: int, directions: int, shear_mm: float) -> tuple[float, float]:
    """Shear along U and V [mm]: the larger of the two is `shear_mm`, so diagonals are longer."""
    angle = 2.0 * math.pi * direction / directions
    u, v = math.cos(angle), math.sin(angle)
    largest = max(abs(u), abs(v))
    return round(shear_mm * u / largest, 9) + 0.0, round(shear_mm * v / largest, 9) + 0.0
