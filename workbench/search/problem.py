"""A search as the designer states it: what may vary, what is wanted, what must hold."""

from __future__ import annotations

import enum
from dataclasses import dataclass

from workbench.project.prices import Prices
from workbench.project.state import State

Value = float | int | str
"""Of a varied field: a number, or a choice as it is typed (`workbench.edit.typed_fields`)."""
DRAFT = (
    "design.optics.baking.photons=400000",
    "design.optics.baking.nodes=2000",
    "case.settings.grid_mm=0.75",
)
"""Settings of trials where the file names none, our choice: a tenth of the photons, less than half
of the places where light is gathered, a coarser grid of contact."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Vary:
    """A field and the values that it may take: a range, or choices."""

    path: str
    """Dotted, from `design` or `case`."""
    title: str
    """Label with unit, for people."""
    low: float = 0.0
    high: float = 0.0
    """Both ends are included; in the field's own unit."""
    choices: tuple[str, ...] = ()
    """As they are typed; () of a range."""
    whole: bool = False
    """Whether only whole numbers mean anything."""
    log: bool = False
    """Whether equal factors, not equal steps, are equally likely."""

    @property
    def span(self) -> str:
        """What it may be, in words."""
        return ", ".join(self.choices) or f"{self.low:g} to {self.high:g}"

    def rounded(self, value: float) -> float:
        """A number of the range as a design file holds it: to six digits, never beyond an end."""
        return min(max(float(f"{value:.6g}"), self.low), self.high)


@dataclass(frozen=True, kw_only=True, slots=True)
class Link:
    """A field that follows another one: value = `factor` x the other + `offset`."""

    path: str
    follows: str
    factor: float = 1.0
    offset: float = 0.0
    """In the field's own unit."""


class Want(enum.StrEnum):
    """Which way a goal goes."""

    MAX = "max"
    MIN = "min"
    TARGET = "target"
    """As near to a value as can be."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Goal:
    """A figure that is to be as large, as small, or as near to a value as can be."""

    figure: str
    want: Want
    value: float = 0.0
    """Of a target, in the figure's own unit."""

    def loss(self, found: float) -> float:
        """What is minimised: the figure, its negative, or its distance to the target."""
        if self.want is Want.TARGET:
            return abs(found - self.value)
        return -found if self.want is Want.MAX else found


@dataclass(frozen=True, kw_only=True, slots=True)
class Limit:
    """Values of a figure that are allowed; None is no end."""

    figure: str
    at_least: float | None = None
    at_most: float | None = None

    def excess(self, found: float) -> float:
        """How far a figure is beyond, over the size of the limit; at most 0 is allowed [1].

        The size is that of the limit itself, or 1 for a limit of 0.
        """
        beyond = [
            sign * (found - end) / (abs(end) or 1.0)
            for sign, end in ((-1.0, self.at_least), (1.0, self.at_most))
            if end is not None
        ]
        return max(beyond, default=-1.0)

    @property
    def words(self) -> str:
        """The limit for people, without its unit."""
        ends = (("at least", self.at_least), ("at most", self.at_most))
        return " and ".join(f"{name} {end:g}" for name, end in ends if end is not None)


@dataclass(frozen=True, kw_only=True, slots=True)
class Tolerances:
    """What a workshop is off by, drawn evenly between minus and plus; 0 twins test nothing.

    Defaults are the amounts of `workbench.twin` and `workbench.learning.dataset.variation`.
    """

    twins: int = 0
    led_mm: float = 0.3
    wall_mm: float = 0.15
    young_percent: float = 20.0


@dataclass(frozen=True, kw_only=True, slots=True)
class Problem:
    """A search."""

    base: State
    vary: tuple[Vary, ...]
    goals: tuple[Goal, ...]
    limits: tuple[Limit, ...] = ()
    links: tuple[Link, ...] = ()
    draft: tuple[str, ...] = DRAFT
    """Settings of trials as `FIELD=VALUE`; the confirmed front has the base's own."""
    even_light: bool = False
    """Whether LED powers are solved for even light in each trial, see `even_light`."""
    per_press: int = 3
    """Trials that share a shape and a material, where a press is needed and only they press."""
    finalists: int = 4
    """Designs of the front that are confirmed."""
    photons: bool = False
    """Whether images of finalists are also made by photons traced for each frame."""
    tolerances: Tolerances = Tolerances()
    prices: Prices | None = None
    seed: int = 1
    trials: int = 60
