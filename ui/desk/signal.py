"""Signals: what one part of the front tells, without knowing who follows it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, ParamSpec

P = ParamSpec("P")


class Signal(Generic[P]):
    """Calls its followers, in the order in which they were connected."""

    def __init__(self) -> None:
        self._followers: list[Callable[P, object]] = []

    def connect(self, follower: Callable[P, object]) -> None:
        """Call `follower` each time from now on."""
        self._followers.append(follower)

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> None:
        """Tell all followers; what one raises reaches the caller and ends the round."""
        for follower in self._followers:
            follower(*args, **kwargs)
