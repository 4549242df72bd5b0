"""The few figures that a designer looks at first, each good, fair or poor by limits of their own.

What is good depends on what the sensor is for: the limits here are our choice to begin with, and a
project's `limits.toml` has its own (`workbench.project.limits`).
"""

from __future__ import annotations

import enum
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from workbench.view.frame_words import MISSING, number
from workbench.view.metric_rules import REMEDIES, Better, Rule, rule


class Standing(enum.StrEnum):
    """How a figure stands."""

    GOOD = "good"
    FAIR = "fair"
    POOR = "poor"
    PLAIN = "without a limit"
    OPEN = "not known yet"


@dataclass(frozen=True, kw_only=True, slots=True)
class Bounds:
    """Where a figure is good, and where it is poor; between them it is fair."""

    good: float
    poor: float

    def standing(self, value: float) -> Standing:
        """How a value stands; `good` below `poor` means that less is better."""
        sign = 1.0 if self.good >= self.poor else -1.0
        if sign * value >= sign * self.good:
            return Standing.GOOD
        return Standing.POOR if sign * value <= sign * self.poor else Standing.FAIR

    def words(self, unit: str) -> str:
        """The limits for people."""
        way = ("at least", "or less") if self.good >= self.poor else ("at most", "or more")
        unit = f" {unit}" if unit else ""
        good, poor = number(self.good), number(self.poor)
        return f"good is {way[0]} {good}{unit}, poor is {poor}{unit} {way[1]}"


@dataclass(frozen=True, kw_only=True, slots=True)
class Headline:
    """A figure that stands above all pages."""

    figure: str
    """Its key in tables of metrics."""
    word: str
    """What it is called there, short."""
    tab: str
    """Tab that has the whole story."""
    remedy: str
    """What makes it better, for a designer."""
    bounds: Bounds | None = None
    by_choice: bool = False
    """Whether it stands there only where the designer has given what it needs."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Shown:
    """A headline with its value."""

    headline: Headline
    text: str
    """The value with its unit."""
    standing: Standing
    reason: str
    """Why it stands so, and what to do; one sentence each."""
    old: bool = False
    """Whether it is of the design before the last edits."""


COST_RULE = Rule(
    name="parts_cost_1",
    label="cost of parts",
    unit="",
    better=Better.LOWER,
    why="LEDs, cameras, silicone and the rest, at the designer's own prices",
    stage="build",
)
DENT = "readable_dent_median_mm"
UNREADABLE_MM = 1000.0
"""A dent deeper than any skin: none is read."""
MAKEABLE, LOOK_AT = "checks_bad", "checks_warning"
MOST_NAMED = 3
"""Checks that the reason names."""
HEADLINES = (
    Headline(
        figure="peak_normal_force_N",
        word="Force",
        tab="Forces",
        remedy="A softer elastomer, a thicker wall or a smaller depth give less force",
    ),
    Headline(
        figure="contact_contrast_1",
        word="Contrast",
        tab="Tactile image",
        # On the finger `geltip`: .25 with roughness .25 and exposure 7100; .1 and 3500 .35 to .50
        # by the place of the touch; .07 and 1500 .48; .05 and 1000 .62. Half the exposure alone
        # .29; LEDs tilted by 20 degrees instead of -5 .05 more. Wall, modulus: no change.
        remedy=(
            "Under Optics, a Roughness (Coating) of .05 to .1 with a third to a seventh of the "
            "Exposure (Focus and sensor), so that no pixel is white, shows twice as much on a "
            "finger; then LEDs that graze the skin, and less Ambient power"
        ),
        bounds=Bounds(good=0.1, poor=0.03),
    ),
    Headline(
        figure="skin_seen_percent",
        word="Skin seen",
        tab="Maps",
        remedy="A wider view, a camera further back or tilted, or a second camera see more",
        bounds=Bounds(good=80.0, poor=50.0),
    ),
    Headline(
        figure=DENT,
        word="Least dent",
        tab="Maps",
        remedy="More contrast, more pixels on the skin or less noise make smaller dents readable",
        bounds=Bounds(good=0.05, poor=0.2),
    ),
    Headline(
        figure=MAKEABLE,
        word="Makeable",
        tab="Make",
        remedy="Each check says beside it what would mend it",
    ),
    Headline(
        figure=COST_RULE.name,
        word="Parts",
        tab="Compare",
        remedy="Fewer LEDs, one camera or a thinner wall cost less",
        by_choice=True,
    ),
)


def headlines(
    figures: Mapping[str, float],
    own: Mapping[str, Bounds],
    *,
    before: Mapping[str, float] | None = None,
    unmade: Sequence[str] = (),
    checks: Sequence[str] = (),
) -> tuple[Shown, ...]:
    """All of a design.

    Args:
        figures: What is known of it.
        own: The designer's limits by figure, in place of ours.
        before: What was known of it before the last edits; stands where nothing newer is known.
        unmade: Parts whose checks are not among the figures, since they are not made.
        checks: What does not pass, the worst first, in words.
    """
    found = []
    for headline in HEADLINES:
        if headline.by_choice and headline.figure not in {**figures, **(before or {})}:
            continue
        old = headline.figure not in figures and headline.figure in (before or {})
        shown = _shown(headline, (before or {}) if old else figures, own)
        known_good = shown.standing is Standing.GOOD and not old
        if headline.figure == MAKEABLE and known_good and unmade:
            shown = _makeable_so_far(shown, unmade)
        elif headline.figure == MAKEABLE and checks and not old:
            shown = replace(shown, reason=f"{shown.reason} {_named(checks)}")
        if old:
            reason = f"As it was before the last edits. {shown.reason}"
            shown = replace(shown, old=True, reason=reason)
        found.append(shown)
    return tuple(found)


def _shown(headline: Headline, figures: Mapping[str, float], own: Mapping[str, Bounds]) -> Shown:
    meant = COST_RULE if headline.figure == COST_RULE.name else rule(headline.figure)
    value = figures.get(headline.figure)
    if value is None:
        run = REMEDIES.get(meant.stage, "")
        reason = f"Not known yet: {run}." if run else "Not known yet."
        return Shown(headline=headline, text=MISSING, standing=Standing.OPEN, reason=reason)
    if headline.figure == MAKEABLE:
        return _makeable(headline, int(value), int(figures.get(LOOK_AT, 0.0)))
    bounds = own.get(headline.figure, headline.bounds)
    if headline.figure == DENT and value > UNREADABLE_MM:
        reason = "No dent can be read: the skin is too dark, or its pixels are white."
        return Shown(headline=headline, text="none", standing=Standing.POOR, reason=reason)
    text = f"{_brief(value)} {meant.unit}".strip()
    label = f"{meant.label[0].upper()}{meant.label[1:]}"
    what = f"{label} is {number(value)} {meant.unit}".rstrip() + f": {meant.why}."
    if bounds is None:
        return Shown(headline=headline, text=text, standing=Standing.PLAIN, reason=what)
    standing = bounds.standing(value)
    parts = [what, f"{standing.value.capitalize()}: {bounds.words(meant.unit)}."]
    parts.append(f"{headline.remedy}.")
    return Shown(headline=headline, text=text, standing=standing, reason=" ".join(parts))


def _brief(value: float) -> str:
    """Two digits, which fit beside four other figures; the reason has three."""
    return number(value, ".0f" if abs(value) >= 100.0 else ".2g")


def _makeable(headline: Headline, bad: int, look_at: int) -> Shown:
    if bad:
        text, standing = "no", Standing.POOR
        reason = f"{_checks(bad)} failed: it cannot be printed, cast or assembled as it is."
    elif look_at:
        text, standing = "mostly", Standing.FAIR
        reason = f"{_checks(look_at)} to look at: each may cost a second casting."
    else:
        text, standing, reason = "yes", Standing.GOOD, "All checks of the parts passed."
    if standing is not Standing.GOOD:
        reason = f"{reason} {headline.remedy}."
    return Shown(headline=headline, text=text, standing=standing, reason=reason)


def _makeable_so_far(shown: Shown, unmade: Sequence[str]) -> Shown:
    """What passed as far as it is known."""
    parts = " and ".join(unmade)
    reason = f"All checks so far passed; {parts} not made yet: {REMEDIES['mould']}."
    return replace(shown, text="so far", standing=Standing.OPEN, reason=reason)


def _named(checks: Sequence[str]) -> str:
    """The first of them by name."""
    more = f" and {len(checks) - MOST_NAMED} more" if len(checks) > MOST_NAMED else ""
    return f"They are: {', '.join(checks[:MOST_NAMED])}{more}."


def _checks(count: int) -> str:
    return f"{count} check{'s' if count > 1 else ''}"
