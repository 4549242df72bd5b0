"""Environments for gymnasium on a small finger: its checker, seeds, goals, and how they end."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.unit.test_sensor import small_pack
from workbench.core.base.errors import DesignError
from workbench.sensor.pack import write_pack

gymnasium = pytest.importorskip("gymnasium")

pytestmark = pytest.mark.usefixtures("taichi_device")
PRESS, SLIDE = "WorkbenchPress-v0", "WorkbenchSlide-v0"
MODULE = "workbench.environments:"


@pytest.fixture(scope="module")
def pack(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The small finger on disk."""
    folder = tmp_path_factory.mktemp("pack")
    write_pack(small_pack(), folder, {})
    return folder


@pytest.mark.parametrize("name", [PRESS, SLIDE])
def test_gymnasiums_checker_finds_nothing(name: str, pack: Path) -> None:
    """Spaces, seeds, types and rendering are as gymnasium asks; its warnings are errors."""
    from gymnasium.utils.env_checker import check_env

    check_env(gymnasium.make(MODULE + name, sensor=pack, render_mode="rgb_array").unwrapped)


@pytest.mark.parametrize("name", [PRESS, SLIDE])
def test_a_seed_gives_the_same_episode(name: str, pack: Path) -> None:
    """Equal observations and rewards to the last bit; another seed begins elsewhere."""

    def episode(seed: int) -> list[np.ndarray]:
        environment = gymnasium.make(MODULE + name, sensor=pack)
        seen, _ = environment.reset(seed=seed)
        found = [*seen.values()]
        for _ in range(3):
            seen, reward, *_ = environment.step(np.array([0.02, 0.0, -0.05], np.float32))
            found += [*seen.values(), np.array(reward)]
        return found

    first, again, other = episode(3), episode(3), episode(4)
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))
    assert not all(np.array_equal(a, b) for a, b in zip(first, other, strict=True))


def played(
    environment: Any, seed: int, action: Callable[[dict[str, np.ndarray]], list[float]]
) -> tuple[float, bool, bool]:
    """Sum of rewards of an episode, whether it reached its goal, whether it was cut off."""
    seen, _ = environment.reset(seed=seed)
    total, ended, cut, told = 0.0, False, False, {}
    while not ended and not cut:
        seen, reward, ended, cut, told = environment.step(np.array(action(seen), np.float32))
        total += reward
    return total, told["is_success"], cut


def test_press_rewards_the_force_that_is_asked_for(pack: Path) -> None:
    """Steps in proportion to what is missing reach it; full steps exceed it; nothing costs 1."""
    environment = gymnasium.make(MODULE + PRESS, sensor=pack)

    def careful(seen: dict[str, np.ndarray]) -> list[float]:
        return [0.0, 0.0, -0.1 * float(np.clip(1.0 - seen["force_N"][2] / seen["goal"][0], -1, 1))]

    reached = [played(environment, seed, careful) for seed in range(3)]
    assert all(done and total > 0.5 for total, done, _ in reached), reached
    rushed = played(environment, 0, lambda seen: [0.0, 0.0, -0.1])
    assert not rushed[1] and not rushed[2] and rushed[0] < -1.0
    idle = played(environment, 0, lambda seen: [0.0, 0.0, 0.0])
    assert idle[2] and idle[0] == pytest.approx(-1.0)


def test_slide_asks_to_press_before_it_drags(pack: Path) -> None:
    """Dragged at once the ball slides; pressed first it carries the skin; lifted it is lost."""
    environment = gymnasium.make(MODULE + SLIDE, sensor=pack, most_N=6.0)
    dragged = played(environment, 1, lambda seen: [0.05, 0.0, 0.0])
    assert not dragged[1] and not dragged[2] and dragged[0] < 0.0

    def holding(seen: dict[str, np.ndarray]) -> list[float]:
        deep = seen["way_mm"][2] < -0.85
        return [0.05 if deep else 0.0, 0.0, 0.0 if deep else -0.1]

    assert played(environment, 1, holding)[1]
    assert played(environment, 1, lambda seen: [0.0, 0.0, 0.1])[0] == pytest.approx(-1.0)


def test_objects_begin_where_they_just_touch(pack: Path) -> None:
    """A step of the gap brings no force, one more does; at places away from the skin's edge."""
    environment = gymnasium.make(MODULE + PRESS, sensor=pack).unwrapped
    for seed in range(3):
        environment.reset(seed=seed)
        assert environment.force_N == pytest.approx(np.zeros(3), abs=1e-6)
        environment.step(np.array([0.0, 0.0, -0.09]))
        assert environment.force_N == pytest.approx(np.zeros(3), abs=1e-6)
        environment.step(np.array([0.0, 0.0, -0.06]))
        assert environment.force_N[2] > 0.0
    # The finger stands on its rim at z = 0.
    assert environment._place.origin_mm[2] > 6.0


def test_bad_options_are_refused(pack: Path) -> None:
    """Steps that contact cannot follow, margins that leave no skin."""
    with pytest.raises(DesignError, match=r"step 2 mm is outside 0.001 to 1 mm"):
        gymnasium.make(MODULE + PRESS, sensor=pack, step_mm=2.0)
    with pytest.raises(DesignError, match=r"no place of the skin is 500.0 mm from its edge"):
        gymnasium.make(MODULE + PRESS, sensor=pack, margin_mm=500.0)
    with pytest.raises(DesignError, match=r"goal 0 N is outside"):
        gymnasium.make(MODULE + PRESS, sensor=pack, goals_N=(0.0, 1.0))
    with pytest.raises(DesignError, match=r"goals from 2 to 1 mm"):
        gymnasium.make(MODULE + SLIDE, sensor=pack, goals_mm=(2.0, 1.0))
