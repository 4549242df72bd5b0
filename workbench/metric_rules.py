"""What each figure of a sensor means: label, unit, which way is better and why, what computes it.

The rules are stated once, here; the score card, comparisons, sweeps and reports only apply them.
A figure whose better direction is a matter of what the sensor is for (its stiffness, say) is
neutral. A figure that has no rule, from a newer version, is neutral too and named by its key.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

from workbench.core.units import split_unit


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
UP, DOWN, EVEN = Better.HIGHER, Better.LOWER, Better.NEUTRAL
SET = "follows from the press: softer or stiffer is a choice of the design"
SEEN = "what the camera does not see cannot be felt"
ROUND = "even light uses the whole range of grey levels; 1 is perfectly even"
NULL = "the score of showing no contact at all: the lower, the clearer the touch"
MAPPED = "the direction that the maps of the skin declare (sim.optics.maps)"
STEREO = "three directions of light determine a normal (Woodham 1980, photometric stereo)"
SENSED = "more grey levels for the same touch stand out more from noise"
_ROWS: tuple[tuple[str, str, str, Better, str, str, bool], ...] = (
    ("press_depth_mm", "press depth", "mm", EVEN, "chosen by the designer", "", False),
    ("peak_normal_force_N", "peak force", "N", EVEN, SET, "shoot", True),
    ("normal_force_N", "force in the last frame", "N", EVEN, SET, "shoot", False),
    ("tangential_force_N", "tangential force", "N", EVEN, SET, "shoot", False),
    ("stiffness_N_per_mm", "stiffness", "N/mm", EVEN, SET, "shoot", True),
    ("displacement_max_mm", "largest displacement", "mm", EVEN, SET, "shoot", False),
    (
        *("penetration_max_mm", "overlap of the contact", "mm", DOWN),
        *("an error of the solver: bodies do not overlap", "shoot", False),
    ),
    ("contact_change_mean_grey", "mean change of grey", "grey", UP, SENSED, "shoot", True),
    (
        *("contact_change_max_grey", "largest change of grey", "grey", EVEN),
        *("one sparkle decides it, and 255 is where it saturates", "shoot", False),
    ),
    ("contact_contrast_1", "contrast of the touch", "", UP, SENSED, "shoot", True),
    ("change_per_force_grey_per_N", "change per force", "grey/N", UP, SENSED, "shoot", True),
    ("contact_null_psnr_dB", "PSNR of no contact", "dB", DOWN, NULL, "shoot", False),
    ("contact_null_ssim_1", "SSIM of no contact", "", DOWN, NULL, "shoot", False),
    (
        *("contact_pixels_percent", "pixels of the touch", "%", UP),
        *("more pixels resolve the shape of what touches", "shoot", False),
    ),
    ("image_covered_percent", "image that sees skin", "%", UP, SEEN, "shoot", False),
    ("image_evenness_p5_over_p95", "evenness of the image", "", UP, ROUND, "shoot", False),
    ("skin_light_p5_over_p95", "evenness of direct light", "", UP, ROUND, "shoot", False),
    ("skin_lit_by_three_percent", "skin lit by three LEDs", "%", UP, STEREO, "shoot", False),
    ("skin_seen_percent", "skin seen", "%", UP, SEEN, "maps", True),
    (
        *("mm_per_pixel_median_mm", "skin per pixel", "mm", DOWN),
        *("the size of the smallest thing that two pixels can tell apart", "maps", True),
    ),
    ("incidence_median_deg", "angle of sight", "°", DOWN, MAPPED, "maps", False),
    ("led_separability_median_1", "separability of LEDs", "", UP, MAPPED, "maps", False),
    ("light_evenness_p5_over_p95_1", "evenness of light", "", UP, ROUND, "maps", True),
    (
        *("normal_resolvability_median_per_deg", "resolvability of normals", "1/°", UP),
        *(MAPPED, "maps", True),
    ),
    (
        *("sensitivity_median_grey_per_0.1mm", "sensitivity to depth", "grey/0.1 mm", UP),
        *(SENSED, "maps", True),
    ),
    (
        *("sensitivity_median_grey_per_0.1N", "sensitivity to force", "grey/0.1 N", UP),
        *(SENSED, "maps", True),
    ),
    (
        *("glare_percent", "glare", "%", DOWN),
        *("there an LED outshines the skin", "maps", True),
    ),
    (
        *("membrane_ml", "silicone of the membrane", "ml", EVEN),
        *("its mass is what counts", "build", False),
    ),
    (
        *("membrane_g", "mass of the membrane", "g", DOWN),
        *("less to carry on a hand, and to cast", "build", True),
    ),
    (
        *("checks_good", "checks passed", "", EVEN),
        *("depends on how many parts there are", "mould", False),
    ),
    (
        *("checks_warning", "checks to look at", "", DOWN),
        *("each may cost a second casting", "mould", True),
    ),
    (
        *("checks_bad", "checks failed", "", DOWN),
        *("each cannot be printed, cast or assembled as it is", "mould", True),
    ),
)
RULES = {
    name: Rule(name=name, label=label, unit=unit, better=better, why=why, stage=stage, chief=chief)
    for name, label, unit, better, why, stage, chief in _ROWS
}
"""All figures in the order of the score card."""


def rule(name: str) -> Rule:
    """The rule of a figure; one without is neutral and keeps its key as label."""
    known = RULES.get(name)
    if known is not None:
        return known
    label, unit = split_unit(name)
    return Rule(name=name, label=label, unit=unit, better=EVEN, why="no rule", stage="")
