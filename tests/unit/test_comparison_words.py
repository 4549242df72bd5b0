"""A comparison in words: values with units, and which of the two is better."""

from __future__ import annotations

import pytest

from workbench.variants.comparison import changes
from workbench.variants.comparison_words import sentences

A = {"membrane_g": 8.0, "skin_seen_percent": 60.0, "stiffness_N_per_mm": 0.4, "glare_percent": 2.0}


def test_each_figure_has_its_unit_and_its_better_side() -> None:
    """More skin seen speaks for B, more mass for A, another stiffness for neither."""
    b = {"membrane_g": 9.5, "skin_seen_percent": 80.0, "stiffness_N_per_mm": 0.5}
    assert sentences(changes(A, {**b, "glare_percent": 2.0})) == [
        "B is better: skin seen A 60, B 80 % (higher is better).",
        "A is better: mass of the membrane A 8, B 9.5 g (lower is better).",
        "A matter of choice: stiffness A 0.4, B 0.5 N/mm.",
    ]


def test_what_one_lacks_or_both_share_is_not_told() -> None:
    """A figure of one alone compares nothing, and neither do equal ones."""
    assert sentences(changes(A, A)) == []
    assert sentences(changes(A, {})) == []


@pytest.mark.parametrize(("swap", "head"), [(False, "B is better"), (True, "A is better")])
def test_the_figures_that_decide_come_first_and_the_rest_is_counted(swap: bool, head: str) -> None:
    """The chief ones, the largest change first; then how many more there are."""
    low = {
        "contact_pixels_percent": 1.0,
        "skin_seen_percent": 50.0,
        "contact_contrast_1": 0.5,
        "contact_change_mean_grey": 1.0,
    }
    high = {
        "contact_pixels_percent": 9.0,
        "skin_seen_percent": 60.0,
        "contact_contrast_1": 0.9,
        "contact_change_mean_grey": 3.0,
    }
    (line,) = sentences(changes(high, low) if swap else changes(low, high))
    assert line.startswith(f"{head}: mean change of grey")
    assert line.endswith("and 1 more.")
    assert "pixels of the touch" not in line
    assert line.index("contrast of the touch") < line.index("skin seen")
