"""What is compared of photographs: colours, and what is not round about the middle."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.proof.validation.optics import photographs
from workbench.proof.validation.optics.photographs import (
    TRUNK_PHOTOS,
    balance_error,
    oval_likeness,
    quarter_turned,
    shipped_grey,
)

ROW, COLUMN = np.mgrid[:48, :64]
DOWN, RIGHT = ROW - 23.5, COLUMN - 31.5


def grey(values: np.ndarray) -> np.ndarray:
    return np.repeat(values[:, :, None], 3, axis=2)


def test_balance_is_of_colours_not_of_brightness() -> None:
    """Half as bright has the same balance; twice the red of (1, 1, 1) is 1.5 of the mean."""
    even = np.ones((4, 4, 3))
    assert balance_error(0.5 * even, even) == 0.0
    assert balance_error(even * [2.0, 1.0, 1.0], even) == pytest.approx(0.5)


def test_what_is_round_does_not_count() -> None:
    """An oval is like itself under any round light, and unlike itself turned by 90 degrees."""
    oval = grey(np.exp(-((RIGHT / 14.0) ** 2) - (DOWN / 8.0) ** 2))
    round_light = grey(np.exp(-(RIGHT**2 + DOWN**2) / 200.0))
    # Circles a pixel wide leave a little of a light that falls off within ten of them.
    assert oval_likeness(oval, oval + round_light) > 0.97
    assert oval_likeness(quarter_turned(oval), oval) < -0.8


def test_photographs_of_the_trunk_are_not_round() -> None:
    """A photograph turned by 90 degrees is unlike itself, so the row can fail."""
    for name in TRUNK_PHOTOS:
        photo = shipped_grey(name)
        assert oval_likeness(quarter_turned(photo), photo) < 0.1


@pytest.mark.slow
def test_only_a_trunk_is_like_the_trunk(taichi_device: str) -> None:
    """The preset's image passes beside both photographs."""
    shown = photographs.trunk_image()
    for name in TRUNK_PHOTOS:
        assert oval_likeness(shown, shipped_grey(name)) >= photographs.TRUNK_LEAST
