"""Rows of a room, measured and printed."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.units import human_seconds
from workbench.system.terminal import complain, say

if TYPE_CHECKING:
    from workbench.proof.row import Row

Rows = Callable[[], "Sequence[Row]"]
Judged = Callable[["Sequence[Row]"], "Sequence[Row]"]


def print_rows(
    options: argparse.Namespace, rooms: dict[str, Any], *, judged: Judged | None = None
) -> int:
    """Measure a room; 1 where a row is not ok.

    Args:
        options: The room, `json`, and `record`, where the rows are kept.
        rooms: Functions that give rows, by the name of the room.
        judged: Tells what each row is judged by.

    Raises:
        DesignError: If there is no such room.
        StoreError: If the rows cannot be kept.
    """
    from workbench.proof.row import as_json, as_text, gathered, listening

    started = time.monotonic()

    def heard(row: Row) -> None:
        state = "ok" if row.ok else "STALE" if row.stale else "FAIL"
        complain(f"{state:4} {row.name} after {human_seconds(time.monotonic() - started)}")

    expect_room(options.room, rooms)
    measure = rooms[options.room]

    def measured() -> Sequence[Row]:
        found = gathered(options.room, measure)
        return found if judged is None else judged(found)

    with listening(heard):
        rows = measured() if options.record is None else _kept(options, measure, measured)
    say(as_json(rows) if options.json else as_text(rows))
    return 0 if all(row.ok for row in rows) else 1


def expect_room(room: str, rooms: Mapping[str, Any]) -> None:
    """Refuse what is no room.

    Raises:
        DesignError: Naming the nearest.
    """
    from workbench.core.base.mapping import suggest

    if room not in rooms:
        raise DesignError(f"there is no room {shown(room)}", hint=suggest(room, rooms), at="room")


def _kept(options: argparse.Namespace, measure: Any, measured: Rows) -> Sequence[Row]:
    """Rows that are measured and kept, with the code of the function that gives them."""
    from workbench.proof.benchmarks.records import kept_at, write_record

    command = f"workbench {options.command} {options.room} --record FILE"
    source = getattr(measure, "func", measure).__module__
    return write_record(kept_at(options.record, command, [source]), options.room, measured)
