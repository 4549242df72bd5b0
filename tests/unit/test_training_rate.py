"""The learning rate over a training, against the cosine that it names."""

from __future__ import annotations

import dataclasses

import pytest

from sim.forces.training.settings import LAST_RATE, PRESETS, rate_factor
from workbench.core.base.errors import DesignError

SETTINGS = dataclasses.replace(next(iter(PRESETS.values())), warm_up=0.1, cosine=True)


def test_rate_rises_then_falls_along_a_cosine() -> None:
    """Of 1000 steps 100 warm up evenly; halfway down it is the mean, at the end 1 %."""
    assert rate_factor(0, 1000, SETTINGS) == pytest.approx(0.01)
    assert rate_factor(49, 1000, SETTINGS) == pytest.approx(0.5)
    assert rate_factor(100, 1000, SETTINGS) == pytest.approx(1.0)
    assert rate_factor(550, 1000, SETTINGS) == pytest.approx((1.0 + LAST_RATE) / 2.0)
    assert rate_factor(1000, 1000, SETTINGS) == pytest.approx(LAST_RATE)


def test_rate_without_a_cosine_stays() -> None:
    """Once warm it is the whole rate to the end."""
    settings = dataclasses.replace(SETTINGS, cosine=False)
    assert rate_factor(500, 1000, settings) == rate_factor(999, 1000, settings) == 1.0


def test_a_network_is_tuned_as_it_was_trained() -> None:
    """The network and what an error counts are those of `small`; gradients and averages too."""
    small, tune = PRESETS["small"], PRESETS["tune"]
    for name in ("spec", "foot", "clip", "averaging", "batch", "cosine"):
        assert getattr(tune, name) == getattr(small, name), name
    # A tuned network starts near its goal.
    assert tune.rate < small.rate and tune.epochs < small.epochs


@pytest.mark.parametrize("turns", [2, 8])
def test_turned_skins_and_patches_exclude_each_other(turns: int) -> None:
    """A patch has any angle already; one turn alone is no turn."""
    patches = dataclasses.replace(SETTINGS, turns=1, patch_spacings=4.5)
    assert patches.turns == 1
    with pytest.raises(DesignError, match=f"{turns} turns are of whole skins"):
        dataclasses.replace(patches, turns=turns)
