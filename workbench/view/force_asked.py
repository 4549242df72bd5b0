"""At which depth a press reaches a force, and how much of the soft wall is left there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.view.frame_words import number

NEAR_SHARE = 0.75
"""Of the wall pressed in, beyond which it is said to be near the support: our choice."""


@dataclass(frozen=True, kw_only=True, slots=True)
class WayIn:
    """Force over depth while the object goes in, from first touch on."""

    depth_mm: np.ndarray
    """From 0 on, rising, shape (N,)."""
    force_N: np.ndarray
    """Along the inward normal, shape (N,)."""
    wall_mm: float | None = None
    """Elastomer over the support; None where something else lies behind the skin."""

    def depth_at(self, force_N: float) -> float | None:
        """Depth [mm] at which a force is first reached, between frames by a line; None: never."""
        reached = np.flatnonzero(self.force_N >= force_N)
        if not len(reached):
            return None
        k = int(reached[0])
        if k == 0:
            return float(self.depth_mm[0])
        low, high = self.force_N[k - 1], self.force_N[k]
        share = (force_N - low) / (high - low)
        return float(self.depth_mm[k - 1] + share * (self.depth_mm[k] - self.depth_mm[k - 1]))

    def words(self, force_N: float) -> str:
        """What a designer reads of a force."""
        depth_mm = self.depth_at(force_N)
        if depth_mm is not None:
            reached = f"{number(force_N)} N is reached at **{number(depth_mm)} mm**"
            return f"{reached}; {self.wall_words(depth_mm)}" if self.wall_mm else f"{reached}."
        most = f"{number(float(self.force_N.max()))} N at {number(float(self.depth_mm[-1]))} mm"
        return f"Not reached: the press ends with {most}. A larger *Depth mm* goes on."

    def wall_words(self, depth_mm: float) -> str:
        """How much of the wall a depth of the object leaves, Markdown."""
        if not self.wall_mm:
            return ""
        left_mm, share = self.wall_mm - depth_mm, depth_mm / self.wall_mm
        if left_mm <= 0.0:
            return f"**through all of the {number(self.wall_mm)} mm of elastomer**: it bottoms out."
        text = f"{number(left_mm)} of {number(self.wall_mm)} mm of elastomer are left"
        return f"**{text}: near the support**." if share > NEAR_SHARE else f"{text}."
