"""Rows of a room, measured and printed."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.units import human_seconds
from workbench.system.terminal import complain, say


def print_rows(
    options: argparse.Namespace, rooms: dict[str, Any], *, record: Path | None = None
) -> int:
    """Measure a room; 1 where a row is not ok."""
    from workbench.core.base.mapping import suggest
    from workbench.proof.row import Row, as_json, as_text, gathered, listening

    started = time.monotonic()

    def heard(row: Row) -> None:
        state = "ok" if row.ok else "FAIL"
        complain(f"{state:4} {row.name} after {human_seconds(time.monotonic() - started)}")

    if options.room not in rooms:
        raise DesignError(
            f"there is no room {shown(options.room)}", hint=suggest(options.room, rooms), at="room"
        )
    with listening(heard):
        rows = gathered(options.room, rooms[options.room])
    if record is not None:
        from workbench.proof.benchmarks.records import write_record

        write_record(record, options.room, rows)
    say(as_json(rows) if options.json else as_text(rows))
    return 0 if all(row.ok for row in rows) else 1
