"""What slides, by motion relative to the object: closed forms, and no word of meshes or frames."""

from __future__ import annotations

import numpy as np
import pytest

from sim.forces.slip import (
    GROSS_SHARE,
    LEAST_MM,
    SLIDING_RATE,
    gross_slip,
    mindlin_share,
    object_way_mm,
    slip_of,
)

RADII = (np.arange(4000) + 0.5) / 4000.0
"""Rings of a round contact of radius 1."""


def partial_slip_mm(stick: float, way_mm: float) -> np.ndarray:
    """Mindlin's annulus: 1 - (2 / pi) asin(c / r) of the way beyond the stick radius c."""
    beyond = 1.0 - 2.0 / np.pi * np.arcsin(np.minimum(stick / RADII, 1.0))
    return way_mm * np.where(stick < RADII, beyond, 0.0)


@pytest.mark.parametrize("ratio", [0.1, 0.4, 0.8])
def test_share_of_partial_slip_is_mindlins(ratio: float) -> None:
    """1 - (c / a)^2 / sin^2(.85 pi / 2), c / a = (1 - Q / mu P)^(1/3), on rings of equal width."""
    stick = (1.0 - ratio) ** (1.0 / 3.0)
    slip = slip_of(partial_slip_mm(stick, 0.1), np.full(4000, 0.1), np.ones(4000, bool))
    assert slip.share(RADII) == pytest.approx(mindlin_share(ratio), abs=1e-3)
    # The definition sees no more than 6 % of the annulus less than there is.
    assert 0.0 <= 1.0 - stick**2 - slip.share(RADII) < 0.06


def test_the_share_does_not_depend_on_frames() -> None:
    """A way of .4 mm in one frame or in twenty: the same places slide."""
    moved = partial_slip_mm(0.7, 0.4)
    once = slip_of(moved, np.full(4000, 0.4), np.ones(4000, bool))
    part = slip_of(moved / 20.0, np.full(4000, 0.02), np.ones(4000, bool))
    np.testing.assert_array_equal(once.sliding, part.sliding)


def test_the_share_is_of_areas_and_of_what_stayed() -> None:
    """Two of four places slide; one touched just now: 3 of 6 mm2, not one of two places."""
    moved = np.array([0.1, 0.0, 0.1, 0.002])
    stayed = np.array([True, True, False, True])
    slip = slip_of(moved, np.full(4, 0.1), stayed)
    assert slip.sliding.tolist() == [True, False, False, False]
    assert slip.share(np.array([3.0, 1.0, 5.0, 2.0])) == pytest.approx(0.5)
    nothing = slip_of(moved, np.full(4, 0.1), np.zeros(4, bool))
    assert nothing.share(np.ones(4)) == 0.0


def test_nothing_slides_where_nothing_goes() -> None:
    """A tolerance's worth of motion of an object at rest is no slip."""
    slip = slip_of(np.array([0.9, 1.1]) * LEAST_MM, np.zeros(2), np.ones(2, bool))
    assert slip.sliding.tolist() == [False, True]


def test_a_rolling_ball_stands_still_where_it_touches() -> None:
    """The way is that of the origin there; under a twist it is that of each place."""
    places = np.array([[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    turned = np.array([[1.0, 0.1, 0.0], [2.0, 0.2, 0.0]])
    assert object_way_mm(places, places, 0.3).tolist() == [0.3, 0.3]
    assert object_way_mm(turned, places, 0.0) == pytest.approx([0.1, 0.2])


@pytest.mark.parametrize("frames", [10, 40])
def test_onset_of_gross_slip_lies_where_the_share_says(frames: int) -> None:
    """A share of .5 + way reaches .95 at .45 mm, whatever the frames."""
    way = np.linspace(0.0, 1.0, frames + 1)[1:]
    middle = way - 0.5 / frames
    found = gross_slip(np.minimum(0.5 + middle, 1.0), way)
    assert found is not None
    assert found.way_mm == pytest.approx(GROSS_SHARE - 0.5, abs=1e-9)
    assert way[found.frame - 2] - 0.5 / frames < found.way_mm <= middle[found.frame - 1]


def test_there_is_no_onset_without_gross_slip() -> None:
    """None below the share and without frames; all at once counts from the middle of its frame."""
    assert gross_slip(np.array([0.2, 0.94]), np.array([0.1, 0.2])) is None
    assert gross_slip(np.zeros(0), np.zeros(0)) is None
    found = gross_slip(np.array([1.0]), np.array([0.4]))
    assert found is not None
    assert (found.frame, found.way_mm) == (1, pytest.approx(0.2))


def test_elastic_slip_of_finite_elements_is_below_the_rate() -> None:
    """5 um of elastic slip within the least way to a stuck cone stays under the rate."""
    from sim.fem.contact_law import SLIP_MM

    assert SLIDING_RATE * 0.1 > SLIP_MM
