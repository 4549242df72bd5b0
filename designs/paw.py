"""Paw: a cat's paw, four toe pads and one large pad standing proud on a lobed body.

           _   _   _   _          seen from above: toes toward +Y
          ( ) ( ) ( ) ( )
           `-. `---' .-'
          |   .-----.   |         the large (metacarpal) pad
           `. (_____) .'
             `-.___.-'

            .-. ___ .-.           z = height_mm + pad_mm, tops of the pads
          _/   `   `   \\_         z = height_mm, the flat top of the body
         |  ___________  |        outside in: elastomer, support (rigid, clear), cavity
         | |           | |
     ____|_|___________|_|____    z = 0, base plane
    |         | cam |         |
    |_________|_____|_________|   z = -base_height_mm, the rigid foot

| parameter        | meaning                                                       |
|------------------|---------------------------------------------------------------|
| `radius_mm`      | radius of the body between its toes                           |
| `height_mm`      | height of the flat top over the base                          |
| `toe_mm`         | how far the toes bulge out of the round body                  |
| `toe_spread_deg` | angle from the first toe to the fourth                        |
| `pad_mm`         | how far the pads stand out of the top                         |
| `toe_pad_mm`     | radius of a toe pad where it leaves the top                   |
| `large_pad_mm`   | half width of the large pad there                             |
| `rim_mm`         | radius of the rounded top rim                                 |
| `base_height_mm` | height of the foot                                            |
| `base_lip_mm`    | how far the foot stands out beyond the skin                   |

The outline is r(phi) = radius + toe sum_i exp(k (cos(phi - phi_i) - 1)), smooth and seen whole
from the axis. The core's outline is less by the wall along the normal, its top flat. Pads are
spheres through the top, the large one a sphere drawn out along X: their volume is a closed form.

Source of the defaults: our choice, after pictures of a cat's paw. Leaves out: claws, the dewclaw,
the notch of the large pad, screw holes in the foot.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from designs import distance
from designs.bodies import Bodies, Fields
from designs.prisms import elliptic_foot, rounded_prism
from designs.shells import hollow
from designs.sliders import slider
from workbench.core.base.booleans import expect_volume, fuse, volume
from workbench.core.base.errors import DesignError, GeometryError
from workbench.core.design.design import Layers
from workbench.core.result.marks import Field

TOES = 4
SHARPNESS = 14.0
"""k of the toes' bulges: each is about 30 degrees wide."""
CAVITY_MM = 3.0
"""Smallest half width and height of the cavity: room for camera and LEDs [mm]."""
BETWEEN_MM = 0.4
"""Smallest gap between pads, and from a pad to the rounded rim [mm]."""
LARGE_STRETCH = 0.5
"""Half the straight part of the large pad along X, over its half width along Y."""
LARGE_PLACE = -0.27
"""Place of the large pad on Y, over the radius of the body."""
STEEPEST = 0.95
"""Highest pad over its radius: at 1 its side would stand upright on the top."""
PAD_LIMIT = 1e-3
"""Tolerance of the body's volume with pads; the kernel integrates trimmed faces to 2e-4."""
APEX_MM = 1e-3
"""How near the highest point of a pad's faces must be to the height asked for [mm]."""
CORE_RIM_SHARE = 0.4
"""Most of a core's narrowest bend that its rim radius may take; the body's own never is narrower
than 3 mm, and its rim at most 2.5 mm."""
OUTLINE_POINTS = 48
"""Points through which the outline is drawn: within 0.005 mm on 60 random paws. Fewer are faster,
but the kernel then fails to round twice as many cores."""
SAMPLES = 1440


@dataclass(frozen=True, kw_only=True, slots=True)
class PawShape:
    """The paw's own parameters."""

    radius_mm: float = slider(
        15.0, (11.0, 26.0, 0.5), "mm", "Radius", "Radius of the body between its toes"
    )
    height_mm: float = slider(
        24.0, (14.0, 50.0, 0.5), "mm", "Height", "From the base to the flat top"
    )
    toe_mm: float = slider(
        2.0, (0.5, 3.0, 0.1), "mm", "Toe bulge", "How far the toes stand out of the round body"
    )
    toe_spread_deg: float = slider(
        135.0, (120.0, 160.0, 1.0), "degree", "Toe spread", "From the first toe to the fourth"
    )
    pad_mm: float = slider(
        2.0, (0.5, 4.0, 0.1), "mm", "Pad height", "How far the pads stand out of the top"
    )
    toe_pad_mm: float = slider(
        3.0, (1.5, 5.0, 0.1), "mm", "Toe pad radius", "Of a toe pad where it leaves the top"
    )
    large_pad_mm: float = slider(
        4.5, (2.5, 8.0, 0.1), "mm", "Large pad", "Half width of the large pad along Y"
    )
    rim_mm: float = slider(
        1.5, (0.5, 2.5, 0.1), "mm", "Rim radius", "Rounding of the top rim and of the core's"
    )
    base_height_mm: float = slider(
        8.0, (2.0, 40.0, 0.5), "mm", "Foot height", "Rigid foot that carries camera and LEDs"
    )
    base_lip_mm: float = slider(
        2.0, (0.0, 15.0, 0.5), "mm", "Foot lip", "How far the foot stands out beyond the toes"
    )

    @property
    def toes_rad(self) -> np.ndarray:
        """Azimuth of each toe [rad], symmetric about +Y."""
        half = math.radians(self.toe_spread_deg) / 2
        return np.pi / 2 + np.linspace(-half, half, TOES)

    @property
    def large_ends_mm(self) -> np.ndarray:
        """Ends of the large pad's middle line [mm], shape (2, 2)."""
        x_mm, y_mm = LARGE_STRETCH * self.large_pad_mm, LARGE_PLACE * self.radius_mm
        return np.array([[-x_mm, y_mm], [x_mm, y_mm]])

    @property
    def toe_places_mm(self) -> np.ndarray:
        """Middle of each toe pad [mm], shape (4, 2): as far out as the rim lets it."""
        turn = self.toes_rad
        reach = Outline(self, 0.0).radius(turn) - self.rim_mm - BETWEEN_MM - self.toe_pad_mm
        return reach[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])


class Outline:
    """The body's outline less by an inset, in polar coordinates about the axis."""

    def __init__(self, shape: PawShape, inset_mm: float) -> None:
        self._shape, self._inset_mm = shape, inset_mm
        # The kernel's spline begins and ends at -Y, where the outline is plain.
        self.turn = -np.pi / 2 + np.arange(SAMPLES) * (2.0 * np.pi / SAMPLES)
        radius = self.radius(self.turn)
        self.points_mm = radius[:, None] * np.column_stack([np.cos(self.turn), np.sin(self.turn)])
        step = 2.0 * np.pi / SAMPLES
        first = (np.roll(radius, -1) - np.roll(radius, 1)) / (2.0 * step)
        second = (np.roll(radius, -1) - 2.0 * radius + np.roll(radius, 1)) / step**2
        speed = np.hypot(radius, first)
        self.least_mm = float(radius.min())
        self.greatest_mm = float(radius.max())
        self.area_mm2 = float((radius**2).mean() * np.pi)
        self.perimeter_mm = float(speed.mean() * 2.0 * np.pi)
        bend = (radius**2 + 2.0 * first**2 - radius * second) / speed**3
        self.bend_mm = float(1.0 / bend.max())
        """Radius of the narrowest convex bend."""

    def radius(self, turn: np.ndarray) -> np.ndarray:
        """Distance from the axis [mm]: the wall is measured along the outer normal."""
        shape = self._shape
        away = turn[:, None] - shape.toes_rad
        bulge = shape.toe_mm * np.exp(SHARPNESS * (np.cos(away) - 1.0))
        outside = shape.radius_mm + bulge.sum(axis=1)
        slope = -(SHARPNESS * np.sin(away) * bulge).sum(axis=1)
        return outside - self._inset_mm * np.sqrt(1.0 + (slope / outside) ** 2)

    def edges(self) -> list[Any]:
        """The outline as two edges in the plane z = 0.

        Two, because the kernel integrates the area inside one long spline to 1e-3 only, inside
        its halves to 1e-5.
        """
        from build123d import Edge

        spots = self.points_mm[:: SAMPLES // OUTLINE_POINTS]
        whole = Edge.make_spline([(x, y, 0.0) for x, y in spots.tolist()], periodic=True)
        return [whole.trim(0.0, 0.5), whole.trim(0.5, 1.0)]

    def distance(self, points_mm: np.ndarray) -> np.ndarray:
        """Signed distance to the outline, first order, shape (N,)."""
        beside = np.hypot(points_mm[:, 0], points_mm[:, 1])
        turn = np.arctan2(points_mm[:, 1], points_mm[:, 0])
        # Interpolated in a table: the exponentials of four toes a point would take seconds.
        table = np.append(self.turn, self.turn[0] + 2.0 * np.pi)
        radius = np.linalg.norm(self.points_mm, axis=1)
        slope = np.gradient(np.concatenate([radius[-1:], radius, radius[:1]]))[1:-1]
        slope *= SAMPLES / (2.0 * np.pi)
        around = (turn + np.pi / 2) % (2.0 * np.pi) - np.pi / 2
        here = np.interp(around, table, np.append(radius, radius[0]))
        rise = np.interp(around, table, np.append(slope, slope[0]))
        return (beside - here) / np.sqrt(1.0 + (rise / np.maximum(beside, here / 2)) ** 2)


@dataclass(frozen=True, kw_only=True, slots=True)
class Paw:
    """Builds paws."""

    name: str = "paw"
    title: str = "Cat's paw"
    shape_type: type = PawShape

    def check(self, shape: PawShape, layers: Layers) -> None:
        """Refuse pads that meet, and walls that leave no room.

        Raises:
            DesignError: Naming the field, its value and its limit.
        """
        outline = Outline(shape, 0.0)
        both_mm = layers.elastomer_mm + layers.support_mm
        room_mm = min(Outline(shape, both_mm).least_mm, shape.height_mm - both_mm)
        if room_mm < CAVITY_MM:
            raise DesignError(
                f"support and elastomer wall together {both_mm:g} mm leave {room_mm:.3g} mm of "
                f"cavity, less than {CAVITY_MM:g} mm",
                hint="lower layers.elastomer_mm or layers.support_mm, or raise shape.radius_mm or "
                "shape.height_mm",
                at="layers.elastomer_mm",
            )
        _check_pads(shape, outline)

    def soften(self, shape: PawShape) -> PawShape:
        """The paw with half the rim radius."""
        return replace(shape, rim_mm=shape.rim_mm / 2)

    def target(self, shape: PawShape, layers: Layers) -> tuple[float, float, float]:
        """The middle of the large pad."""
        return 0.0, float(shape.large_ends_mm[0, 1]), shape.height_mm + shape.pad_mm

    def build(self, shape: PawShape, layers: Layers) -> Bodies:
        """Build the five bodies.

        Raises:
            DesignError: As `check`.
            GeometryError: If the CAD kernel returned something else than asked for, or a pad is
                missing.
        """
        self.check(shape, layers)
        both_mm = layers.elastomer_mm + layers.support_mm
        outer = _prism(shape, 0.0, what="body")
        expected_mm3 = volume(outer) + pads_mm3(shape)
        outer = fuse(outer, _pads(shape), what="pads")
        expect_volume(outer, expected_mm3, what="pads", relative=PAD_LIMIT)
        _expect_pads(outer, shape)
        core = _prism(shape, layers.elastomer_mm, what="core")
        return Bodies(
            membrane=hollow(outer, core, what="elastomer"),
            outer=outer,
            core=core,
            support=hollow(core, _prism(shape, both_mm, what="cavity"), what="support"),
            base=_foot(shape, layers),
        )

    def fields(self, shape: PawShape, layers: Layers) -> Fields:
        """Lobed prisms and spheres as signed distance fields."""
        self.check(shape, layers)
        body, ball = _prism_field(shape, 0.0), _ball(shape, shape.toe_pad_mm)
        large = _ball(shape, shape.large_pad_mm)
        low_mm = shape.height_mm - 0.5 * BETWEEN_MM

        def outer(points_mm: np.ndarray) -> np.ndarray:
            pads = [_to_segment(points_mm, shape.large_ends_mm, large[1]) - large[0]]
            for place in shape.toe_places_mm:
                pads.append(_to_segment(points_mm, np.stack([place, place]), ball[1]) - ball[0])
            above = np.maximum(np.minimum.reduce(pads), low_mm - points_mm[:, 2])
            return np.minimum(body(points_mm), above)

        low, high = Outline(shape, 0.0).points_mm.min(axis=0), Outline(shape, 0.0).points_mm.max(0)
        return Fields(
            outer=outer,
            core=_prism_field(shape, layers.elastomer_mm),
            cavity=_prism_field(shape, layers.elastomer_mm + layers.support_mm),
            base=_foot(shape, layers),
            wall_mm=layers.elastomer_mm,
            low_mm=(float(low[0]), float(low[1]), 0.0),
            high_mm=(float(high[0]), float(high[1]), shape.height_mm + shape.pad_mm),
        )


def cap_mm3(radius_mm: float, rise_mm: float, length_mm: float) -> float:
    """Volume of a spherical cap, drawn out by a length [mm3].

    pi h (3 a^2 + h^2) / 6 plus the length times the segment R^2 acos((R - h) / R) - (R - h) a.
    """
    ball_mm = (radius_mm**2 + rise_mm**2) / (2.0 * rise_mm)
    under = ball_mm - rise_mm
    segment = ball_mm**2 * math.acos(under / ball_mm) - under * radius_mm
    return math.pi * rise_mm * (3.0 * radius_mm**2 + rise_mm**2) / 6.0 + length_mm * segment


def pads_mm3(shape: PawShape) -> float:
    """Volume of all pads above the top [mm3]."""
    length_mm = 2.0 * LARGE_STRETCH * shape.large_pad_mm
    large = cap_mm3(shape.large_pad_mm, shape.pad_mm, length_mm)
    return TOES * cap_mm3(shape.toe_pad_mm, shape.pad_mm, 0.0) + large


def _check_pads(shape: PawShape, outline: Outline) -> None:
    """Refuse pads that are too steep, touch each other or reach into the rim."""
    for name in ("toe_pad_mm", "large_pad_mm"):
        if shape.pad_mm > STEEPEST * getattr(shape, name):
            raise DesignError(
                f"pads {shape.pad_mm:g} mm high overhang at a radius of {getattr(shape, name):g} "
                f"mm; the limit is {STEEPEST:g} times the radius",
                hint=f"lower shape.pad_mm or raise shape.{name}",
                at="shape.pad_mm",
            )
    toes, large = shape.toe_places_mm, shape.large_ends_mm
    gaps = {
        "toe pads": np.linalg.norm(np.diff(toes, axis=0), axis=1) - 2 * shape.toe_pad_mm,
        "toe pads and large pad": _flat_segment(toes, large)
        - shape.toe_pad_mm
        - shape.large_pad_mm,
        "large pad and rim": _flat_segment(outline.points_mm, large)
        - shape.large_pad_mm
        - shape.rim_mm,
        "toe pads and rim": _nearest(toes, outline.points_mm) - shape.toe_pad_mm - shape.rim_mm,
    }
    for what, gap in gaps.items():
        # Toe pads stand at the smallest gap from the rim by design, but for the bend of the toe.
        least_mm = BETWEEN_MM / 2 if what == "toe pads and rim" else BETWEEN_MM
        if gap.min() < least_mm:
            raise DesignError(
                f"{what} are {float(gap.min()):.2g} mm apart, less than {least_mm:g} mm",
                hint="lower shape.toe_pad_mm or shape.large_pad_mm, or raise shape.radius_mm",
                at="shape.large_pad_mm" if "large" in what else "shape.toe_pad_mm",
            )


def _nearest(points_mm: np.ndarray, others_mm: np.ndarray) -> np.ndarray:
    return np.linalg.norm(points_mm[:, None] - others_mm[None], axis=2).min(axis=1)


def _flat_segment(points_mm: np.ndarray, ends_mm: np.ndarray) -> np.ndarray:
    """Distance of points (N, 2) to a segment along X [mm]."""
    beyond = np.maximum(np.abs(points_mm[:, 0]) - ends_mm[1, 0], 0.0)
    return np.hypot(beyond, points_mm[:, 1] - ends_mm[0, 1])


def _to_segment(points_mm: np.ndarray, ends_mm: np.ndarray, height_mm: float) -> np.ndarray:
    """Distance to a level segment along X [mm]: the middle line of a pad's ball."""
    x = points_mm[:, 0] - np.clip(points_mm[:, 0], ends_mm[0, 0], ends_mm[1, 0])
    rest = (points_mm[:, 1] - ends_mm[0, 1]) ** 2 + (points_mm[:, 2] - height_mm) ** 2
    return np.sqrt(x**2 + rest)


def _ball(shape: PawShape, radius_mm: float) -> tuple[float, float]:
    """Radius of a pad's sphere and height of its centre [mm]."""
    ball_mm = (radius_mm**2 + shape.pad_mm**2) / (2.0 * shape.pad_mm)
    return ball_mm, shape.height_mm + shape.pad_mm - ball_mm


def _rim_mm(shape: PawShape, outline: Outline) -> float:
    """Rim radius of a core: the body's, as far as its bends allow."""
    return min(shape.rim_mm, CORE_RIM_SHARE * outline.bend_mm)


def _prism(shape: PawShape, inset_mm: float, *, what: str) -> Any:
    outline = Outline(shape, inset_mm)
    return rounded_prism(
        outline.edges(),
        area_mm2=outline.area_mm2,
        perimeter_mm=outline.perimeter_mm,
        top_mm=shape.height_mm - inset_mm,
        rim_mm=_rim_mm(shape, outline) if inset_mm else shape.rim_mm,
        what=what,
    )


def _prism_field(shape: PawShape, inset_mm: float) -> Field:
    outline = Outline(shape, inset_mm)
    rim_mm = _rim_mm(shape, outline) if inset_mm else shape.rim_mm
    top_mm = shape.height_mm - inset_mm

    def inside(points_mm: np.ndarray) -> np.ndarray:
        above = points_mm[:, 2] - top_mm
        return distance.rounded_both(outline.distance(points_mm), above, rim_mm)

    return inside


def _profile(shape: PawShape, radius_mm: float) -> tuple[Any, Any]:
    """Half a pad's section in the plane y = 0 as a wire, and its mirror image with it as a wire.

    The sphere goes on a little below the top, where it is still under the flat part of it.
    """
    from build123d import Edge, Wire

    ball_mm, centre_mm = _ball(shape, radius_mm)
    deep_mm = shape.height_mm - 0.4 * BETWEEN_MM * radius_mm / ball_mm
    across = math.sqrt(ball_mm**2 - (deep_mm - centre_mm) ** 2)
    apex = (0.0, 0.0, shape.height_mm + shape.pad_mm)
    corner, foot = (across, 0.0, deep_mm), (0.0, 0.0, deep_mm)
    slant = math.atan2(across, deep_mm - centre_mm) / 2
    middle = (ball_mm * math.sin(slant), 0.0, centre_mm + ball_mm * math.cos(slant))
    arc = Edge.make_three_point_arc(corner, middle, apex)
    half = Wire([Edge.make_line(foot, corner), arc, Edge.make_line(apex, foot)])
    whole_arc = Edge.make_three_point_arc(corner, apex, (-across, 0.0, deep_mm))
    whole = Wire([whole_arc, Edge.make_line((-across, 0.0, deep_mm), corner)])
    return half, whole


def _pads(shape: PawShape) -> list[Any]:
    """All five pads; the large one in three solids that touch."""
    from build123d import Axis, Face, Pos, Solid

    half, _ = _profile(shape, shape.toe_pad_mm)
    cap = Solid.revolve(Face(half), 360.0, Axis.Z)
    toes = [Pos(x, y, 0.0) * cap for x, y in shape.toe_places_mm.tolist()]
    return [*toes, *_large_pad(shape)]


def _expect_pads(outer: Any, shape: PawShape) -> None:
    """Each pad must have a face that rises above the top over the pad's middle.

    Raises:
        GeometryError: If one is missing.
    """
    boxes = [face.bounding_box(optimal=False) for face in outer.faces()]
    tops = [box for box in boxes if box.max.Z > shape.height_mm + shape.pad_mm - APEX_MM]
    places = [*shape.toe_places_mm.tolist(), shape.large_ends_mm.mean(axis=0).tolist()]
    for number, (x, y) in enumerate(places):
        found = any(
            box.min.X <= x + APEX_MM
            and x - APEX_MM <= box.max.X
            and box.min.Y <= y + APEX_MM
            and y - APEX_MM <= box.max.Y
            for box in tops
        )
        if not found:
            raise GeometryError(
                f"pad {number + 1} of {len(places)} is not there",
                hint="change shape.toe_pad_mm or shape.large_pad_mm a little",
                at="shape.toe_pad_mm",
            )


def _large_pad(shape: PawShape) -> list[Any]:
    """A cap drawn out along X: the segment between two half caps, and these."""
    from build123d import Axis, Face, Pos, Rot, Solid, Vector

    half, whole = _profile(shape, shape.large_pad_mm)
    (start, y), (stop, _) = shape.large_ends_mm.tolist()
    middle = Solid.extrude(Rot(0, 0, 90) * Face(whole), Vector(stop - start, 0, 0))
    end = Rot(0, 0, -90) * Solid.revolve(Face(half), 180.0, Axis.Z)
    return [
        Pos(start, y, 0) * middle,
        Pos(stop, y, 0) * end,
        Pos(start, y, 0) * (Rot(0, 0, 180) * end),
    ]


def _foot(shape: PawShape, layers: Layers) -> Any:
    radius_mm = Outline(shape, 0.0).greatest_mm
    cavity_mm = shape.radius_mm - layers.elastomer_mm - layers.support_mm
    half = radius_mm, radius_mm
    return elliptic_foot(half, cavity_mm, shape.base_height_mm, shape.base_lip_mm)


FAMILY = Paw()
