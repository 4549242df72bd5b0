"""Whether rigid parts can be moved past each other: their overlap along straight ways.

The moving part is intersected with every other at steps of a millimetre (manifold3d, exact at each
step); parts whose bounding boxes are apart are not looked at. Features of a printed mould are wider
than a step, so none is stepped over.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from geometry.body.csg_mesh import arrays
from geometry.surface.rays import RayCaster
from geometry.surface.spread import spread

STEP_MM = 1.0
TOLERANCE_MM = 1e-3
"""Faces that touch may overlap by this much times their area: rounding of files and facets [mm]."""
LEAST_MM3 = 1e-6
"""Less is nothing, whatever touches [mm3]."""
TOUCH_MM = 5e-3
"""Faces nearer than this touch [mm]."""
SAMPLES = 4000
"""Places from which touching is looked for: the area is good to about a hundredth of the whole."""


class Met(NamedTuple):
    """What a moving part met on its way, where that was worst."""

    overlap_mm3: float
    tolerance_mm3: float
    """Overlap that is only the rounding of faces that touch [mm3]."""
    place_mm: tuple[float, float, float]
    """Centroid of the overlap [mm]."""

    @property
    def over_mm3(self) -> float:
        """Overlap beyond the tolerance: the way is free where it is not above 0 [mm3]."""
        return self.overlap_mm3 - self.tolerance_mm3


FREE = Met(0.0, LEAST_MM3, (0.0, 0.0, 0.0))


def touching_mm2(one: Any, other: Any) -> float:
    """Area of a manifold's surface that lies on the surface of another [mm2]."""
    points, faces = arrays(one)
    places = spread(points, faces, SAMPLES)
    start = places.points_mm - TOUCH_MM * places.normals
    met = RayCaster(*arrays(other)).occluded(start, places.normals, 2.0 * TOUCH_MM)
    return places.area_mm2 * float(met.mean())


def tolerance_mm3(one: Any, other: Any) -> float:
    """Overlap of two manifolds that is only the rounding of faces that touch [mm3]."""
    return max(LEAST_MM3, TOLERANCE_MM * touching_mm2(one, other))


def way_mm(moving: Any, others: Mapping[str, Any], direction: np.ndarray) -> float:
    """How far a manifold must go along a unit direction until all others are behind it [mm]."""
    first = float((arrays(moving)[0] @ direction).min())
    last = max(float((arrays(other)[0] @ direction).max()) for other in others.values())
    return max(0.0, last - first)


def swept(moving: Any, others: Mapping[str, Any], direction: np.ndarray, distance_mm: float) -> Met:
    """The worst overlap of a manifold with others while it moves along a straight way."""
    worst = FREE
    count = max(1, int(np.ceil(distance_mm / STEP_MM)))
    for gone_mm in distance_mm * np.arange(1, count + 1) / count:
        moved = moving.translate(gone_mm * direction)
        for other in others.values():
            if not _boxes_meet(moved, other):
                continue
            shared = moved ^ other
            if shared.volume() > LEAST_MM3:
                met = Met(float(shared.volume()), _rounding_mm3(shared), _middle(shared))
                worst = max(worst, met, key=lambda found: (found.over_mm3 > 0, found.overlap_mm3))
    return worst


def _rounding_mm3(shared: Any) -> float:
    """How much of an overlap may be the rounding of faces that slide on each other [mm3].

    Only what is thin all over: a peg that is caught is no rounding, however wide the faces around
    it. Sheets thinner than the shift vanish where the body meets itself shifted along X, Y and Z;
    both faces of a sheet belong to its area.
    """
    kept = shared
    for shift_mm in 2.0 * np.sqrt(3.0) * TOLERANCE_MM * np.eye(3):
        kept = kept ^ shared.translate(shift_mm) ^ shared.translate(-shift_mm)
    thin = kept.volume() <= LEAST_MM3
    return max(LEAST_MM3, TOLERANCE_MM * float(shared.surface_area()) / 2) if thin else LEAST_MM3


def _boxes_meet(one: Any, other: Any) -> bool:
    first, second = np.array(one.bounding_box()), np.array(other.bounding_box())
    return bool((first[:3] < second[3:]).all() and (second[:3] < first[3:]).all())


def _middle(solid: Any) -> tuple[float, float, float]:
    """Centroid: a bounding box would hold the slivers of faces that touch, too."""
    points, faces = arrays(solid)
    first, second, third = (points[faces[:, k]] for k in range(3))
    volume = np.einsum("ij,ij->i", first, np.cross(second, third))
    x, y, z = (float(v) for v in volume @ (first + second + third) / (4.0 * volume.sum()))
    return x, y, z
