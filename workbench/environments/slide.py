"""Carry a touched skin along without letting it slip.

The object stands `depth_mm` in the skin and is to go `goals_mm` along u. Dragged as it stands it
would slide; pressed deeper, friction holds it farther. The episode ends with +1 there, and with -1
where all of the contact slides (`sim.forces.slip.GROSS_SHARE`), where it is lost, or where the
normal force exceeds `most_N`. On the way a step earns its share of the goal.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, TypedDict, Unpack

import numpy as np

from sim.forces.slip import GROSS_SHARE
from workbench.core.base.check import within
from workbench.environments.touching import MOST_MM, MOST_N, Seen, TouchEnv, Touching, checked_goals


class Sliding(Touching, TypedDict, total=False):
    """What this environment takes."""

    depth_mm: float
    """How deep the object begins; .3 mm by default."""
    goals_mm: tuple[float, float]
    """The way is drawn evenly from these; .4 to .6 mm by default."""
    most_N: float
    """Normal force that is too much; 2 N by default."""


class SlideEnv(TouchEnv):
    """`WorkbenchSlide-v0`; the goal is a way along u [mm]."""

    def __init__(
        self,
        sensor: Path | str = "geltip",
        *,
        render_mode: str | None = None,
        **options: Unpack[Sliding],
    ) -> None:
        """As `TouchEnv`, with the options of `Sliding`."""
        depth_mm, most_N = options.pop("depth_mm", 0.3), options.pop("most_N", 2.0)
        goals_mm = options.pop("goals_mm", (0.4, 0.6))
        self._depth_mm = within(depth_mm, 0.05, 5.0, what="depth", unit="mm", at="depth_mm")
        self._most_N = within(most_N, 1e-3, MOST_N, what="force", unit="N", at="most_N")
        self._goals_mm = checked_goals(goals_mm, MOST_MM, "mm")
        super().__init__(sensor, render_mode=render_mode, **options)
        self._goal_mm = self._goals_mm[0]

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Seen, dict[str, Any]]:
        """Another place and another way, the object pressed in."""
        super().reset(seed=seed, options=options)
        self.set_object(0.0)
        self._goal_mm = float(self.np_random.uniform(*self._goals_mm))
        steps = int(np.ceil(self._depth_mm / self.step_mm))
        for _ in range(steps):
            self.feel(np.array([0.0, 0.0, -self._depth_mm / steps]))
        self.move(np.zeros(3))
        return self.seen(self._goal_mm), self.told()

    def step(self, action: np.ndarray) -> tuple[Seen, float, bool, bool, dict[str, Any]]:
        """Move the object by `action` along u, v, n [mm]."""
        before_mm = self.way_mm[0]
        frame = self.move(action)
        pressed_N = float(self.force_N[2])
        lost = frame.slip[0] >= GROSS_SHARE or not 0.0 < pressed_N <= self._most_N
        done = not lost and self.way_mm[0] >= self._goal_mm
        reward = float(self.way_mm[0] - before_mm) / self._goal_mm
        told = {**self.told(), "is_success": bool(done)}
        return self.seen(self._goal_mm), reward + done - lost, bool(lost or done), False, told
