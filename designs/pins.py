"""Pins on the inner face of a loaf of skin: upright cylinders in a regular grid, with flat tips.

Tips follow the dome, and corners of the grid that would stand near its rim are left out. A pin is
too small to be missed by the volume of the skin, so each is looked for by the disc of its tip.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from designs.loaf import Loaf
from workbench.core.base.errors import DesignError, GeometryError
from workbench.core.result.marks import Field, Region
from workbench.core.result.results import Label

BETWEEN_MM = 0.6
"""Smallest gap between neighbouring pins, and from a pin to the side of the loaf [mm]."""
CLEAR_MM = 0.1
"""Least distance from a tip's rim to the window, and least length of a pin on its short side
[mm]: the dome falls under a pin, so both are less there than on the pin's axis."""
REACH_SHARE = 0.65
"""How far out the outermost pins stand, over the half width of the dome."""
DOME_SHARE = 0.8
"""Farthest a pin's rim stands out on the dome, over the outline: it falls steeply beyond."""
RIM_PLACES = 32
"""Places on a tip's rim that are looked at; the farthest out is off by at most 0.5 % of r."""

Tip = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True, slots=True)
class Pins:
    """A grid of pins."""

    inside: Loaf
    """The skin's inner face, from which they stand down."""
    rows: int
    """Pins across, before corners are left out."""
    columns: int
    """Pins along."""
    radius_mm: float
    length_mm: float
    """From the inner face to the tip, on a pin's axis."""
    root_mm: float
    """How far a pin reaches into the skin."""

    @property
    def spans_mm(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Places of the outermost pin axes along X and along Y [mm]."""
        inside = self.inside
        across = REACH_SHARE * inside.half_mm
        low, high = inside.straight_mm
        back, front = (REACH_SHARE * end for end in inside.ends_mm)
        return (-across, across), (low - back, high + front)

    @property
    def tips_mm(self) -> list[Tip]:
        """Axis (x, y) and height of the tip of each pin [mm], row by row."""
        span_x, span_y = self.spans_mm
        places = []
        for x in _spread(self.rows, span_x):
            for y in _spread(self.columns, span_y):
                axis = np.array([x, y, 0.0])
                roof_mm = float(self.inside.roof_mm(axis[None])[0])
                # A pin nearer the dome's rim would leave it sideways.
                if self.inside.share(axis + self.radius_mm * _circle()).max() <= DOME_SHARE:
                    places.append((float(x), float(y), roof_mm - self.length_mm))
        return places


def _circle() -> np.ndarray:
    """Places around a unit circle in the plane z = 0, shape (RIM_PLACES, 3)."""
    turn = np.linspace(0.0, 2 * np.pi, RIM_PLACES, endpoint=False)
    return np.column_stack([np.cos(turn), np.sin(turn), np.zeros(RIM_PLACES)])


def _spread(count: int, span_mm: tuple[float, float]) -> np.ndarray:
    return np.linspace(*span_mm, count) if count > 1 else np.array([sum(span_mm) / 2])


def check_pins(pins: Pins, window: Loaf) -> None:
    """Refuse pins that touch, stand in the window or stay in the skin, and skins without any.

    Raises:
        DesignError: Naming the field, its value and its limit.
    """
    counts = (("pin_rows", pins.rows), ("pin_columns", pins.columns))
    for (name, count), (low, high) in zip(counts, pins.spans_mm, strict=True):
        pitch_mm = (high - low) / (count - 1) if count > 1 else math.inf
        least_mm = 2 * pins.radius_mm + BETWEEN_MM
        if pitch_mm < least_mm:
            raise DesignError(
                f"{count:g} {name.replace('_', ' ')} stand {max(pitch_mm, 0.0):.2g} mm apart, less "
                f"than the {least_mm:g} mm that pins of radius {pins.radius_mm:g} mm need",
                hint=f"lower shape.{name} or shape.pin_radius_mm, or raise the size of the skin",
                at=f"shape.{name}",
            )
    tips = np.array(pins.tips_mm)
    if not len(tips):
        raise DesignError(
            f"none of {pins.rows:g} x {pins.columns:g} pins stands within "
            f"{DOME_SHARE:.0%} of the dome, at least 1 must: all are corners",
            hint="choose 1 or 3 and more for shape.pin_rows or shape.pin_columns",
            at="shape.pin_rows",
        )
    _check_rims((tips[:, None] + pins.radius_mm * _circle()).reshape(-1, 3), pins, window)


def _check_rims(rims_mm: np.ndarray, pins: Pins, window: Loaf) -> None:
    inside = pins.inside
    # Beyond the inner face's outline there is skin only.
    out_mm = np.where(inside.share(rims_mm) < 1.0, inside.roof_mm(rims_mm) - rims_mm[:, 2], 0.0)
    if out_mm.min() < CLEAR_MM:
        raise DesignError(
            f"a pin of {pins.length_mm:g} mm stands {out_mm.min():.2f} mm out of the skin on "
            f"its short side, less than {CLEAR_MM:g} mm",
            hint="raise shape.pin_length_mm, or lower shape.pin_radius_mm or shape.dome_mm",
            at="shape.pin_length_mm",
        )
    clear_mm = window.distance(rims_mm).min()
    if clear_mm < CLEAR_MM:
        raise DesignError(
            f"a pin's tip stands {clear_mm:.2f} mm from the window on its long side, less than "
            f"{CLEAR_MM:g} mm (negative: inside it)",
            hint="raise shape.pin_gap_mm, or lower shape.pin_radius_mm or shape.pin_length_mm",
            at="shape.pin_gap_mm",
        )


def pin_bodies(pins: Pins) -> Any:
    """Every pin, each from its tip into the skin above its axis."""
    from build123d import Compound, Plane, Solid

    length_mm = pins.length_mm + pins.root_mm
    return Compound(
        [Solid.make_cylinder(pins.radius_mm, length_mm, Plane(origin=tip)) for tip in pins.tips_mm]
    )


def pin_field(pins: Pins) -> Field:
    """Signed distance to the nearest pin, long enough to reach through the skin."""
    tips = np.array(pins.tips_mm)

    def distance(points_mm: np.ndarray) -> np.ndarray:
        from scipy.spatial import KDTree

        beside, nearest = KDTree(tips[:, :2]).query(points_mm[:, :2])
        return np.maximum(beside - pins.radius_mm, tips[nearest, 2] - points_mm[:, 2])

    return distance


def expect_pins(membrane: Any, core: Any, pins: Pins) -> None:
    """Each pin must have its tip: a plane face of its own at its height, in skin and core.

    Raises:
        GeometryError: If one is missing.
    """
    disc = math.pi * pins.radius_mm**2
    wanted = pins.tips_mm
    for body, what in ((membrane, "skin"), (core, "core")):
        found = [
            face.center()
            for face in body.faces()
            if abs(face.area - disc) < 1e-6 and abs(abs(face.normal_at().Z) - 1.0) < 1e-9
        ]
        met = sum(any(math.dist((c.X, c.Y, c.Z), place) < 1e-4 for c in found) for place in wanted)
        if met != len(wanted):
            raise GeometryError(
                f"{what}: {met} of {len(wanted)} pins are there",
                hint="change the last shape parameter a little",
                at="shape",
            )


def pin_regions(pins: Pins) -> list[Region]:
    """The faces of each pin on the inner side, in the order of the tips."""
    return [
        Region(label=Label.PIN, number=number, within=Label.INNER, inside=_on_pin(pins, tip))
        for number, tip in enumerate(pins.tips_mm)
    ]


def _on_pin(pins: Pins, tip: Tip) -> Callable[..., np.ndarray]:
    """Positive on the pin's side and tip: within its radius, where the roof has no face."""
    radius_mm, axis = pins.radius_mm * 1.005 + 1e-4, np.array(tip[:2])

    def inside(points_mm: np.ndarray) -> np.ndarray:
        return radius_mm - np.linalg.norm(points_mm[:, :2] - axis, axis=1)

    return inside
