"""A scheduler that is lost: Dask cancels then what it had in hand."""

from __future__ import annotations

from workbench.core.base.errors import LaneError


def scheduler_lost(at: str) -> LaneError:
    """The error that says so.

    Args:
        at: The stage that ran, or the option.
    """
    return LaneError(
        "the cluster's scheduler was lost",
        hint="start it again with its workers, and run the same again: it goes on from what is "
        "kept",
        at=at,
    )
