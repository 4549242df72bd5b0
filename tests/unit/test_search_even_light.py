"""LED powers for even light by least squares: closed forms, and far better than trials."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.core.design.lighting import LedRing
from workbench.search.even_light import even_powers, evened, evenness


def test_lights_that_do_not_overlap_get_the_inverse_of_their_strength() -> None:
    """Light 1 gives 1 on its half, light 2 gives 4 on the other: powers 4 : 1."""
    light = np.array([[1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 4.0, 4.0]])
    powers = even_powers(light, np.ones(4), given=np.zeros(4))
    assert powers[0] / powers[1] == pytest.approx(4.0)
    assert evenness(powers @ light, np.ones(4)) == pytest.approx(1.0)
    ring = evened(LedRing(count=2), light, np.ones(4))
    assert ring.powers == (1.0, 0.25)


def test_light_that_is_there_already_is_made_up_for() -> None:
    """What another lamp gives to one half, the LED of that half need not."""
    light = np.array([[1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 1.0]])
    given = np.array([0.25, 0.25, 0.0, 0.0])
    total = even_powers(light, np.ones(4), given=given) @ light + given
    assert total == pytest.approx(np.full(4, total[0]))


def ring_light() -> tuple[np.ndarray, np.ndarray]:
    """Nine unlike LEDs around a dome of 2,000 places, by the inverse square and the cosine."""
    rng = np.random.default_rng(5)
    up = rng.uniform(0.05, 1.0, 2000)
    around = rng.uniform(0.0, 2.0 * np.pi, 2000)
    wide = np.sqrt(1.0 - up**2)
    places = 15.0 * np.column_stack([wide * np.cos(around), wide * np.sin(around), up])
    turn = 2.0 * np.pi * np.arange(9) / 9 + 0.3 * rng.uniform(-1.0, 1.0, 9)
    leds = np.column_stack([9.0 * np.cos(turn), 9.0 * np.sin(turn), np.zeros(9)])
    way = places[None] - leds[:, None]
    length = np.linalg.norm(way, axis=2)
    cosine = np.maximum(np.einsum("lvi,vi->lv", way / length[..., None], places / 15.0), 0.0)
    strength = rng.uniform(0.3, 3.0, 9)
    return strength[:, None] * cosine * way[..., 2] / length**3, np.ones(2000)


def test_least_squares_is_better_than_the_best_of_200_trials() -> None:
    """Of nine unlike LEDs on a dome, and a fifth better than equal powers."""
    light, areas = ring_light()
    powers = even_powers(light, areas, given=np.zeros(2000))
    rng = np.random.default_rng(0)
    trials = [evenness(p @ light, areas) for p in rng.uniform(0.0, 1.0, (200, 9))]
    assert (powers >= 0.0).all()
    assert evenness(powers @ light, areas) > max(trials)
    assert evenness(powers @ light, areas) > 1.2 * evenness(light.sum(axis=0), areas)
