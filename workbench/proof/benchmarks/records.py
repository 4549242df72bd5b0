"""Records of benchmarks: rows measured once on a machine, with its name and the date.

`workbench bench ROOM --record FILE` writes one, `workbench validate ROOM --record FILE` as well;
those in `workbench/proof/benchmarks/records` ship with the program and stand in reports beside what
is measured on the spot, those in `docs/validation` make the page `trust.md`. Each names the code of
its room: rows of other code are stale.
"""

from __future__ import annotations

import dataclasses
import json
import os
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workbench.core.base.errors import StoreError
from workbench.core.base.version import VERSION
from workbench.proof.row import Row
from workbench.system.record import Record

SHIPPED = Path(__file__).with_name("records")
FORMAT = 1
PARTS = {"format", "version", "made", "room", "device", "kind", "load", "rows"}
VOUCHED = {"command", "code", "sources"}
"""What records of before do not say."""


@dataclass(frozen=True, kw_only=True, slots=True)
class RoomRecord:
    """Rows of one room on one machine."""

    made: str
    """Date, as year-month-day."""
    version: str
    room: str
    device: str
    """Name of the GPU, or of the processor with its cores."""
    kind: str
    """`cuda` or `cpu`."""
    load: float
    """Processes that wanted to run in the minute before the end; the measured one included."""
    rows: tuple[Mapping[str, Any], ...]
    kept: Record
    """The file, and the code that it rests on."""

    @property
    def title(self) -> str:
        """Device, date, and how busy it was."""
        return f"{self.device}, {self.made}, load {self.load:.1f}"

    def value(self, name: str) -> float | None:
        """Value of the first row of that name, None without one."""
        return next((row["value"] for row in self.rows if row["name"] == name), None)


def device_name(kind: str) -> str:
    """What computes here, in words; imports torch for a GPU."""
    if kind == "cuda":
        import torch

        return torch.cuda.get_device_name(0)
    return f"{_processor()}, {os.cpu_count()} cores"


def _processor() -> str:
    """Name of the processor, as far as the system tells."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in text.splitlines() if "model name" in line]
    return names[0] if names else platform.machine()


def load() -> float:
    """Processes that wanted to run in the last minute; NaN where the system does not tell."""
    return os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")


def kept_at(path: Path, command: str, sources: Sequence[str]) -> Record:
    """The record of rows at a place, which need not be there yet.

    Args:
        path: Of the file.
        command: What measures the rows.
        sources: Modules whose functions give them.
    """
    return Record(path=path, command=command, sources=tuple(sources))


def write_record(kept: Record, room: str, rows: Callable[[], Sequence[Row]]) -> Sequence[Row]:
    """Measure rows and keep them.

    Raises:
        StoreError: If the file cannot be written.
    """
    found: list[Row] = []
    kept.make(lambda: _measured(kept, room, found, rows))
    return found


def _measured(
    kept: Record, room: str, found: list[Row], rows: Callable[[], Sequence[Row]]
) -> dict[str, Any]:
    from workbench.pipeline.devices import chosen_device

    found += rows()
    kind = chosen_device()
    return {
        "format": FORMAT,
        "version": VERSION,
        "room": room,
        "device": device_name(kind),
        "kind": kind,
        "load": round(load(), 2),
        "sources": list(kept.sources),
        "rows": [dataclasses.asdict(row) for row in found],
    }


def read_record(path: Path) -> RoomRecord:
    """Read a record.

    Raises:
        StoreError: If there is none, or it is not one of this program.
    """
    try:
        table = json.loads(path.read_bytes())
        if set(table) - VOUCHED != PARTS or table["format"] != FORMAT:
            raise ValueError(f"it holds {', '.join(sorted(table))}")
        fields = {name: table[name] for name in PARTS - {"format", "rows"}}
        if not all({"name", "value"} <= set(row) for row in table["rows"]):
            raise ValueError("a row has no name or no value")
        command = table.get("command", f"workbench bench {table['room']} --record FILE")
        kept = kept_at(path, command, table.get("sources", ()))
        return RoomRecord(**fields, rows=tuple(table["rows"]), kept=kept)
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise StoreError(
            f"the record {path} cannot be read: {error}",
            hint="make it again with workbench bench ROOM --record FILE",
            at=str(path),
        ) from error


def shipped_records(folder: Path = SHIPPED) -> list[RoomRecord]:
    """All records that came with the program, by name of their file.

    Raises:
        StoreError: If one of them is damaged.
    """
    return [read_record(path) for path in sorted(folder.glob("*.json"))]
