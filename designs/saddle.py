"""A saddle between two lobes: an elliptic prism hollowed from above by a round bar along X.

In the plane x = 0 the top is an arc of radius R about (0, valley + R), then the rounded rim of
radius r about (p, valley + lobe - r), p = half_y - r, which runs into the upright side. Both
touch, so the height of the lobes gives the radius of the saddle:

    (R + r)^2 = p^2 + (R + r - lobe)^2,   R = (p^2 + lobe^2) / (2 lobe) - r.

The rim follows the ellipse: its centre line is where the ellipse moved inward by r meets the
cylinder of radius R + r about the saddle's axis. Where the rim touches the saddle, at
y_t = p R / (R + r), the roof ends; for the kernel's sharp edge it goes on with the same slope.
Without the rounding the volume is a quadrature over the ellipse, and the rim takes a wedge of known
angle off every bit of the edge, so a cut or a fillet that went wrong shows in the volume.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from designs import distance
from designs.prisms import ellipse_edges, prism
from workbench.core.base.booleans import cut, expect_volume, fillet
from workbench.core.base.errors import DesignError
from workbench.core.result.marks import Field, Region
from workbench.core.result.results import Label

ROOF_POINTS = 41
"""Points through which the roof is drawn: good to 1e-5 of the volume."""
PIECES = 2
"""Pieces of the outline under the roof: with one the kernel's volume is off by 2e-3, with two by
4e-4."""
EDGE_PLACES = 2000
"""Places on the edge at which its angle is taken."""
RIM_SLACK = 0.25
"""Share by which a fillet may miss the wedges that it takes: they leave the bends of side and
saddle out, which is 0.15 at most here."""
TOP_SHARE = 0.5
"""Height over the saddle at which the driven top of a protrusion begins, over its height."""
SIDES = (1.0, -1.0)
"""Protrusions: at +Y and at -Y."""
FLATTEST = 0.55
"""Least cosine of the steepest slope of the roof: the kernel rounds few sharper edges."""
BEND_SHARE = 0.45
"""Largest rim over the narrowest bend of the outline."""
RIM_STEPS = 4
"""Newton steps to the rim's centre line: from 2 r away they leave 1e-6 mm."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Saddle:
    """Measures of a saddle that stands on z = 0 with a lobe at either end of Y."""

    half_mm: tuple[float, float]
    """Half axes of the ellipse along X and Y [mm]."""
    valley_mm: float
    """Height of the saddle [mm]."""
    lobe_mm: float
    """Height of the lobes above the saddle [mm]."""
    rim_mm: float
    """Radius of the rounded top rim [mm]."""

    @property
    def peak_mm(self) -> float:
        """Distance of the lobes' highest points from the plane between them [mm]."""
        return self.half_mm[1] - self.rim_mm

    @property
    def arc_mm(self) -> float:
        """Radius of the saddle [mm]: R of the module docstring."""
        square = self.peak_mm**2 + self.lobe_mm**2
        return square / (2.0 * self.lobe_mm) - self.rim_mm

    @property
    def flank_cosine(self) -> float:
        """Cosine of the steepest slope of the roof, where the rim touches it."""
        peak, lobe = self.peak_mm**2, self.lobe_mm**2
        return (peak - lobe) / (peak + lobe)

    @property
    def flank_mm(self) -> float:
        """Distance from the plane between the lobes at which the rim touches the roof [mm]."""
        return self.peak_mm * self.arc_mm / (self.arc_mm + self.rim_mm)

    def roof_mm(self, y_mm: np.ndarray) -> np.ndarray:
        """Height of the roof over y [mm]; beyond the flank straight on."""
        arc, flank = self.arc_mm, self.flank_mm
        near = np.minimum(np.abs(y_mm), flank)
        beyond = np.maximum(np.abs(y_mm) - flank, 0.0)
        curved = self.valley_mm + arc - np.sqrt(arc**2 - near**2)
        return curved + beyond * flank / np.sqrt(arc**2 - flank**2)

    def roof_slope(self, y_mm: np.ndarray) -> np.ndarray:
        """Slope dz/dy of the roof."""
        near = np.clip(y_mm, -self.flank_mm, self.flank_mm)
        return near / np.sqrt(self.arc_mm**2 - near**2)

    @property
    def sharp_mm3(self) -> float:
        """Volume before the rim is rounded [mm3]: the roof over the ellipse.

        Gauss quadrature of z(y) 2 a sqrt(1 - y^2 / b^2) over y = b sin t, in pieces that end at
        the flank: the roof is smooth in each.
        """
        half_x, half_y = self.half_mm
        node, weight = np.polynomial.legendre.leggauss(60)
        total, flank = 0.0, float(np.arcsin(self.flank_mm / half_y))
        for low, high in ((0.0, flank), (flank, np.pi / 2)):
            turn = (low + high) / 2 + (high - low) / 2 * node
            strip = self.roof_mm(half_y * np.sin(turn)) * 2 * half_x * np.cos(turn)
            total += float(weight @ (strip * half_y * np.cos(turn))) * (high - low) / 2
        return 2.0 * total

    @property
    def rim_mm3(self) -> float:
        """What rounding takes off straight wedges of the edge's angles and length [mm3].

        A wedge of angle a loses r^2 (cot(a / 2) - (pi - a) / 2) over its length.
        """
        turn = np.linspace(0.0, 2.0 * np.pi, EDGE_PLACES + 1)
        half_x, half_y = self.half_mm
        edge = np.column_stack([half_x * np.cos(turn), half_y * np.sin(turn)])
        edge = np.column_stack([edge, self.roof_mm(edge[:, 1])])
        length = np.linalg.norm(np.diff(edge, axis=0), axis=1)
        middle = (edge[1:] + edge[:-1]) / 2
        slope = self.roof_slope(middle[:, 1])
        cosine = -_outward(middle, self.half_mm)[:, 1] * slope / np.hypot(1.0, slope)
        angle = np.pi - np.arccos(cosine)
        lost = 1.0 / np.tan(angle / 2) - (np.pi - angle) / 2
        return float(self.rim_mm**2 * lost @ length)


def check_saddle(saddle: Saddle) -> None:
    """Refuse rims and saddles that the top has no room for.

    Raises:
        DesignError: If the rim bends sharper than the outline allows, or the saddle is steeper
            than its rim can be rounded.
    """
    bend_mm = min(saddle.half_mm) ** 2 / max(saddle.half_mm)
    if saddle.rim_mm > BEND_SHARE * bend_mm:
        raise DesignError(
            f"the rim of radius {saddle.rim_mm:g} mm is more than {BEND_SHARE * bend_mm:.2f} mm, "
            f"{BEND_SHARE:g} of the outline's narrowest bend of {bend_mm:.2f} mm",
            hint="lower shape.rim_mm, or bring shape.width_mm and shape.depth_mm nearer each other",
            at="shape.rim_mm",
        )
    if saddle.flank_cosine < FLATTEST:
        most_mm = saddle.peak_mm * math.sqrt((1.0 - FLATTEST) / (1.0 + FLATTEST))
        raise DesignError(
            f"lobes of {saddle.lobe_mm:g} mm make the saddle too steep; {most_mm:.2f} mm is the "
            f"most for crests {saddle.peak_mm:g} mm from its middle",
            hint="lower shape.lobe_mm or shape.rim_mm, or raise shape.depth_mm",
            at="shape.lobe_mm",
        )


def driven_surfaces(saddle: Saddle, *, reach_mm: float, root_mm: float) -> tuple[Region, ...]:
    """Tops of the protrusions at +Y and -Y as actuators 0 and 1, their backs below as 2 and 3.

    A top is the upper half of a lobe with its rim, a back what looks away from the object between
    that and the height of the root, twice the reach wide.
    """
    level_mm = saddle.valley_mm + TOP_SHARE * saddle.lobe_mm

    def over(points_mm: np.ndarray) -> np.ndarray:
        return points_mm[:, 2] - level_mm

    def above(points_mm: np.ndarray) -> np.ndarray:
        return points_mm[:, 2] - root_mm

    def beside(points_mm: np.ndarray) -> np.ndarray:
        return reach_mm - np.abs(points_mm[:, 0])

    def top(sign: float) -> Field:
        return lambda points_mm: np.minimum(sign * points_mm[:, 1], over(points_mm))

    def back(sign: float) -> Field:
        def inside(points_mm: np.ndarray) -> np.ndarray:
            outward = distance.ellipse(points_mm, *saddle.half_mm) + saddle.rim_mm
            band = [-over(points_mm), above(points_mm), beside(points_mm)]
            return np.min([sign * points_mm[:, 1], outward, *band], axis=0)

        return inside

    surfaces = [(top(sign), (over,)) for sign in SIDES]
    surfaces += [(back(sign), (over, above, beside)) for sign in SIDES]
    return tuple(
        Region(
            label=Label.ACTUATOR,
            number=number,
            within=Label.OUTER,
            inside=inside,
            imprint=True,
            borders=borders,
        )
        for number, (inside, borders) in enumerate(surfaces)
    )


def saddle_body(saddle: Saddle) -> Any:
    """The elliptic prism cut by what is above the roof, its rim rounded.

    Raises:
        GeometryError: If its volume is not that of the quadrature, or the rim was not rounded.
    """
    from build123d import Edge, Face, Solid, Vector, Wire

    half_x, half_y = saddle.half_mm
    side, reach = -half_x - 2.0, half_y + 1.0
    y = np.linspace(-reach, reach, ROOF_POINTS)
    z = saddle.roof_mm(y)
    top_mm = float(z[0]) + 1.0
    slope = float(saddle.roof_slope(np.array([reach]))[0])
    roof = Edge.make_spline(
        [(side, *spot) for spot in zip(y.tolist(), z.tolist(), strict=True)],
        tangents=[(0.0, 1.0, -slope), (0.0, 1.0, slope)],
    )
    corners = [(side, reach, top_mm), (side, -reach, top_mm)]
    ends = [roof.position_at(1), *corners, roof.position_at(0)]
    lines = [Edge.make_line(a, b) for a, b in itertools.pairwise(ends)]
    above = Solid.extrude(Face(Wire([roof, *lines])), Vector(2 * half_x + 4.0, 0, 0))
    block = prism(ellipse_edges(half_x, half_y, pieces=PIECES), top_mm - 0.5)
    body = cut(block, above, what="saddle")
    # The kernel integrates faces with curved borders to some 4e-4 here; the saddle is 20 %.
    expect_volume(body, saddle.sharp_mm3, what="saddle", relative=1e-3)
    edges = [edge for edge in body.edges() if edge.bounding_box().min.Z > saddle.valley_mm / 2]
    limits = (1.0 - RIM_SLACK) * saddle.rim_mm3, (1.0 + RIM_SLACK) * saddle.rim_mm3
    return fillet(body, saddle.rim_mm, edges, what="top rim", removes_mm3=limits)


def saddle_field(saddle: Saddle) -> Field:
    """Signed distance to a saddle: to side and roof, and beyond both to the rim's centre line."""
    axis_mm, rim_mm = saddle.valley_mm + saddle.arc_mm, saddle.rim_mm

    def outer(points_mm: np.ndarray) -> np.ndarray:
        beside = distance.ellipse(points_mm, *saddle.half_mm)
        # Over the axis the roof goes on upright: it has long ended there.
        over = np.minimum(points_mm[:, 2] - axis_mm, 0.0)
        above = saddle.arc_mm - np.hypot(points_mm[:, 1], over)
        found = np.maximum(beside, above)
        near = (beside > -2.0 * rim_mm) & (above > -2.0 * rim_mm)
        places = points_mm[near]
        centre, beyond = places.copy(), np.zeros(len(places), bool)
        for step in range(RIM_STEPS):
            first, second = _to_centre_line(saddle, centre)
            if step == 0:
                beyond = (first[0] > 0.0) & (second[0] > 0.0)
            centre -= first[0][:, None] * first[1] + second[0][:, None] * second[1]
        round_mm = np.linalg.norm(places - centre, axis=1) - rim_mm
        found[near] = np.where(beyond, round_mm, found[near])
        return found

    return outer


Part = tuple[np.ndarray, np.ndarray]


def _to_centre_line(saddle: Saddle, points_mm: np.ndarray) -> tuple[Part, Part]:
    """Least way to side and roof moved inward by r: lengths along their normals, and these.

    With the distances u and v and the cosine c between the normals, the lengths a and b solve
    a + c b = u, c a + b = v.
    """
    outward = _outward(points_mm, saddle.half_mm)
    outward = np.column_stack([outward, np.zeros(len(points_mm))])
    arm = points_mm - [0.0, 0.0, saddle.valley_mm + saddle.arc_mm]
    arm[:, 0], arm[:, 2] = 0.0, np.minimum(arm[:, 2], -1e-9)
    length = np.linalg.norm(arm, axis=1)
    upward = -arm / length[:, None]
    u = distance.ellipse(points_mm, *saddle.half_mm) + saddle.rim_mm
    v = saddle.arc_mm - length + saddle.rim_mm
    cosine = (outward * upward).sum(axis=1)
    scale = 1.0 / np.maximum(1.0 - cosine**2, 1e-6)
    return (scale * (u - cosine * v), outward), (scale * (v - cosine * u), upward)


def _outward(points_mm: np.ndarray, half_mm: tuple[float, float]) -> np.ndarray:
    """Outward normal of the ellipse beside points, shape (N, 2)."""
    normal = points_mm[:, :2] / np.square(half_mm)
    return normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-9)
