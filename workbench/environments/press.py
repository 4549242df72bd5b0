"""Press until a force is reached, and not beyond it.

Each step costs how far the normal force is from the goal, as a share of it and of the episode:
-min(1, |F - F0| / F0) / MOST_STEPS, so that a whole episode costs 1 at most. The episode ends with
+1 once the force was within `CLOSE` of the goal for `HELD` steps, and with -1 where it is `OVER`
above the goal: too much is never better than nothing.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Unpack

import numpy as np

from workbench.environments import MOST_STEPS
from workbench.environments.touching import MOST_N, Seen, TouchEnv, Touching, checked_goals

CLOSE, OVER = 0.05, 0.2
"""Shares of the goal."""
HELD = 3
ABOVE_MM = 0.1
"""The object begins so far above the skin."""


class PressEnv(TouchEnv):
    """`WorkbenchPress-v0`; the goal is a normal force [N]."""

    def __init__(
        self,
        sensor: Path | str = "geltip",
        *,
        goals_N: tuple[float, float] = (0.2, 1.0),
        render_mode: str | None = None,
        **options: Unpack[Touching],
    ) -> None:
        """As `TouchEnv`.

        Args:
            sensor: See there.
            goals_N: The goal is drawn evenly from these.
            render_mode: See there.
            options: See there.
        """
        super().__init__(sensor, render_mode=render_mode, **options)
        self._goals_N = checked_goals(goals_N, MOST_N, "N")
        self._goal_N = self._goals_N[0]
        self._held = 0

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Seen, dict[str, Any]]:
        """Another place and another goal, the object just above the skin."""
        super().reset(seed=seed, options=options)
        self.set_object(ABOVE_MM)
        self._goal_N = float(self.np_random.uniform(*self._goals_N))
        self._held = 0
        self.move(np.zeros(3))
        return self.seen(self._goal_N), self.told()

    def step(self, action: np.ndarray) -> tuple[Seen, float, bool, bool, dict[str, Any]]:
        """Move the object by `action` along u, v, n [mm]."""
        self.move(action)
        off = float(self.force_N[2]) / self._goal_N - 1.0
        self._held = self._held + 1 if abs(off) <= CLOSE else 0
        reward = -min(1.0, abs(off)) / MOST_STEPS
        over, done = off > OVER, self._held >= HELD
        told = {**self.told(), "is_success": done}
        return self.seen(self._goal_N), reward + done - over, over or done, False, told
