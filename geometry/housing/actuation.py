"""Sliders that push the lobes of bodies with actuators, as in the paper's trunk sensor.

One per side with actuator regions: a rod that slides upright through a guide beside the foot, an
arm over the top of the skin, and a paddle whose face is parallel to its regions at their middle.

        post   arm
          .-----------.
        [paddle]      |
        /lobe\\        | rod
        |     |      _|_
    ____|_____|_____|___|  guide, one piece with the base

Leaves out: what drives the rods; regions on the inner face, which no rod reaches.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.body import csg
from geometry.surface.surface import face_areas
from workbench.core.design.making import Housing
from workbench.core.result.results import Label, LabelledSurface, Solid

ROD_MM = 2.0
"""Radius of rod, arm and post [mm]."""
ARM_SHARE = 0.75
"""Half width of the square arm over the rod's radius."""
PADDLE_MM = 2.5
"""Thickness of the paddle [mm]."""
REST_MM = 0.5
"""Gap between paddle and skin at rest [mm]."""
OVER_MM = 3.0
"""Height of the arm's axis over the highest point of the skin [mm]."""
PADDLE_SHARE = 0.25
"""Radius of the paddle over the square root of the region's area."""
SMALLEST_PADDLE_MM, LARGEST_PADDLE_MM = 2.5, 6.0
OVERLAP_MM = 2.0
"""How far a guide reaches into the foot [mm]."""
APART_MM = 25.0
SAME_SIDE = 0.9
"""Cosine between the directions to two regions above which one slider pushes both."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ActuatorRod:
    """One slider and what it needs of the base."""

    name: str
    title: str
    """What it is for, in words."""
    body: csg.Node
    guide: csg.Node
    """Block beside the foot, to be joined to it."""
    bore: csg.Node
    """Hole for the rod."""
    explode: tuple[float, float, float]


def make_rods(solid: Solid, options: Housing) -> tuple[ActuatorRod, ...]:
    """A slider for each side with actuators on the outer face, in the order of their numbers.

    Regions on one side, such as the rim and the back of a lobe, share a slider.
    """
    membrane = solid.membrane
    driven = membrane.has(Label.ACTUATOR) & membrane.has(Label.OUTER)
    sides: list[tuple[np.ndarray, list[int]]] = []
    for number in np.unique(membrane.numbers[driven]).tolist():
        way = _side_of(number, membrane)
        shared = next((numbers for other, numbers in sides if way @ other > SAME_SIDE), None)
        if shared is None:
            sides.append((way, [number]))
        else:
            shared.append(number)
    return tuple(_rod(k, numbers, solid, options) for k, (_, numbers) in enumerate(sides))


def _side_of(number: int, membrane: LabelledSurface) -> np.ndarray:
    """Horizontal unit direction from the middle of the skin to a region."""
    spot = _paddle_place(membrane.points_mm, membrane.faces[_own(number, membrane)])[0]
    return _aside(spot - _middle(membrane.points_mm), number)


def _own(number: int, membrane: LabelledSurface) -> np.ndarray:
    return membrane.has(Label.ACTUATOR) & (membrane.numbers == number)


def _middle(points: np.ndarray) -> np.ndarray:
    return (points.min(axis=0) + points.max(axis=0)) / 2


def _rod(count: int, numbers: list[int], solid: Solid, options: Housing) -> ActuatorRod:
    membrane = solid.membrane
    region = np.any([_own(number, membrane) for number in numbers], axis=0)
    spot, normal, radius = _paddle_place(membrane.points_mm, membrane.faces[region])
    skin, foot = membrane.points_mm, solid.base.points_mm
    aside = _aside(spot - _middle(skin), numbers[0])
    across = spot[:2] - (spot[:2] @ aside) * aside
    # Beyond everything on that side, along the line through the paddle.
    reach = max(float((p[:, :2] @ aside).max()) for p in (skin, foot))
    wall, gap = options.wall_mm, options.clearance_mm
    rod_xy = across + (reach + gap + wall + ROD_MM) * aside
    top = float(skin[:, 2].max()) + OVER_MM
    bottom = float(foot[:, 2].min())
    lifted = spot + _lift(skin, spot, normal, radius) * normal
    paddle = csg.along(csg.cylinder(radius, 0.0, PADDLE_MM), normal, lifted)
    behind = lifted + 0.5 * PADDLE_MM * normal
    arm = np.array([*(rod_xy - behind[:2]), 0.0])
    post = csg.moved(csg.cylinder(ROD_MM, float(behind[2]), top + ROD_MM), (*behind[:2], 0.0))
    # Narrower than post and rod: faces that only touch each other stump the CAD kernel.
    half = ARM_SHARE * ROD_MM
    bar = csg.Box(low_mm=(-half, -half, 0.0), high_mm=(half, half, float(np.linalg.norm(arm))))
    beam = csg.along(bar, arm, (*behind[:2], top))
    shaft = csg.moved(csg.cylinder(ROD_MM, bottom, top + ROD_MM), (*rod_xy, 0.0))
    return ActuatorRod(
        name=f"slider_{count}",
        title=f"actuator rod for lobe {count}",
        body=csg.Union(parts=(shaft, beam, post, paddle)),
        guide=_guide(rod_xy, aside, reach, bottom, options),
        bore=csg.moved(csg.cylinder(ROD_MM + gap, bottom - 1.0, top), (*rod_xy, 0.0)),
        explode=(float(aside[0]) * APART_MM, float(aside[1]) * APART_MM, 0.0),
    )


def _guide(
    rod_xy: np.ndarray, aside: np.ndarray, reach_mm: float, bottom_mm: float, options: Housing
) -> csg.Node:
    """Block from the foot's edge to beyond the rod, below the base plane."""
    turn = float(np.degrees(np.arctan2(aside[1], aside[0])))
    half = ROD_MM + options.clearance_mm + options.wall_mm
    along, across = float(rod_xy @ aside), float(rod_xy @ np.array([-aside[1], aside[0]]))
    box = csg.Box(
        low_mm=(reach_mm - OVERLAP_MM, across - half, bottom_mm),
        high_mm=(along + half, across + half, 0.0),
    )
    return csg.turned(box, turn)


def _paddle_place(points: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Middle of a region, its mean outward normal, and the paddle's radius [mm]."""
    corners = points[faces]
    area = face_areas(points, faces)
    spot = (area[:, None] * corners.mean(axis=1)).sum(axis=0) / area.sum()
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(axis=0)
    radius = PADDLE_SHARE * float(np.sqrt(area.sum()))
    clipped = float(np.clip(radius, SMALLEST_PADDLE_MM, LARGEST_PADDLE_MM))
    return spot, normal / np.linalg.norm(normal), clipped


def _lift(skin: np.ndarray, spot: np.ndarray, normal: np.ndarray, radius_mm: float) -> float:
    """How far along the normal the paddle must stand off to clear the skin around it [mm]."""
    offset = skin - spot
    height = offset @ normal
    aside = np.linalg.norm(offset - height[:, None] * normal, axis=1)
    near = (aside < radius_mm + 1.0) & (height > -radius_mm)
    return float(height[near].max(initial=0.0)) + REST_MM


def _aside(offset: np.ndarray, number: int) -> np.ndarray:
    """Horizontal unit direction from the middle to a region; +Y, -Y in turn where it is above."""
    length = float(np.linalg.norm(offset[:2]))
    if length < 1.0:
        return np.array([0.0, 1.0 if number % 2 == 0 else -1.0])
    return offset[:2] / length
