"""What stands on a flat: prisms on arcs with a rounded rim, and half ellipsoids, face by face.

A prism's sides are cylinders about the arcs' centres and its rim is of tori, so no fillet of the
kernel is asked for; its volume is that of `designs/prisms.py`. A half ellipsoid is of four rational
patches, its volume 2/3 pi a b h. Several make one body when the flat that they stand on leaves out
what is below them: `stacked`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from designs import distance
from designs.prisms import rounded_prism_mm3
from designs.shells import sewn
from geometry.body.arcs import Arcs
from geometry.body.outline import QUARTER
from workbench.core.base.booleans import expect_volume
from workbench.core.base.errors import GeometryError

AROUND = 64
"""Places on the outline of a dome."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Block:
    """An upright prism on an outline of arcs, its top rim rounded."""

    arcs: Arcs
    from_mm: float
    top_mm: float
    rim_mm: float
    """Less than the narrowest lobe's radius, and at most the height."""

    @property
    def volume_mm3(self) -> float:
        """Closed form [mm3]."""
        area, around = self.arcs.area_mm2, self.arcs.perimeter_mm
        return rounded_prism_mm3(area, around, self.top_mm - self.from_mm, self.rim_mm)

    def distance(self, points_mm: np.ndarray) -> np.ndarray:
        """Signed distance, exact above `from_mm`; the prism goes on below, shape (N,)."""
        beside = self.arcs.distance(points_mm)
        return distance.rounded_both(beside, points_mm[:, 2] - self.top_mm, self.rim_mm)

    def foot(self) -> Any:
        """The outline it stands on as a wire."""
        from build123d import Wire

        return Wire(self.arcs.edges(self.from_mm))

    def walls(self) -> list[Any]:
        """Its faces but the top and the bottom."""
        from build123d import Axis, Edge, Face, Vector

        shoulder_mm = self.top_mm - self.rim_mm
        upright = Vector(0, 0, shoulder_mm - self.from_mm)
        found = []
        if upright.Z > 1e-9:
            found = [Face.extrude(edge, upright) for edge in self.arcs.edges(self.from_mm)]
        starts, high = self.arcs.spots_mm(0.0), self.top_mm
        for k, turn in enumerate(self.arcs.turns_rad):
            centre = self.arcs.centres_mm[k]
            inward = math.copysign(1.0, turn) * (centre - starts[k]) / self.arcs.radii_mm[k]
            turned = [(1.0 - math.cos(a), math.sin(a)) for a in (0.0, math.pi / 4, math.pi / 2)]
            spots = [
                (*(starts[k] + self.rim_mm * aside * inward), shoulder_mm + self.rim_mm * up)
                for aside, up in turned
            ]
            spots[2] = (*spots[2][:2], high)
            axis = Axis((*centre, 0.0), (0.0, 0.0, math.copysign(1.0, turn)))
            profile = Edge.make_three_point_arc(*spots)
            found.append(Face.revolve(profile, math.degrees(abs(turn)), axis))
        return found

    def top(self, holes: Sequence[Any] = ()) -> Any:
        """The flat top as a face, without what stands on it.

        Args:
            holes: Wires on it.

        Raises:
            GeometryError: If the rim leaves no flat.
        """
        from build123d import Face, Wire

        flat = self.arcs.inset(self.rim_mm)
        if flat is None:
            raise GeometryError(
                f"a rim of {self.rim_mm:g} mm leaves no flat top",
                hint="lower shape.rim_mm",
                at="shape.rim_mm",
            )
        return Face(Wire(flat.edges(self.top_mm)), list(holes))


@dataclass(frozen=True, kw_only=True, slots=True)
class Dome:
    """Half an ellipsoid on a flat, its axes along X, Y and Z."""

    place_mm: tuple[float, float]
    half_mm: tuple[float, float]
    """Half axes along X and Y [mm]."""
    from_mm: float
    rise_mm: float

    @property
    def volume_mm3(self) -> float:
        """Closed form [mm3]."""
        return 2.0 / 3.0 * math.pi * self.half_mm[0] * self.half_mm[1] * self.rise_mm

    @property
    def outline_mm(self) -> np.ndarray:
        """Places around its foot, shape (AROUND, 3)."""
        turn = np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False)
        plan = self.place_mm + np.column_stack([np.cos(turn), np.sin(turn)]) * self.half_mm
        return np.column_stack([plan, np.full(AROUND, self.from_mm)])

    def distance(self, points_mm: np.ndarray) -> np.ndarray:
        """Signed distance to the whole ellipsoid, first order, shape (N,)."""
        x, y = (points_mm[:, k] - self.place_mm[k] for k in (0, 1))
        scaled = [x / self.half_mm[0], y / self.half_mm[1]]
        scaled.append((points_mm[:, 2] - self.from_mm) / self.rise_mm)
        norm = np.sqrt(sum(part**2 for part in scaled))
        halves = (*self.half_mm, self.rise_mm)
        slope = np.sqrt(sum((p / h) ** 2 for p, h in zip(scaled, halves, strict=True)))
        return norm * (norm - 1.0) / np.maximum(slope, 1e-9)

    def faces(self) -> tuple[list[Any], Any]:
        """Its faces above the flat, and its outline on the flat as a wire."""
        from build123d import Edge, Face, Wire

        roof, ring = [], []
        for number in range(4):
            circle = _quarter(number) * self.half_mm
            across = (1.0, QUARTER, 1.0)
            # Control rows of a quarter ellipse upward: foot, corner over it, apex.
            rows = [(1.0, 0.0, 1.0), (1.0, self.rise_mm, QUARTER), (0.0, self.rise_mm, 1.0)]
            points = [
                [(*(self.place_mm + share * spot), self.from_mm + height) for spot in circle]
                for share, height, _ in rows
            ]
            weights = [[row[2] * weight for weight in across] for row in rows]
            roof.append(Face.make_bezier_surface(points, weights))  # pyright: ignore[reportArgumentType]
            ring.append(Edge.make_bezier(*points[0], weights=list(across)))
        return roof, Wire(ring)


def _quarter(number: int) -> np.ndarray:
    """Control points of a quarter of the unit circle, shape (3, 2)."""
    start = math.pi / 2 * number
    ends = [np.array([math.cos(turn), math.sin(turn)]) for turn in (start, start + math.pi / 2)]
    return np.array([ends[0], ends[0] + ends[1], ends[1]])


def block_body(block: Block, *, what: str) -> Any:
    """A prism as a B-rep body, checked by its volume.

    Raises:
        GeometryError: If the kernel did not close it.
    """
    return stacked(block, [], [], what=what)


def stacked(block: Block, domes: Sequence[Dome], blocks: Sequence[Block], *, what: str) -> Any:
    """A prism with domes and lower prisms on its flat top, as one body, checked by its volume.

    Raises:
        GeometryError: If the kernel did not close it.
    """
    from build123d import Face

    faces, holes = block.walls(), []
    for dome in domes:
        roof, ring = dome.faces()
        faces += roof
        holes.append(ring)
    for other in blocks:
        faces += [*other.walls(), other.top()]
        holes.append(other.foot())
    body = sewn([*faces, block.top(holes), Face(block.foot())], what=what)
    parts_mm3 = [block.volume_mm3, *(part.volume_mm3 for part in (*domes, *blocks))]
    return expect_volume(body, sum(parts_mm3), what=what)
