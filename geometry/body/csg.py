"""Bodies by description: primitives, cast bodies and booleans, placed by a transform.

A description is evaluated twice: to triangles (`csg_mesh`, always) and to a B-rep body (`csg_brep`,
where every cast body in it has one). Both then mean the same part.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from workbench.core.base.check import expect


@dataclass(frozen=True, kw_only=True, slots=True)
class Box:
    """A box along the axes."""

    low_mm: tuple[float, float, float]
    high_mm: tuple[float, float, float]


@dataclass(frozen=True, kw_only=True, slots=True)
class Cone:
    """A truncated cone about Z."""

    low_radius_mm: float
    high_radius_mm: float
    low_mm: float
    """Height of the lower end [mm]."""
    high_mm: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Prism:
    """A simple polygon extruded along Z."""

    polygon_mm: np.ndarray
    """Corners [mm], shape (N, 2), counter-clockwise."""
    low_mm: float
    high_mm: float

    def __post_init__(self) -> None:
        expect(self.polygon_mm, "N 2", name="polygon")


@dataclass(frozen=True, kw_only=True, slots=True)
class Body:
    """A closed triangle mesh and, where there is one, the same body as B-rep."""

    points_mm: np.ndarray
    """Vertices [mm], shape (N, 3)."""
    faces: np.ndarray
    """Triangles, shape (M, 3), counter-clockwise from outside."""
    brep: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.uint8))
    """OCCT text, shape (bytes,), uint8; empty when only triangles exist."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Union:
    """All parts as one."""

    parts: tuple[Node, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class Difference:
    """A body without its tools."""

    body: Node
    tools: tuple[Node, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class Intersection:
    """What two bodies share."""

    body: Node
    other: Node


@dataclass(frozen=True, kw_only=True, slots=True)
class Placed:
    """A body moved, turned and scaled evenly."""

    body: Node
    matrix: np.ndarray
    """Rows of the affine map [R | t], shape (3, 4); the translation in mm."""

    def __post_init__(self) -> None:
        expect(self.matrix, "3 4", name="matrix")


Node = Box | Cone | Prism | Body | Union | Difference | Intersection | Placed


def cylinder(radius_mm: float, low_mm: float, high_mm: float) -> Cone:
    """A cylinder about Z."""
    return Cone(low_radius_mm=radius_mm, high_radius_mm=radius_mm, low_mm=low_mm, high_mm=high_mm)


def without(body: Node, tools: Sequence[Node]) -> Node:
    """The body less its tools; the body itself when there are none."""
    return Difference(body=body, tools=tuple(tools)) if tools else body


def together(body: Node, others: Sequence[Node]) -> Node:
    """The body and the others as one; the body itself when there are none."""
    return Union(parts=(body, *others)) if others else body


def moved(body: Node, offset_mm: Sequence[float] | np.ndarray) -> Placed:
    """The body shifted."""
    return Placed(body=body, matrix=np.column_stack([np.eye(3), np.asarray(offset_mm, float)]))


def turned(body: Node, azimuth_deg: float) -> Placed:
    """The body turned about Z."""
    return Placed(body=body, matrix=np.column_stack([turn_z(azimuth_deg), np.zeros(3)]))


def scaled(body: Node, factor: float, centre_mm: Sequence[float] | np.ndarray) -> Placed:
    """The body scaled evenly about a centre."""
    shift = (1.0 - factor) * np.asarray(centre_mm, float)
    return Placed(body=body, matrix=np.column_stack([factor * np.eye(3), shift]))


def along(
    body: Node, direction: Sequence[float] | np.ndarray, start_mm: Sequence[float] | np.ndarray
) -> Placed:
    """The body with its Z turned into a direction and its origin moved to a start."""
    axis = np.asarray(direction, float)
    axis = axis / np.linalg.norm(axis)
    # Any axis not nearly parallel spans the frame; X keeps frames of vertical axes unturned.
    other = np.array([1.0, 0, 0]) if abs(axis[0]) < 0.9 else np.array([0, 1.0, 0])
    first = other - (other @ axis) * axis
    first /= np.linalg.norm(first)
    rotation = np.column_stack([first, np.cross(axis, first), axis])
    return Placed(body=body, matrix=np.column_stack([rotation, np.asarray(start_mm, float)]))


def turn_z(azimuth_deg: float) -> np.ndarray:
    """Rotation about Z, shape (3, 3)."""
    angle = np.radians(azimuth_deg)
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def bodies(node: Node) -> Iterator[Body]:
    """Every cast body in a description."""
    match node:
        case Body():
            yield node
        case Union():
            for part in node.parts:
                yield from bodies(part)
        case Difference():
            for part in (node.body, *node.tools):
                yield from bodies(part)
        case Intersection():
            yield from bodies(node.body)
            yield from bodies(node.other)
        case Placed():
            yield from bodies(node.body)
        case _:
            return
