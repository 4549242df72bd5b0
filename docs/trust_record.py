"""Keep what a room of `workbench validate` measured, for the page `trust.md`.

    workbench validate contact --json > rows.json
    python -m docs.trust_record contact rows.json

writes `docs/validation/contact.json`, with this machine's name and the date; rows that failed too.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from workbench.proof.benchmarks.records import Record, read_record, write_record
from workbench.proof.row import Row

FOLDER = Path(__file__).parent / "validation"


def records() -> list[Record]:
    """What was kept, room by room."""
    return [read_record(path) for path in sorted(FOLDER.glob("*.json"))]


def main(room: str, rows: str) -> None:
    """Keep the rows of a file for a room."""
    FOLDER.mkdir(exist_ok=True)
    found = [Row(**row) for row in json.loads(Path(rows).read_bytes())]
    write_record(FOLDER / f"{room}.json", room, found)


if __name__ == "__main__":
    main(*sys.argv[1:])
