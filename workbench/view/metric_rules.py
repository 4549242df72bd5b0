"""What each figure of a sensor means: label, unit, which way is better and why, what computes it.

The rules are stated once, here; the score card, comparisons, sweeps and reports only apply them.
A figure whose better direction is a matter of what the sensor is for (its stiffness, say) is
neutral. A figure that has no rule, from a newer version, is neutral too and named by its key.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

from sim.optics.maps.map_kind import map_kinds
from workbench.core.base.units import split_unit


class Better(enum.StrEnum):
    """Which way a figure improves."""

    HIGHER = "higher is better"
    LOWER = "lower is better"
    NEUTRAL = "neutral"

    @property
    def arrow(self) -> str:
        """Sign beside the name of a figure."""
        return {"higher is better": "↑", "lower is better": "↓"}.get(self.value, "–")


@dataclass(frozen=True, kw_only=True, slots=True)
class Rule:
    """What a figure means."""

    name: str
    """Key in tables of metrics, which ends in the unit."""
    label: str
    unit: str
    better: Better
    why: str
    """Reason for the direction, with its source; one sentence."""
    stage: str
    """Stage whose result holds the figure; "" for what the designer chose."""
    chief: bool = False
    """Whether a designer decides by it: it stands on the short score card."""


REMEDIES = {
    "shoot": "Run press",
    "maps": "Measure maps",
    "build": "build the shape",
    "mould": "Make parts",
}
"""What to press for the figures of a stage."""
SET = "follows from the press: softer or stiffer is a choice of the design"
SEEN = "what the camera does not see cannot be felt"
ROUND = "even light uses the whole range of grey levels; 1 is perfectly even"
NULL = "the score of showing no contact at all: the lower, the clearer the touch"
STEREO = "three directions of light determine a normal (Woodham 1980, photometric stereo)"
CONTRAST = "spread of the change about the contact over the brightness there: it outlives noise"
SENSED = "more grey levels for the same touch stand out more from noise"
OF_THE_PRESS = (
    Rule(
        name="press_depth_mm",
        label="press depth",
        unit="mm",
        better=Better.NEUTRAL,
        why="chosen by the designer",
        stage="",
    ),
    Rule(
        name="peak_normal_force_N",
        label="peak force",
        unit="N",
        better=Better.NEUTRAL,
        why=SET,
        stage="shoot",
        chief=True,
    ),
    Rule(
        name="normal_force_N",
        label="force in the last frame",
        unit="N",
        better=Better.NEUTRAL,
        why=SET,
        stage="shoot",
    ),
    Rule(
        name="tangential_force_N",
        label="tangential force",
        unit="N",
        better=Better.NEUTRAL,
        why=SET,
        stage="shoot",
    ),
    Rule(
        name="stiffness_N_per_mm",
        label="stiffness",
        unit="N/mm",
        better=Better.NEUTRAL,
        why=SET,
        stage="shoot",
        chief=True,
    ),
    Rule(
        name="displacement_max_mm",
        label="largest displacement",
        unit="mm",
        better=Better.NEUTRAL,
        why=SET,
        stage="shoot",
    ),
    Rule(
        name="penetration_max_mm",
        label="overlap of the contact",
        unit="mm",
        better=Better.LOWER,
        why="an error of the solver: bodies do not overlap",
        stage="shoot",
    ),
    Rule(
        name="contact_change_mean_grey",
        label="mean change of grey",
        unit="grey",
        better=Better.HIGHER,
        why=SENSED,
        stage="shoot",
        chief=True,
    ),
    Rule(
        name="contact_change_max_grey",
        label="largest change of grey",
        unit="grey",
        better=Better.NEUTRAL,
        why="one sparkle decides it, and 255 is where it saturates",
        stage="shoot",
    ),
    Rule(
        name="contact_contrast_1",
        label="contrast of the touch",
        unit="",
        better=Better.HIGHER,
        why=CONTRAST,
        stage="shoot",
        chief=True,
    ),
    Rule(
        name="change_per_force_grey_per_N",
        label="change per force",
        unit="grey/N",
        better=Better.HIGHER,
        why="of this object and place; the sensitivity of the maps is of a ball all over the skin",
        stage="shoot",
        chief=True,
    ),
    Rule(
        name="contact_null_psnr_dB",
        label="PSNR of no contact",
        unit="dB",
        better=Better.LOWER,
        why=NULL,
        stage="shoot",
    ),
    Rule(
        name="contact_null_ssim_1",
        label="SSIM of no contact",
        unit="",
        better=Better.LOWER,
        why=NULL,
        stage="shoot",
    ),
    Rule(
        name="contact_pixels_percent",
        label="pixels of the touch",
        unit="%",
        better=Better.HIGHER,
        why="more pixels resolve the shape of what touches",
        stage="shoot",
    ),
    Rule(
        name="image_covered_percent",
        label="image that sees skin",
        unit="%",
        better=Better.HIGHER,
        why=SEEN,
        stage="shoot",
    ),
    Rule(
        name="image_evenness_p5_over_p95",
        label="evenness of the image",
        unit="",
        better=Better.HIGHER,
        why=ROUND,
        stage="shoot",
    ),
    Rule(
        name="skin_light_p5_over_p95",
        label="evenness of direct light",
        unit="",
        better=Better.HIGHER,
        why=ROUND,
        stage="shoot",
    ),
    Rule(
        name="skin_lit_by_three_percent",
        label="skin lit by three LEDs",
        unit="%",
        better=Better.HIGHER,
        why=STEREO,
        stage="shoot",
    ),
)
OF_THE_PARTS = (
    Rule(
        name="membrane_ml",
        label="silicone of the membrane",
        unit="ml",
        better=Better.NEUTRAL,
        why="its mass is what counts",
        stage="build",
    ),
    Rule(
        name="membrane_g",
        label="mass of the membrane",
        unit="g",
        better=Better.LOWER,
        why="less to carry on a hand, and to cast",
        stage="build",
        chief=True,
    ),
    Rule(
        name="checks_good",
        label="checks passed",
        unit="",
        better=Better.NEUTRAL,
        why="depends on how many parts there are",
        stage="mould",
    ),
    Rule(
        name="checks_warning",
        label="checks to look at",
        unit="",
        better=Better.LOWER,
        why="each may cost a second casting",
        stage="mould",
        chief=True,
    ),
    Rule(
        name="checks_bad",
        label="checks failed",
        unit="",
        better=Better.LOWER,
        why="each cannot be printed, cast or assembled as it is",
        stage="mould",
        chief=True,
    ),
)


def _of_the_maps() -> tuple[Rule, ...]:
    """What the maps of the skin say of their figures."""
    return tuple(
        Rule(
            name=kind.figure,
            label=kind.figure_label,
            unit=kind.figure_unit,
            better=Better.HIGHER if kind.more_is_better else Better.LOWER,
            why=kind.why,
            stage="maps",
            chief=kind.chief,
        )
        for kind in map_kinds().values()
    )


RULES = {rule.name: rule for rule in (*OF_THE_PRESS, *_of_the_maps(), *OF_THE_PARTS)}
"""All figures in the order of the score card."""


def rule(name: str) -> Rule:
    """The rule of a figure; one without is neutral and keeps its key as label."""
    known = RULES.get(name)
    if known is not None:
        return known
    label, unit = split_unit(name)
    return Rule(name=name, label=label, unit=unit, better=Better.NEUTRAL, why="no rule", stage="")
