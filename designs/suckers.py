"""Suckers along a bent arm: cylinders that point away from the bend's axis, with a cup in the end.

They stand in one or two rows on the side away from the axis. What a sucker adds is a quadrature of
its length over the arm's side, so the volume of the whole is known; and because a small one could
be missed by that, each is looked for by the flat faces of its rim and of its cup.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from designs import distance
from designs.arm import Arm
from workbench.core.base.booleans import cut
from workbench.core.base.errors import DesignError, GeometryError

BETWEEN_MM = 0.5
"""Smallest gap between suckers, and from a sucker to base, end and side of the arm [mm]."""
LEAST_WALL_MM = 0.4
"""Thinnest wall of a sucker beside its cup [mm]."""


class Sucker(NamedTuple):
    """One sucker."""

    centre_mm: np.ndarray
    """Where its axis meets the arm's side, shape (3,)."""
    axis: np.ndarray
    """Unit direction away from the bend's axis, shape (3,)."""
    radius_mm: float
    root_mm: float
    """How deep it reaches into the arm."""
    out_mm: float
    """How far its rim is from the arm's side, along its axis."""
    cup_radius_mm: float
    cup_mm: float
    """Depth of the cup; 0 without one."""

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
        apart = [
            other.centre_mm - self.centre_mm,
            other.place_mm(other.out_mm) - self.place_mm(self.out_mm),
        ]
        return min(float(np.linalg.norm(a)) for a in apart) - self.radius_mm - other.radius_mm


class Row(NamedTuple):
    """What the suckers of a row have in common."""

    count: int
    pitch: float
    """Angle between neighbours about the bend's axis [radian]."""
    radius_mm: float
    out_mm: float
    """How far they stand out of the arm's ridge."""
    cup_ratio: float
    cup_depth: float
    """Depth of a cup over `out_mm`."""


def suckers_along(arm: Arm, row: Row, places_mm: Sequence[float]) -> list[Sucker]:
    """Suckers from the base up, centred between foot and end.

    Args:
        arm: What they stand on.
        row: What those of a row have in common.
        places_mm: X of each row.
    """
    angles = arm.turn / 2 + row.pitch * (np.arange(row.count) - (row.count - 1) / 2)
    found = []
    for angle in angles.tolist():
        for x_mm in places_mm:
            side_mm = float(arm.ridge_mm(np.array(x_mm)))
            found.append(
                Sucker(
                    centre_mm=arm.place_mm(angle, side_mm, x_mm),
                    axis=np.array([0.0, -math.cos(angle), math.sin(angle)]),
                    radius_mm=row.radius_mm,
                    root_mm=side_mm,
                    out_mm=row.out_mm + arm.half_mm[1] - side_mm,
                    cup_radius_mm=row.cup_ratio * row.radius_mm,
                    cup_mm=row.cup_depth * row.out_mm,
                )
            )
    return found


def check_suckers(arm: Arm, suckers: Sequence[Sucker]) -> None:
    """Refuse suckers that touch or stand over an edge of the arm, and whose wall is too thin.

    Raises:
        DesignError: Naming the field, its value and its limit.
    """
    first, last = suckers[0], suckers[-1]
    thinnest_mm = first.radius_mm - first.cup_radius_mm
    if first.cup_mm and thinnest_mm < LEAST_WALL_MM:
        raise DesignError(
            f"a sucker's wall is {thinnest_mm:.2g} mm beside its cup, less than "
            f"{LEAST_WALL_MM:g} mm",
            hint="lower shape.cup_ratio or raise shape.sucker_radius_mm",
            at="shape.cup_ratio",
        )
    beside_mm = arm.half_mm[0] - abs(float(first.centre_mm[0])) - first.radius_mm
    if beside_mm < BETWEEN_MM:
        raise DesignError(
            f"suckers reach to {beside_mm:.3g} mm from the arm's side, at least {BETWEEN_MM:g} mm "
            "must be left",
            hint="lower shape.sucker_radius_mm or shape.row_mm, or raise shape.width_mm",
            at="shape.sucker_radius_mm",
        )
    gaps = [first.lowest_mm, -float(arm.beyond_mm(last.centre_mm[None])[0]) - last.radius_mm]
    gaps += [one.gap_mm(two) for one, two in itertools.combinations(suckers, 2)]
    if min(gaps) < BETWEEN_MM:
        raise DesignError(
            f"the suckers stand {min(gaps):.2g} mm apart or from the arm's ends, less than "
            f"{BETWEEN_MM:g} mm",
            hint="lower shape.sucker_count or shape.sucker_radius_mm, or fit shape.pitch_deg and "
            "shape.row_mm to them",
            at="shape.sucker_count",
        )


def sucker_mm3(arm: Arm, sucker: Sucker) -> float:
    """What a sucker adds to the arm [mm3], less its cup.

    Over a place (p, q) of its section, p along X, the arm's side is at sqrt((R + u)^2 - q^2) along
    the axis, u the ridge over x + p. Gauss quadrature over the radius, equal steps around.
    """
    node, weight = np.polynomial.legendre.leggauss(40)
    radius = sucker.radius_mm * (node + 1.0) / 2.0
    turn = np.linspace(0.0, 2.0 * np.pi, 128, endpoint=False)
    p, q = radius[:, None] * np.cos(turn), radius[:, None] * np.sin(turn)
    x_mm, bend_mm = float(sucker.centre_mm[0]), arm.bend_radius_mm
    rim_mm = bend_mm + float(arm.ridge_mm(np.array(x_mm))) + sucker.out_mm
    side_mm = np.sqrt((bend_mm + arm.ridge_mm(x_mm + p)) ** 2 - q**2)
    around = (rim_mm - side_mm).mean(axis=1) * 2.0 * np.pi * radius
    whole = float(weight @ around) * sucker.radius_mm / 2.0
    return whole - math.pi * sucker.cup_radius_mm**2 * sucker.cup_mm


def sucker_body(sucker: Sucker) -> Any:
    """A sucker with its cup, from its root in the arm to its rim.

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
    if not sucker.cup_mm:
        return rod
    bottom = root.offset(sucker.root_mm + sucker.out_mm - sucker.cup_mm)
    bore = Solid.make_cylinder(sucker.cup_radius_mm, sucker.cup_mm, bottom)
    return cut(rod, bore, what="cup of the sucker")


def sucker_distance(sucker: Sucker, points_mm: np.ndarray) -> np.ndarray:
    """Signed distance to a sucker with its cup [mm], shape (N,)."""
    place = points_mm, sucker.centre_mm, sucker.axis
    rim_mm = sucker.out_mm
    rod = distance.cylinder(*place, sucker.radius_mm, (-sucker.root_mm, rim_mm))
    if not sucker.cup_mm:
        return rod
    # The cup's field reaches far out of the rim, so that only its bottom and side count.
    span_mm = rim_mm - sucker.cup_mm, rim_mm + 100.0
    return np.maximum(rod, -distance.cylinder(*place, sucker.cup_radius_mm, span_mm))


def expect_suckers(outer: Any, suckers: Sequence[Sucker]) -> None:
    """Each sucker must have its flat rim and, with a cup, a flat disc at the bottom of that.

    Raises:
        GeometryError: If one is missing: its volume is too little to miss it by.
    """
    faces = [(face.center(), face.area) for face in outer.faces()]
    for number, sucker in enumerate(suckers):
        cup_mm2 = math.pi * sucker.cup_radius_mm**2 if sucker.cup_mm else 0.0
        discs = [("rim", sucker.out_mm, math.pi * sucker.radius_mm**2 - cup_mm2)]
        if sucker.cup_mm:
            discs.append(("cup", sucker.out_mm - sucker.cup_mm, cup_mm2))
        for name, out_mm, area_mm2 in discs:
            if not any(_is_face(face, sucker.place_mm(out_mm), area_mm2) for face in faces):
                raise GeometryError(
                    f"the {name} of sucker {number + 1} is not there",
                    hint="change shape.sucker_radius_mm or shape.sucker_mm a little",
                    at="shape.sucker_radius_mm",
                )


def _is_face(face: tuple[Any, float], place: np.ndarray, area_mm2: float) -> bool:
    spot, area = face
    near = math.dist((spot.X, spot.Y, spot.Z), place.tolist()) < 1e-3
    return near and abs(area - area_mm2) < 1e-3 * area_mm2
