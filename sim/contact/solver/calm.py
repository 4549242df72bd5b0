"""Whether reactions have stopped changing: within the last looks, not only since the last one."""

from __future__ import annotations

import numpy as np

LOOKS = 8
"""Looks over which a reaction that is read must not have changed: from one to the next it does not
either where it turns round. Within 4 a cube 1 mm deep on the tip, in ten frames, read .6 % more
than where it comes to rest; within 8 nothing, for 22 (ball) to 44 % more substeps."""
PASSING_LOOKS = 4
"""The same of a state within a frame."""
FORCE_CHANGE = 5e-4
"""Largest relative change of the reaction of a settled frame within `LOOKS` looks."""
PASSING = 3.0
"""How far a state within a frame may be from balance, in limits of a settled frame: nothing is
read from it but what holds on. A ball 1 mm deep at mu .3 then reads .1 % less than with 1, at 10
.4 % less."""
PASSING_SUBSTEPS = 60
"""Substeps after which a state within a frame is left, settled or not. A ball and a cube 1 mm deep
at mu .3 and 1, sheared or not, then read at most .3 % another force in 1 frame than in 10; with 5 a
sheared ball reads .8 % less. In one frame a ball takes three quarters of the substeps that it does
with 1000, a cube 8 % more."""
PASSING_SUBSTEPS_SOFT = 1000
"""The same of two soft bodies and of driven regions: friction of a soft ball .5 mm deep at mu .3
read 13 % more in 1 frame than in 5 where it was left after 300, and 5 % after 1000."""
ENOUGH = 1000
"""Substeps from which a reaction at the end of a frame may hum."""
WIDE = 20
"""Looks over which a reaction is averaged that rounding keeps from coming to rest."""
HUM = 5e-3
"""Largest swing about such an average, over the reaction."""


class Changes:
    """Reactions of B presses at their last looks."""

    def __init__(self, count: int) -> None:
        self._before_N = np.full((2 * WIDE, count, 3), np.inf)

    def begin(self, case: int) -> None:
        """Forget what was seen of a press."""
        self._before_N[:, case] = np.inf

    def within(self, looks: int, reaction_N: np.ndarray) -> np.ndarray:
        """Largest change since so many looks ago [N], shape (B,); infinite before so many.

        Args:
            looks: How many, up to `2 * WIDE`.
            reaction_N: Reactions at this look, shape (B, 3), not yet kept.
        """
        return np.linalg.norm(reaction_N - self._before_N[:looks], axis=2).max(axis=0)

    def keep(self, reaction_N: np.ndarray, looked: np.ndarray) -> None:
        """Keep the reactions of this look, (B, 3), of the presses that are looked at, (B,) bool."""
        self._before_N[:, looked] = np.roll(self._before_N, 1, axis=0)[:, looked]
        self._before_N[0, looked] = reaction_N[looked]

    def rest(self, change: np.ndarray, spent: np.ndarray, load_N: np.ndarray) -> np.ndarray:
        """Whether reactions have come to rest, or hum long since, shape (B,), bool.

        Args:
            change: Within `LOOKS`, over the load, shape (B,).
            spent: Substeps since the object stands, shape (B,).
            load_N: What changes are measured against [N], shape (B,).
        """
        late = spent >= ENOUGH
        still = change < FORCE_CHANGE
        return still | late & self.hums(load_N) if late.any() else still

    def hums(self, load_N: np.ndarray) -> np.ndarray:
        """Whether reactions only swing a little about an average that stays, shape (B,), bool.

        In single precision they may do so for ever: a flat end of 11 mm, .1 mm deep on gel, by .3 %
        of .06 N, which 6000 substeps did not calm.

        Args:
            load_N: What changes are measured against [N], shape (B,).
        """
        with np.errstate(invalid="ignore"):
            newer_N, older_N = (
                self._before_N[:WIDE].mean(axis=0),
                self._before_N[WIDE:].mean(axis=0),
            )
            drift_N = np.linalg.norm(newer_N - older_N, axis=1)
            swing_N = np.linalg.norm(self._before_N - newer_N, axis=2).max(axis=0)
        return (drift_N < FORCE_CHANGE * load_N) & (swing_N < HUM * load_N)
