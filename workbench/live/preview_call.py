"""What a lane is asked for and does not store: a preview, which the next edit makes worthless.

A `PreviewCall` is to a preview what `workbench.pipeline.stage.Call` is to a stored result: it names
its inputs and is small to send. Its answer travels through the pipe of the lane as it is.
"""

from __future__ import annotations

from typing import Any, Protocol

from workbench.core.base.monitor import Monitor
from workbench.pipeline.store import Store


class PreviewCall(Protocol):
    """One preview; implementations are frozen dataclasses that can be pickled."""

    @property
    def lane(self) -> str:
        """The worker that answers it."""
        ...

    @property
    def stage(self) -> str:
        """What messages call it."""
        ...

    @property
    def needs(self) -> tuple[str, ...]:
        """Stages that must be stored before it can be answered."""
        ...

    def answer(self, store: Store, kept: dict[str, Any], monitor: Monitor) -> Any:
        """Compute the preview; runs in the lane.

        Args:
            store: Where the inputs are.
            kept: What this process remembers from one preview to the next, by name.
            monitor: Progress and cancellation.

        Raises:
            WorkbenchError: Whatever computing it raises.
        """
        ...


class OwnCall:
    """Base of a call that computes and stores what it needs by itself, beside simulations."""

    __slots__ = ()

    @property
    def lane(self) -> str:
        """The worker that answers it."""
        return "sim"

    @property
    def needs(self) -> tuple[str, ...]:
        """No stage before it."""
        return ()
