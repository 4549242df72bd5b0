"""A nail let into the back of a digit: all that lies behind y = Y(x, z) is taken away.

    Y = min(y0 + rise (z - z0) + arch min(1, (2 x / width)^2) - flank max(0, |x| - width / 2),
            y0 - flank (z0 - z))

is a field that arches across and goes up along a straight line, with flanks that fall off beside it
and below its lower end z0. The line begins a depth before the back, or more where a back that is
hollow along its height would come through, and runs out of it above: that end is open.

    volume = integral of max(0, Y - back) over x and z,   back the digit's own y there.

Leaves out: fillets where field, flanks and skin meet.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np

from designs.digit import Digit
from workbench.core.base.booleans import cut, expect_volume, intersect
from workbench.core.base.errors import DesignError, GeometryError

ARCH = 0.95
"""How far the field's middle lies behind its sides, over the depth: SimTac mesh."""
FLANK = 0.85
"""Slope of the flanks, y over x and z: SimTac mesh."""
ENDS = 0.72
"""Height above the root of the tip where the field runs out at the latest, over the tip's: SimTac
mesh."""
FEW, MANY = (24, 48), (300, 600)
"""Cells across and along, to look at the nail and to integrate it: the latter good to 2e-4."""
PLACES = 41
"""Places along the middle where the back is looked at."""
LIMIT = 0.01
"""Tolerance of the nail's volume: the kernel integrates trimmed faces to some 1e-3 of it."""
WALL_SHARE = 0.4
"""Least wall under the nail over the elastomer wall."""
WIDE_SHARE = 0.5
"""Share of the corners that the field leaves out on either side."""
LOWEST_MM = 2.0
"""Lowest end of the lower flank [mm]."""
BEYOND_MM = 30.0
"""How far the tool reaches behind the body."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Nail:
    """The nail of a digit."""

    digit: Digit
    low_mm: float
    """Height of the field's lower end."""
    width_mm: float
    depth_mm: float
    """How far the middle of the lower end lies before the back, at least."""

    @property
    def line(self) -> tuple[float, float]:
        """y0 [mm] and rise of the field's middle."""
        end = self.digit.length_mm + ENDS * self.digit.tip_mm - self.low_mm
        share = np.linspace(0.0, 1.0, PLACES)
        back = self.digit.back_mm(0.0 * share, self.low_mm + end * share)
        (low, high), over, away = back[[0, -1]].tolist(), back[1:-1], share[1:-1]
        hollow = (over - low - (high - low) * away) / (1.0 - away)
        depth = self.depth_mm + max(0.0, float(hollow.max()))
        # Nowhere deeper than at its lower end: a rounded back lets it run out below the end.
        rise = min(high - low - depth, float(((over - low) / away).min()))
        return low + depth, rise / end

    @property
    def arch_mm(self) -> float:
        """How far the field's middle lies behind its sides."""
        return ARCH * self.depth_mm

    def before_mm(self, x_mm: np.ndarray, z_mm: np.ndarray) -> np.ndarray:
        """Y over x and z [mm]."""
        start, rise = self.line
        half, beside = self.width_mm / 2, np.abs(x_mm)
        arch = self.arch_mm * np.minimum(beside / half, 1.0) ** 2
        field = start + rise * (z_mm - self.low_mm) + arch - FLANK * np.maximum(beside - half, 0.0)
        return np.minimum(field, start - FLANK * (self.low_mm - z_mm))

    @property
    def foot_mm(self) -> float:
        """Height at which the lower flank comes out of the back, at least."""
        return self.low_mm - (self.depth_mm + self.arch_mm) / FLANK

    def places_mm(self, cells: tuple[int, int] = FEW) -> tuple[np.ndarray, float]:
        """Places on the nail in even cells [mm], shape (N, 3), and the volume behind them [mm3]."""
        sides, count = self.digit.half_mm[0], cells[0]
        x = sides * (2.0 * np.arange(count) + 1.0 - count) / count
        low, high = max(self.foot_mm - FLANK, 0.0), self.digit.top_mm
        z = low + (high - low) * (np.arange(cells[1]) + 0.5) / cells[1]
        x, z = (grid.ravel() for grid in np.meshgrid(x, z, indexing="ij"))
        before = self.before_mm(x, z)
        depth = before - self.digit.back_mm(x, z)
        sunk = depth > 0.0
        cell = 2.0 * sides / count * (high - low) / cells[1]
        return np.column_stack([x, before, z])[sunk], cell * float(depth[sunk].sum())

    def wall_mm(self, core: Digit) -> float:
        """Thinnest wall between the nail and a core [mm], by the core's field."""
        return float(core.distance(self.places_mm()[0]).min())

    @property
    def volume_mm3(self) -> float:
        """Quadrature of the module docstring [mm3]."""
        return self.places_mm(MANY)[1]

    def distance(self, points_mm: np.ndarray) -> np.ndarray:
        """Signed distance to what is taken away [mm], first order: negative behind Y."""
        start, rise = self.line
        x, y, z = np.abs(points_mm[:, 0]), points_mm[:, 1], points_mm[:, 2]
        half = self.width_mm / 2
        arch = self.arch_mm * np.minimum(x / half, 1.0) ** 2
        bend = np.where(x < half, 2.0 * self.arch_mm * x / half**2, -FLANK)
        field = start + rise * (z - self.low_mm) + arch - FLANK * np.maximum(x - half, 0.0)
        across = (y - field) / np.sqrt(1.0 + rise**2 + bend**2)
        below = (y - start + FLANK * (self.low_mm - z)) / np.hypot(1.0, FLANK)
        return np.maximum(across, below)


def check_nail(nail: Nail, core: Digit, elastomer_mm: float) -> None:
    """Refuse nails that are wider than the back, come out of it, or cut through the wall.

    Raises:
        DesignError: Naming the field, its value and its limit.
    """
    widest_mm = 2.0 * (nail.digit.half_mm[0] - WIDE_SHARE * nail.digit.corner_mm[0])
    if nail.width_mm > widest_mm:
        raise DesignError(
            f"a nail {nail.width_mm:g} mm wide reaches around the corners: at most "
            f"{widest_mm:.3g} mm",
            hint="lower shape.nail_width_mm or shape.corner_mm, or raise shape.width_mm",
            at="shape.nail_width_mm",
        )
    if nail.foot_mm < LOWEST_MM:
        raise DesignError(
            f"the nail's lower flank ends {nail.foot_mm:.2g} mm over the base, less than "
            f"{LOWEST_MM:g} mm",
            hint="lower shape.nail_mm or raise shape.length_mm",
            at="shape.nail_mm",
        )
    wall_mm, limit_mm = nail.wall_mm(core), WALL_SHARE * elastomer_mm
    if wall_mm < limit_mm:
        raise DesignError(
            f"the nail leaves {wall_mm:.2g} mm of wall, less than {limit_mm:.2g} mm, "
            f"{WALL_SHARE:g} times the elastomer wall",
            hint="lower shape.nail_ratio or shape.nail_width_mm, or raise layers.elastomer_mm",
            at="shape.nail_ratio",
        )


def without_nail(body: Any, nail: Nail) -> Any:
    """A digit's body less the nail, checked by its volume.

    Raises:
        GeometryError: If the kernel took away something else.
    """
    found = cut(body, _tool(nail), what="nail")
    taken_mm3, wanted_mm3 = body.volume - found.volume, nail.volume_mm3
    if abs(taken_mm3 - wanted_mm3) > LIMIT * wanted_mm3:
        raise GeometryError(
            f"the nail takes {taken_mm3:.4g} mm3 instead of {wanted_mm3:.4g} mm3",
            hint="change shape.nail_ratio or shape.nail_mm a little",
            at="shape.nail_ratio",
        )
    return expect_volume(found, body.volume - wanted_mm3, what="nail", relative=1e-3)


def _tool(nail: Nail) -> Any:
    """What lies behind Y: the field and its flanks drawn along the rise, less what is below."""
    from build123d import Edge, Face, Solid, Vector, Wire

    (start, rise), half = nail.line, nail.width_mm / 2
    side = nail.digit.half_mm[0] + 1.0
    low, high = nail.low_mm - BEYOND_MM, nail.digit.top_mm + 1.0
    middle = start + rise * (low - nail.low_mm)
    edge = middle + nail.arch_mm
    end, back = edge - FLANK * (side - half), start - nail.digit.half_mm[1] - BEYOND_MM
    # A parabola through the field's ends has its control point as far beyond its middle.
    arch = Edge.make_bezier((half, edge, low), (0.0, 2 * middle - edge, low), (-half, edge, low))
    spots = [(-half, edge), (-side, end), (-side, back), (side, back), (side, end), (half, edge)]
    lines = [
        Edge.make_line((*here, low), (*there, low)) for here, there in itertools.pairwise(spots)
    ]
    along = Vector(0.0, rise * (high - low), high - low)
    whole = Solid.extrude(Face(Wire([arch, *lines])), along)
    # Above the plane through the lower end, y = y0 - flank (z0 - z).
    foot, top = start - FLANK * (nail.low_mm - low), start + FLANK * (high - nail.low_mm)
    reach = min(back, foot) - 1.0
    corners = [(foot, low), (top, high), (reach, high), (reach, low)]
    outline = Wire.make_polygon([(-side - 1.0, y, z) for y, z in corners])
    upper = Solid.extrude(Face(outline), Vector(2 * side + 2.0, 0, 0))
    return intersect(whole, upper, what="nail")
