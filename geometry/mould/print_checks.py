"""What every printed part is checked by: a measure against its limit, its walls, its room."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from geometry.mould.castability import Worst, bed_ratio
from workbench.core.result.fabrication import FabricationCheck, FabricationPart, Severity

LEAST_PRINT_MM = 0.4
"""Walls thinner than one line of the usual nozzle are not there once printed [mm]."""
DECIMALS = 4
"""Of a measure: the rest is rounding."""
ROUNDING = 1e-6
"""A value that misses its limit by less meets it."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Bound:
    """How far a measure may go."""

    limit: float
    """Beyond it a check is a warning, in `unit`."""
    unit: str
    sense: str = "max"
    """`max`: at most the limit is good; `min`: at least."""
    bad: float | None = None
    """Beyond it a check is bad, in `unit`; None: it never is."""


def check(
    name: str,
    part: str,
    worst: Worst,
    bound: Bound,
    *,
    message: str,
    title: str = "",
) -> FabricationCheck:
    """A check: a measure of a part against its bound.

    Args:
        title: What is measured, in words; made of the name when empty.
        message: What to do about it, added when it is not good.
    """
    limit, sense, bad, unit = bound.limit, bound.sense, bound.bad, bound.unit
    sign = 1.0 if sense == "max" else -1.0
    over = sign * (worst.value - limit) > ROUNDING
    severity = Severity.WARNING if over else Severity.GOOD
    if over and bad is not None and sign * worst.value > sign * bad:
        severity = Severity.BAD
    side = "at most" if sense == "max" else "at least"
    title = title or name.replace("_", " ")
    value = legible(worst.value)
    text = f"{part}: {title} {value} {unit}, {side} {limit:.3g} {unit} is good"
    if tolerated(worst.value, limit, sense=sense) and not over:
        text = f"{part}: {title} {value} {unit} is within tolerance, {limit:.3g} {unit}"
    return FabricationCheck(
        name=name,
        part=part,
        value=worst.value,
        unit=unit,
        limit=limit,
        sense=sense,
        severity=severity,
        place_mm=worst.place_mm,
        message=f"{text}; {message}." if over else f"{text}.",
    )


def legible(value: float) -> str:
    """Three digits of a measure; what is only rounding of the computer is 0."""
    return f"{round(value, DECIMALS) + 0.0:.3g}"


def tolerated(value: float, limit: float, *, sense: str) -> bool:
    """Whether a measure that should not be negative is, and its limit lets it."""
    return sense == "min" and limit < 0.0 and round(value, DECIMALS) < 0.0


class PrintLimits(NamedTuple):
    """What a printed part must keep, and what to do where it does not."""

    wall_mm: float
    thin: str
    """Remedy for a wall that is too thin."""
    large: str
    """Remedy for a part that is too large for the printer."""


def wall_check(
    name: str, wall: Worst, limits: PrintLimits, feature_mm: float | None
) -> FabricationCheck:
    """Thinnest wall of a part: bad where the printer leaves nothing of it.

    Args:
        feature_mm: Smallest feature that the printer does; None if the place is an edge, which it
            rounds.
    """
    return check(
        "minimum_wall",
        name,
        wall,
        Bound(
            limit=limits.wall_mm,
            unit="mm",
            sense="min",
            bad=None if feature_mm is None else max(LEAST_PRINT_MM, feature_mm),
        ),
        message=limits.thin,
    )


def bed_check(
    part: FabricationPart, bed_mm: tuple[float, float, float], limits: PrintLimits
) -> FabricationCheck:
    """Room on the printer for one part."""
    x, y, z = (part.points_mm.min(axis=0) + part.points_mm.max(axis=0)) / 2
    return check(
        "bed",
        part.name,
        Worst(100.0 * bed_ratio(part.points_mm, bed_mm), (float(x), float(y), float(z))),
        Bound(limit=100.0, unit="%", bad=100.0),
        title="share of the bed",
        message=limits.large,
    )
