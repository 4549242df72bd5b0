"""The LEDs of a ring one by one: where each sits, its colour and its share of the power.

A ring is coloured in sectors; one LED of another colour makes every LED a sector of its own.
Factors on the power are kept only while one differs from 1.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from workbench.core.design.leds import colour_sectors, led_places
from workbench.core.design.lighting import LedRing


@dataclass(frozen=True, kw_only=True, slots=True)
class Led:
    """One LED of a ring."""

    number: int
    """From 1, in the order of azimuth."""
    place_mm: tuple[float, float, float]
    colour: str
    """As the design writes it."""
    factor: float
    """On the ring's power [1]."""


def leds_of(ring: LedRing) -> tuple[Led, ...]:
    """All LEDs of a ring."""
    places, _ = led_places(ring)
    sectors, factors = colour_sectors(ring), factors_of(ring)
    return tuple(
        Led(
            number=k + 1,
            place_mm=(float(place[0]), float(place[1]), float(place[2])),
            colour=ring.colours[sectors[k]],
            factor=factors[k],
        )
        for k, place in enumerate(places)
    )


def factors_of(ring: LedRing) -> tuple[float, ...]:
    """The factor on each LED's power."""
    return ring.powers or (1.0,) * ring.count


def with_factor(ring: LedRing, number: int, factor: float) -> LedRing:
    """The ring with another factor on the power of one LED, counted from 1.

    Raises:
        DesignError: If the factor is refused.
    """
    factors = list(factors_of(ring))
    factors[number - 1] = factor
    return dataclasses.replace(ring, powers=_kept(factors))


def with_colour(ring: LedRing, number: int, colour: str) -> LedRing:
    """The ring with another colour of one LED, counted from 1.

    Raises:
        DesignError: If it is no colour.
    """
    colours = [led.colour for led in leds_of(ring)]
    if colours[number - 1] == colour:
        return ring
    colours[number - 1] = colour
    return dataclasses.replace(ring, colours=tuple(colours))


def with_count(ring: LedRing, count: int) -> LedRing:
    """The ring with more or fewer LEDs; those that stay keep their factors, new ones have 1.

    Raises:
        DesignError: If the count is refused.
    """
    if not ring.powers:
        return dataclasses.replace(ring, count=count)
    # A count that the ring refuses must be told as such, not as a wrong number of factors.
    dataclasses.replace(ring, count=count, powers=())
    factors = [*ring.powers[:count], *(1.0 for _ in range(count - ring.count))]
    return dataclasses.replace(ring, count=count, powers=_kept(factors))


def _kept(factors: list[float]) -> tuple[float, ...]:
    return tuple(factors) if any(factor != 1.0 for factor in factors) else ()
