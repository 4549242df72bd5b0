"""Goals as designers say them: the figures and limits that words stand for.

Amounts in them are our choice; a file that wants others states goals and limits itself, which take
the place of a wish's for the same figure.
"""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.search.problem import Goal, Limit, Tolerances, Want
from workbench.search.search_figures import LEDS, SAME


@dataclass(frozen=True, kw_only=True, slots=True)
class Wish:
    """What some words stand for."""

    words: str
    goals: tuple[Goal, ...] = ()
    limits: tuple[Limit, ...] = ()
    tolerances: Tolerances | None = None


EVEN, LIGHT = "light_evenness_p5_over_p95_1", "light_on_skin_percent"
WHITE = "overexposed_percent"
WISHES = {
    wish.words: wish
    for wish in (
        Wish(
            words="brightest and most even",
            goals=(Goal(figure=LIGHT, want=Want.MAX), Goal(figure=EVEN, want=Want.MAX)),
            limits=(Limit(figure="glare_percent", at_most=1.0), Limit(figure=WHITE, at_most=1.0)),
        ),
        Wish(
            words="feels .1 N",
            goals=(
                Goal(figure="sensitivity_median_grey_per_0.1N", want=Want.MAX),
                Goal(figure="peak_normal_force_N", want=Want.MAX),
            ),
            limits=(Limit(figure="checks_bad", at_most=0.0),),
        ),
        Wish(
            words="smallest that sees the tip",
            goals=(Goal(figure="membrane_ml", want=Want.MIN),),
            limits=(Limit(figure="tip_seen_percent", at_least=95.0),),
        ),
        Wish(
            words="fewest LEDs for the same image",
            goals=(Goal(figure=LEDS, want=Want.MIN), Goal(figure=SAME, want=Want.MAX)),
            limits=(Limit(figure=SAME, at_least=25.0),),
        ),
        Wish(words="robust to .3 mm", tolerances=Tolerances(twins=8, led_mm=0.3)),
    )
}


def wish_of(words: object) -> Wish:
    """The wish of these words.

    Raises:
        DesignError: If there is none.
    """
    if not isinstance(words, str) or words not in WISHES:
        hint = suggest(str(words), WISHES)
        raise DesignError(f"there is no wish {shown(words)}", hint=hint, at="wishes")
    return WISHES[words]
