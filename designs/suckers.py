"""Suckers along a column: cylinders along the normal of its side, each bored by its cup.

They sit where the side toward +Y meets the plane x = 0. A sucker is too small to be missed by the
volume of the whole body, so each is looked for by the flat faces of its rim and of its cup.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from designs import distance
from designs.column import Column
from workbench.core.base.booleans import cut
from workbench.core.base.errors import GeometryError

SPAN = (0.22, 0.92)
"""Where the first and the last sucker sit, over the column's length."""
ROOT_SHARE = 0.5
"""How deep a sucker is rooted in the column, over the column's radius there."""


class Sucker(NamedTuple):
    """One sucker."""

    centre_mm: np.ndarray
    """Where its axis meets the column's side, shape (3,)."""
    axis: np.ndarray
    """Unit normal of the side there, shape (3,)."""
    radius_mm: float
    root_mm: float
    """How deep it reaches into the column."""
    out_mm: float
    """How far it stands out."""
    cup_radius_mm: float
    cup_depth: float
    """Depth of the cup over how far the sucker stands out."""

    @property
    def lowest_mm(self) -> float:
        """Height of its lowest point over the base [mm]."""
        ends = (self.place_mm(-self.root_mm)[2], self.place_mm(self.out_mm)[2])
        return float(min(ends)) - self.radius_mm * math.hypot(self.axis[0], self.axis[1])

    def place_mm(self, out_mm: float) -> np.ndarray:
        """Place on its axis so far out of the side [mm], shape (3,)."""
        return self.centre_mm + out_mm * self.axis

    def gap_mm(self, other: Sucker) -> float:
        """Room between two suckers [mm], the least of that at the roots and at the rims."""
        # Bent toward each other, rims come nearer than roots: both ends are compared.
        apart = [other.place_mm(out) - self.place_mm(out) for out in (0.0, self.out_mm)]
        return min(float(np.linalg.norm(a)) - self.radius_mm - other.radius_mm for a in apart)


def suckers_along(
    column: Column, count: int, *, ratio: float, out_mm: float, cup_ratio: float, cup_depth: float
) -> list[Sucker]:
    """Suckers evenly spaced from the base up.

    Args:
        ratio: Radius of a sucker over the column's half axis along Y at its place.
        out_mm: How far they stand out.
        cup_ratio: Radius of the cup over that of the sucker.
        cup_depth: Depth of the cup over how far the sucker stands out.
    """
    share = np.linspace(*SPAN, count) if count > 1 else np.array([sum(SPAN) / 2])
    z = share * column.length_mm
    radius, centre = column.half_axes(z)[:, 1], column.centres(z)[:, 1]
    narrowing = -2.0 * (column.foot_mm[1] - column.head_mm[1]) * (1.0 - share)
    slope = column.slopes(z)[:, 1] + narrowing / column.length_mm
    found = []
    for i in range(count):
        axis = np.array([0.0, 1.0, -slope[i]]) / math.hypot(1.0, slope[i])
        radius_mm = float(ratio * radius[i])
        found.append(
            Sucker(
                centre_mm=np.array([0.0, centre[i] + radius[i], z[i]]),
                axis=axis,
                radius_mm=radius_mm,
                root_mm=float(ROOT_SHARE * radius[i]),
                out_mm=out_mm,
                cup_radius_mm=cup_ratio * radius_mm,
                cup_depth=cup_depth,
            )
        )
    return found


def sucker_body(sucker: Sucker) -> Any:
    """A sucker with its cup, from its root in the column to its rim.

    Raises:
        GeometryError: If the cup was not cut.
    """
    from build123d import Plane, Solid

    root = Plane(
        origin=tuple(sucker.place_mm(-sucker.root_mm).tolist()),
        x_dir=(1, 0, 0),
        z_dir=tuple(sucker.axis.tolist()),
    )
    rod = Solid.make_cylinder(sucker.radius_mm, sucker.root_mm + sucker.out_mm, root)
    depth_mm = sucker.cup_depth * sucker.out_mm
    bottom = root.offset(sucker.root_mm + sucker.out_mm - depth_mm)
    bore = Solid.make_cylinder(sucker.cup_radius_mm, depth_mm, bottom)
    return cut(rod, bore, what="cup of the sucker")


def sucker_distance(sucker: Sucker, points_mm: np.ndarray) -> np.ndarray:
    """Signed distance to a sucker with its cup [mm], shape (N,)."""
    place = points_mm, sucker.centre_mm, sucker.axis
    rim_mm = sucker.out_mm
    rod = distance.cylinder(*place, sucker.radius_mm, (-sucker.root_mm, rim_mm))
    # The cup's field reaches far out of the rim, so that only its bottom and side count.
    span_mm = rim_mm * (1.0 - sucker.cup_depth), rim_mm + 100.0
    return np.maximum(rod, -distance.cylinder(*place, sucker.cup_radius_mm, span_mm))


def expect_suckers(outer: Any, suckers: Sequence[Sucker]) -> None:
    """Each sucker must have a flat ring for its rim and a flat disc at the bottom of its cup.

    Raises:
        GeometryError: If one is missing: its volume is too little to miss it by.
    """
    faces = [(face.center(), face.area) for face in outer.faces()]
    for number, sucker in enumerate(suckers):
        cup_mm2 = math.pi * sucker.cup_radius_mm**2
        rim_mm2 = math.pi * sucker.radius_mm**2 - cup_mm2
        bottom_mm = sucker.out_mm * (1.0 - sucker.cup_depth)
        discs = (("rim", sucker.out_mm, rim_mm2), ("cup", bottom_mm, cup_mm2))
        for name, out_mm, area_mm2 in discs:
            if not any(_is_face(face, sucker.place_mm(out_mm), area_mm2) for face in faces):
                raise GeometryError(
                    f"the {name} of sucker {number + 1} is not there",
                    hint="change shape.sucker_ratio or shape.sucker_mm a little",
                    at="shape.sucker_ratio",
                )


def _is_face(face: tuple[Any, float], place: np.ndarray, area_mm2: float) -> bool:
    spot, area = face
    near = math.dist((spot.X, spot.Y, spot.Z), place.tolist()) < 1e-3
    return near and abs(area - area_mm2) < 1e-3 * area_mm2
