"""What rooms of `workbench validate` measured, kept for the page `trust.md`.

    workbench validate contact --record docs/validation/contact.json

keeps the rows of a room with this machine's name, the date and the code that they rest on; rows
that failed too. Once that code is another, the page says so.
"""

from __future__ import annotations

from pathlib import Path

from workbench.proof.benchmarks.records import RoomRecord, read_record

FOLDER = Path(__file__).parent / "validation"


def records() -> list[RoomRecord]:
    """What was kept, room by room."""
    return [read_record(path) for path in sorted(FOLDER.glob("*.json"))]
