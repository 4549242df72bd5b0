"""Scores of fields against numbers worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.forces.peaks import Peaks
from sim.forces.scores import Score, press_frame, ratio, score, summary
from workbench.core.base.errors import SolveError

UPRIGHT = np.eye(3)
TRUTH = np.array([[0.0, 0.0, 2.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]])
FOUND = np.array([[1.0, 0.0, 1.0], [0.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 0.0]])


def test_errors_of_four_points_by_hand() -> None:
    """|e| sums to 1, 2, 1 over four points: .25, .5, .25 along the axes, their mean 1/3."""
    found = score(FOUND, TRUTH, UPRIGHT)
    assert found.error.tolist() == [0.25, 0.5, 0.25]
    assert found.mae == pytest.approx(1.0 / 3.0)
    assert found.peak == 2.0
    assert found.worst == 2.0
    assert found.found_total.tolist() == [1.0, 3.0, 1.0]
    assert found.true_total.tolist() == [0.0, 1.0, 2.0]


def test_totals_are_along_the_axes_of_the_press() -> None:
    """Normal X, U along Y: V = n x U is Z, so the sum (1, 3, 1) has components (3, 1, 1)."""
    frame = press_frame(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))
    assert np.array_equal(frame, [[0, 1, 0], [0, 0, 1], [1, 0, 0]])
    found = score(FOUND, TRUTH, frame)
    assert found.found_total.tolist() == [3.0, 1.0, 1.0]
    assert found.error.tolist() == [0.25, 0.5, 0.25], "errors stay along the sensor's axes"


def test_the_truth_scores_nothing_and_zero_scores_the_mean_of_the_truth() -> None:
    """0 exactly; zero has mean |truth| = 3 / 12, and a ratio of 1 to itself."""
    perfect = summary([score(TRUTH, TRUTH, UPRIGHT)])
    assert perfect.mae == perfect.over_peak == perfect.worst == 0.0
    assert perfect.total_mae == (0.0, 0.0, 0.0)
    zero = summary([score(np.zeros_like(TRUTH), TRUTH, UPRIGHT)])
    assert zero.mae == pytest.approx(3.0 / 12.0)
    assert ratio(zero.mae, zero.mae) == 1.0
    assert zero.total_mae == zero.total_mean == (0.0, 1.0, 2.0)


def test_samples_count_alike_and_the_peak_is_that_of_all() -> None:
    """Errors 1/3 and 0 have the mean 1/6; over the larger peak 4 that is 1/24, over own 1/12."""
    both = summary([score(FOUND, TRUTH, UPRIGHT), score(2.0 * TRUTH, 2.0 * TRUTH, UPRIGHT)])
    assert both.samples == 2
    assert both.mae == pytest.approx(1.0 / 6.0)
    assert both.peak == 4.0
    assert both.over_peak == pytest.approx(1.0 / 24.0)
    assert both.over_own_peak == pytest.approx(0.5 * (1.0 / 3.0) / 2.0)
    assert both.total_mae == pytest.approx((0.5, 1.0, 0.5))
    assert both.total_mean == pytest.approx((0.0, 1.5, 3.0))
    assert both.total_largest == (0.0, 2.0, 4.0)


def test_every_point_counts_alike_whatever_its_skin() -> None:
    """1/3 on four points and 0 on eight: 1/9 over twelve, and not the mean of two means."""
    wide = np.concatenate([TRUTH, np.zeros((4, 3))])
    assert summary([score(FOUND, TRUTH, UPRIGHT), score(wide, wide, UPRIGHT)]).mae == pytest.approx(
        1.0 / 9.0
    )


def test_biases_of_peaks_are_means_of_ratios() -> None:
    """Pressures of 1.2 and 0.9: +5 %; discs of half and all: -25 %; no truth has no say."""

    def scored(pressure: float, disc: float, true: float = 1.0) -> Score:
        found = Peaks(peak_MPa=pressure, peak_disc_N=disc)
        return score(FOUND, TRUTH, UPRIGHT, peaks=(found, Peaks(peak_MPa=true, peak_disc_N=true)))

    both = summary([scored(1.2, 0.5), scored(0.9, 1.0), scored(0.9, 1.0, 0.0)])
    assert both.peak_pressure_bias == pytest.approx(0.05)
    assert both.peak_disc_bias == pytest.approx(-0.25)
    none = summary([score(FOUND, TRUTH, UPRIGHT)])
    assert math.isnan(none.peak_pressure_bias) and math.isnan(none.peak_disc_bias)


def test_an_error_does_not_cancel_over_samples() -> None:
    """Totals off by +1 and -1 have a mean absolute error of 1, not 0."""
    more, less = TRUTH.copy(), TRUTH.copy()
    more[0, 2] += 1.0
    less[0, 2] -= 1.0
    found = summary([score(field, TRUTH, UPRIGHT) for field in (more, less)])
    assert found.total_mae == (0.0, 0.0, 1.0)


def test_no_truth_makes_no_ratio() -> None:
    """Over a peak of 0 stands NaN, which meets no limit, and not 0."""
    none = np.zeros((4, 3))
    found = summary([score(none, none, UPRIGHT)])
    assert math.isnan(found.over_peak) and math.isnan(found.over_own_peak)
    assert math.isnan(ratio(1.0, 0.0))


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_not_finite_is_refused(bad: float) -> None:
    """One number of twelve, on either side."""
    spoiled = TRUTH.copy()
    spoiled[1, 2] = bad
    with pytest.raises(SolveError, match="1 of 12 numbers of the found field"):
        score(spoiled, TRUTH, UPRIGHT)
    with pytest.raises(SolveError, match="1 of 12 numbers of the true field"):
        score(TRUTH, spoiled, UPRIGHT)


def test_fields_of_two_skins_are_not_compared() -> None:
    """Three points against four, and no scores at all."""
    with pytest.raises(ValueError, match="found has shape"):
        score(FOUND[:3], TRUTH, UPRIGHT)
    with pytest.raises(ValueError, match="no scores"):
        summary([])
