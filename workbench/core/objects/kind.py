"""A kind of object: its edges, its extent, its signed distance, and how the kernels know it.

A kind is one file of `workbench.core.objects.kinds`, or of `workbench.core.objects.released` with
`released_` before its name; its name stands in designs, `KIND` says the rest. Body frame as in
`workbench.core.press.press`: origin at the shape's centre, +Z away from the skin. Lengths are
functions of the size, which is the largest width, and of the edge radius [mm]. Edges are rounded
exactly: a sharp body made smaller by the radius, its distance lowered by it.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core.base.records import records

Distance = Callable[[np.ndarray], np.ndarray]
"""Signed distances [mm], shape (N,), of places (N, 3) in the body frame."""
PACKAGES = {"workbench.core.objects.kinds": "", "workbench.core.objects.released": "released_"}
"""Where kinds are, and what stands before the names of their files."""
USUAL_EDGE_SHARE = 0.25
"""Largest edge radius over the size of a body that is as thick as wide."""


class Shape(enum.IntEnum):
    """Number of a shape in the kernels."""

    SPHERE = 0
    CYLINDER_Z = 1
    CYLINDER_Y = 2
    CUBE = 3
    CONE = 4
    GRID = 5
    """Known by samples of its distance only, as everything with a texture is."""


class Group(enum.StrEnum):
    """Where a kind stands in the paper."""

    SEEN = "seen"
    """One of the indenters 1 to 10, with which the paper's networks were trained."""
    UNSEEN = "unseen"
    """One of the indenters 11 to 14, kept for testing."""
    OTHER = "other"
    RELEASED = "released"
    """One of the fourteen heads whose files were released with the paper, in their own sizes."""


def half_of(size_mm: float, edge_mm: float) -> float:
    """Half the size: how far most kinds reach from their centre."""
    return 0.5 * size_mm


def edge_of(size_mm: float, edge_mm: float) -> float:
    """The edge radius: the sharpest that most kinds are."""
    return edge_mm


@dataclass(frozen=True, kw_only=True, slots=True)
class Kind:
    """One shape."""

    place: int
    """Where it stands in lists: the paper's number, then the others."""
    group: Group
    edge_share: float | None = USUAL_EDGE_SHARE
    """Largest edge radius over the size that leaves something to round; None: it has no edges."""
    tip: bool = False
    """Whether it meets the skin with a point."""
    distance: Callable[[float, float], Distance] | None = None
    """Exact signed distance; None where the kernels have it, or there are triangles instead."""
    half_extent_mm: Callable[[float], np.ndarray] | None = None
    """Half widths of a box about the origin that holds it, shape (3,); None: half the size."""
    lowest_mm: Callable[[float, float], float] = half_of
    """From the origin to the plane that bounds it toward -Z."""
    sharpest_mm: Callable[[float, float], float] = edge_of
    """Least radius of curvature."""
    shape: Shape = Shape.GRID
    numbers: Callable[[float, float], np.ndarray] | None = None
    """What the kernels need of a shape that they know in closed form, shape (8,)."""
    corners_mm: Callable[[float], Sequence[tuple[float, float]]] | None = None
    """Corners (radius, height) of the sharp section of a body of revolution, from axis to axis."""
    own_mm: float | None = None
    """Size of the object that was made; None: any will do."""
    aliases: tuple[str, ...] = ()
    """Other words that it is chosen by."""
    of_triangles: bool = False
    """Whether the body is a mesh of the designer's own."""

    def extent_mm(self, size_mm: float) -> np.ndarray:
        """Half widths of a box about the origin that holds it, shape (3,)."""
        if self.half_extent_mm is not None:
            return self.half_extent_mm(size_mm)
        return np.full(3, 0.5 * size_mm)


def kinds() -> dict[str, Kind]:
    """All kinds by name, in the order of lists."""
    found = {
        before + name: kind
        for package, before in PACKAGES.items()
        for name, kind in records(package, "KIND").items()
    }
    return {name: found[name] for name in sorted(found, key=lambda name: found[name].place)}


def kind_of(name: str) -> Kind:
    """What a kind says of itself."""
    return kinds()[str(name)]
