"""Tentacle: a tapered, bent arm with tubular suckers along one side.

An octopus feels through its suckers: each is a short tube with an open cup at its end.

              .-.             z = length_mm + tip_mm
             /   \\
            |     |=]         suckers on the +Y side, smaller toward the tip
           |  .-.  |
           | |   | |==]
          |  |   |  |         outside in: elastomer, support (rigid, clear), cavity
          |  |   |  |===]
         |  |     |  |
     ____|__|_____|__|____    z = 0, base plane
    |       | cam |       |
    |_______|_____|_______|   z = -base_height_mm, the rigid foot

| parameter        | meaning                                                       |
|------------------|---------------------------------------------------------------|
| `base_radius_mm` | radius of the arm at the base                                 |
| `tip_radius_mm`  | radius of the arm at the root of its rounded tip              |
| `length_mm`      | height at which the tip begins                                |
| `bend_mm`        | shift of the centre line toward +Y at `length_mm`             |
| `sucker_count`   | number of suckers, evenly spaced                              |
| `sucker_ratio`   | radius of a sucker over the arm's radius at its place         |
| `sucker_mm`      | how far the suckers stand out                                 |
| `cup_ratio`      | radius of the cup over that of the sucker                     |
| `cup_depth`      | depth of the cup over how far the sucker stands out           |
| `base_height_mm` | height of the foot                                            |
| `base_lip_mm`    | how far the foot stands out beyond the skin                   |

The arm is the bent column of `designs/column.py`, with a core smaller by the wall. A sucker is a
cylinder along the normal of the arm's side, bored by its cup.

Source of the defaults: our choice, an arm of the size of the finger. Leaves out: two rows of
suckers, the muscle ring inside a sucker, screw holes in the foot.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from designs import distance
from designs.bodies import WALL_SHARE, Bodies, Fields
from designs.column import Column, column_body, column_field
from designs.prisms import elliptic_foot
from designs.shells import hollow
from designs.sliders import slider
from workbench.core.base.booleans import cut, fuse
from workbench.core.base.errors import DesignError, GeometryError
from workbench.core.design.design import Layers

CAVITY_MM = 2.0
"""Smallest half width of the cavity: room for a small camera [mm]."""
BETWEEN_MM = 0.5
"""Smallest gap between suckers, and from a sucker to the base [mm]."""
SPAN = (0.22, 0.92)
"""Where the first and the last sucker sit, over the arm's length."""
ROOT_SHARE = 0.5
"""How deep a sucker is rooted in the arm, over the arm's radius there."""
LEAST_WALL_MM = 0.4
"""Thinnest wall of a sucker beside its cup [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TentacleShape:
    """The tentacle's own parameters."""

    base_radius_mm: float = slider(
        14.0, (9.0, 24.0, 0.5), "mm", "Base radius", "Radius of the arm at the base"
    )
    tip_radius_mm: float = slider(
        8.0, (5.0, 16.0, 0.5), "mm", "Tip radius", "Radius of the arm where its tip begins"
    )
    length_mm: float = slider(
        40.0, (20.0, 80.0, 0.5), "mm", "Arm length", "From base to the root of the tip"
    )
    bend_mm: float = slider(
        6.0, (0.0, 12.0, 0.5), "mm", "Bend", "Shift of the centre line toward the suckers"
    )
    sucker_count: float = slider(3.0, (1.0, 6.0, 1.0), "", "Suckers", "Suckers along the arm")
    sucker_ratio: float = slider(
        0.38, (0.2, 0.5, 0.01), "", "Sucker size", "Radius of a sucker over the arm's there"
    )
    sucker_mm: float = slider(
        3.0, (1.0, 6.0, 0.25), "mm", "Sucker height", "How far the suckers stand out"
    )
    cup_ratio: float = slider(
        0.65, (0.4, 0.8, 0.05), "", "Cup size", "Radius of the cup over that of the sucker"
    )
    cup_depth: float = slider(
        0.6, (0.2, 0.8, 0.05), "", "Cup depth", "Over how far the sucker stands out"
    )
    base_height_mm: float = slider(
        8.0, (2.0, 40.0, 0.5), "mm", "Foot height", "Rigid foot that carries camera and LEDs"
    )
    base_lip_mm: float = slider(
        3.0, (0.0, 15.0, 0.5), "mm", "Foot lip", "How far the foot stands out beyond the skin"
    )

    @property
    def column(self) -> Column:
        """The arm without its suckers; its tip is half a sphere, sheared by the bend."""
        base, tip = self.base_radius_mm, self.tip_radius_mm
        return Column(
            foot_mm=(base, base),
            head_mm=(tip, tip),
            length_mm=self.length_mm,
            tip_mm=tip,
            bend_mm=(0.0, self.bend_mm),
        )


class Sucker(NamedTuple):
    """One sucker."""

    centre_mm: np.ndarray
    """Where its axis meets the arm's side, shape (3,)."""
    axis: np.ndarray
    """Unit normal of the side there, shape (3,)."""
    radius_mm: float
    root_mm: float
    """How deep it reaches into the arm."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Tentacle:
    """Builds tentacles."""

    name: str = "tentacle"
    title: str = "Octopus tentacle"
    shape_type: type = TentacleShape

    def check(self, shape: TentacleShape, layers: Layers) -> None:
        """Refuse arms that widen or narrow too fast, walls without room, and suckers that touch.

        Raises:
            DesignError: Naming the field, its value and its limit.
        """
        if shape.tip_radius_mm > shape.base_radius_mm:
            raise DesignError(
                f"tip radius {shape.tip_radius_mm:g} mm is more than the base radius "
                f"{shape.base_radius_mm:g} mm",
                hint="lower shape.tip_radius_mm or raise shape.base_radius_mm",
                at="shape.tip_radius_mm",
            )
        both_mm = layers.elastomer_mm + layers.support_mm
        if shape.tip_radius_mm - both_mm < CAVITY_MM:
            raise DesignError(
                f"support and elastomer wall together {both_mm:g} mm leave less than "
                f"{CAVITY_MM:g} mm of cavity inside the tip radius {shape.tip_radius_mm:g} mm",
                hint="lower layers.elastomer_mm or layers.support_mm, or raise shape.tip_radius_mm",
                at="layers.elastomer_mm",
            )
        _check_slope(shape, layers)
        _check_suckers(shape)

    def soften(self, shape: TentacleShape) -> None:
        """There is no fillet to make smaller."""
        return None

    def target(self, shape: TentacleShape, layers: Layers) -> tuple[float, float, float]:
        """The end of the arm: dents of the suckers lie where the camera does not see them."""
        return shape.column.apex_mm

    def build(self, shape: TentacleShape, layers: Layers) -> Bodies:
        """Build the five bodies.

        Raises:
            DesignError: As `check`.
            GeometryError: If the CAD kernel returned something else than asked for, or a sucker
                or its cup is missing.
        """
        self.check(shape, layers)
        outer = column_body(shape.column, what="arm")
        for number, sucker in enumerate(_suckers(shape)):
            outer = fuse(outer, _tube(shape, sucker), what=f"sucker {number + 1}")
        _expect_suckers(outer, shape)
        core = column_body(shape.column.inset(layers.elastomer_mm), what="core")
        both_mm = layers.elastomer_mm + layers.support_mm
        cavity = column_body(shape.column.inset(both_mm), what="cavity")
        return Bodies(
            membrane=hollow(outer, core, what="elastomer"),
            outer=outer,
            core=core,
            support=hollow(core, cavity, what="support"),
            base=_foot(shape, layers),
        )

    def fields(self, shape: TentacleShape, layers: Layers) -> Fields:
        """A bent column and bored cylinders as signed distance fields."""
        self.check(shape, layers)
        column = shape.column
        arm, suckers = column_field(column), _suckers(shape)

        def outer(points_mm: np.ndarray) -> np.ndarray:
            whole = arm(points_mm)
            for sucker in suckers:
                whole = np.minimum(whole, _tube_distance(shape, sucker, points_mm))
            return whole

        low, high = (np.array(corner) for corner in column.box_mm())
        for sucker in suckers:
            rim = sucker.centre_mm + shape.sucker_mm * sucker.axis
            reach = sucker.radius_mm * np.sqrt(1.0 - sucker.axis**2)
            low, high = np.minimum(low, rim - reach), np.maximum(high, rim + reach)
        return Fields(
            outer=outer,
            core=column_field(column.inset(layers.elastomer_mm)),
            cavity=column_field(column.inset(layers.elastomer_mm + layers.support_mm)),
            base=_foot(shape, layers),
            wall_mm=layers.elastomer_mm,
            low_mm=tuple(low.tolist()),
            high_mm=tuple(high.tolist()),
        )


def _suckers(shape: TentacleShape) -> list[Sucker]:
    """All suckers from the base up, on the line where the arm meets the plane x = 0."""
    column, count = shape.column, round(shape.sucker_count)
    share = np.linspace(*SPAN, count) if count > 1 else np.array([sum(SPAN) / 2])
    z = share * shape.length_mm
    radius, centre = column.half_axes(z)[:, 1], column.centres(z)[:, 1]
    narrowing = -2.0 * (shape.base_radius_mm - shape.tip_radius_mm) * (1.0 - share)
    slope = column.slopes(z)[:, 1] + narrowing / shape.length_mm
    found = []
    for i in range(count):
        axis = np.array([0.0, 1.0, -slope[i]]) / math.hypot(1.0, slope[i])
        found.append(
            Sucker(
                centre_mm=np.array([0.0, centre[i] + radius[i], z[i]]),
                axis=axis,
                radius_mm=float(shape.sucker_ratio * radius[i]),
                root_mm=float(ROOT_SHARE * radius[i]),
            )
        )
    return found


def _check_slope(shape: TentacleShape, layers: Layers) -> None:
    """Refuse tapers and bends so steep that the wall, even level by level, gets thin."""
    share = shape.column.wall_share
    if share < WALL_SHARE:
        raise DesignError(
            f"taper and bend over {shape.length_mm:g} mm thin the elastomer wall to "
            f"{share * layers.elastomer_mm:.2f} mm, less than {WALL_SHARE:.0%} of "
            f"{layers.elastomer_mm:g} mm",
            hint="raise shape.length_mm or shape.tip_radius_mm, or lower shape.base_radius_mm",
            at="shape.length_mm",
        )


def _check_suckers(shape: TentacleShape) -> None:
    """Refuse suckers that touch each other or the base, or whose wall is too thin."""
    if shape.sucker_count != round(shape.sucker_count):
        raise DesignError(
            f"sucker count {shape.sucker_count:g} is not a whole number",
            hint=f"choose {round(shape.sucker_count)}",
            at="shape.sucker_count",
        )
    suckers = _suckers(shape)
    thinnest_mm = min(sucker.radius_mm for sucker in suckers) * (1.0 - shape.cup_ratio)
    if thinnest_mm < LEAST_WALL_MM:
        raise DesignError(
            f"the smallest sucker's wall is {thinnest_mm:.2g} mm beside its cup, less than "
            f"{LEAST_WALL_MM:g} mm",
            hint="lower shape.cup_ratio or raise shape.sucker_ratio",
            at="shape.cup_ratio",
        )
    # Bent toward each other, rims come nearer than roots: both ends are compared.
    gaps = [_lowest_mm(shape, suckers[0])]
    for one, two in itertools.pairwise(suckers):
        for out_mm in (0.0, shape.sucker_mm):
            apart = two.centre_mm + out_mm * two.axis - one.centre_mm - out_mm * one.axis
            gaps.append(float(np.linalg.norm(apart)) - one.radius_mm - two.radius_mm)
    if min(gaps) < BETWEEN_MM:
        raise DesignError(
            f"the suckers stand {min(gaps):.2g} mm apart or from the base, less than "
            f"{BETWEEN_MM:g} mm",
            hint="lower shape.sucker_count or shape.sucker_ratio, or raise shape.length_mm",
            at="shape.sucker_count",
        )


def _lowest_mm(shape: TentacleShape, sucker: Sucker) -> float:
    """Height of a sucker's lowest point over the base [mm]."""
    ends = (
        (sucker.centre_mm - sucker.root_mm * sucker.axis)[2],
        (sucker.centre_mm + shape.sucker_mm * sucker.axis)[2],
    )
    return float(min(ends)) - sucker.radius_mm * math.hypot(sucker.axis[0], sucker.axis[1])


def _tube(shape: TentacleShape, sucker: Sucker) -> Any:
    """A sucker with its cup, from its root in the arm to its rim."""
    from build123d import Plane, Solid

    root = Plane(
        origin=tuple((sucker.centre_mm - sucker.root_mm * sucker.axis).tolist()),
        x_dir=(1, 0, 0),
        z_dir=tuple(sucker.axis.tolist()),
    )
    rod = Solid.make_cylinder(sucker.radius_mm, sucker.root_mm + shape.sucker_mm, root)
    depth_mm = shape.cup_depth * shape.sucker_mm
    bottom = root.offset(sucker.root_mm + shape.sucker_mm - depth_mm)
    bore = Solid.make_cylinder(shape.cup_ratio * sucker.radius_mm, depth_mm, bottom)
    return cut(rod, bore, what="cup of the sucker")


def _tube_distance(shape: TentacleShape, sucker: Sucker, points_mm: np.ndarray) -> np.ndarray:
    place = points_mm, sucker.centre_mm, sucker.axis
    rim_mm = shape.sucker_mm
    rod = distance.cylinder(*place, sucker.radius_mm, (-sucker.root_mm, rim_mm))
    cup_mm = shape.cup_ratio * sucker.radius_mm
    # The cup's field reaches far out of the rim, so that only its bottom and side count.
    cup = distance.cylinder(*place, cup_mm, (rim_mm * (1.0 - shape.cup_depth), rim_mm + 100.0))
    return np.maximum(rod, -cup)


def _expect_suckers(outer: Any, shape: TentacleShape) -> None:
    """Each sucker must have a flat ring for its rim and a flat disc at the bottom of its cup.

    Raises:
        GeometryError: If one is missing: its volume is too little to miss it by.
    """
    faces = [(face.center(), face.area) for face in outer.faces()]
    for number, sucker in enumerate(_suckers(shape)):
        cup_mm2 = math.pi * (shape.cup_ratio * sucker.radius_mm) ** 2
        rim_mm2 = math.pi * sucker.radius_mm**2 - cup_mm2
        bottom_mm = shape.sucker_mm * (1.0 - shape.cup_depth)
        for name, out_mm, area_mm2 in (
            ("rim", shape.sucker_mm, rim_mm2),
            ("cup", bottom_mm, cup_mm2),
        ):
            place = sucker.centre_mm + out_mm * sucker.axis
            if not any(_is_face(face, place, area_mm2) for face in faces):
                raise GeometryError(
                    f"the {name} of sucker {number + 1} is not there",
                    hint="change shape.sucker_ratio or shape.sucker_mm a little",
                    at="shape.sucker_ratio",
                )


def _is_face(face: tuple[Any, float], place: np.ndarray, area_mm2: float) -> bool:
    spot, area = face
    near = math.dist((spot.X, spot.Y, spot.Z), place.tolist()) < 1e-3
    return near and abs(area - area_mm2) < 1e-3 * area_mm2


def _foot(shape: TentacleShape, layers: Layers) -> Any:
    radius_mm = shape.base_radius_mm
    cavity_mm = radius_mm - layers.elastomer_mm - layers.support_mm
    half = radius_mm, radius_mm
    return elliptic_foot(half, cavity_mm, shape.base_height_mm, shape.base_lip_mm)


FAMILY = Tentacle()
