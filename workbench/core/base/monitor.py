"""Progress and cancellation, handed to every stage as one callable.

A stage calls `monitor(fraction, note)` at least every 100 ms where it can; the call raises
`Cancelled` when the user pressed Cancel. Code that has no caller to report to uses `silent`.
"""

from __future__ import annotations

from typing import Protocol

LEAST_FRACTION = 0.02
"""Share of the work below which its pace says nothing."""


class Monitor(Protocol):
    """Reports progress; raises `Cancelled` when the work should stop."""

    def __call__(self, fraction: float, note: str = "") -> None:
        """Report that `fraction` in [0, 1] of the work is done."""
        ...


def silent(fraction: float, note: str = "") -> None:
    """A monitor that nobody watches."""


def seconds_left(elapsed_s: float, fraction: float) -> float | None:
    """Time that remains at the pace so far [s]; None while too little is done to tell."""
    return elapsed_s * (1 - fraction) / fraction if fraction > LEAST_FRACTION else None


def part(monitor: Monitor, start: float, stop: float) -> Monitor:
    """A monitor whose 0..1 maps to `start`..`stop` of another one."""

    def scaled(fraction: float, note: str = "") -> None:
        monitor(start + (stop - start) * fraction, note)

    return scaled
