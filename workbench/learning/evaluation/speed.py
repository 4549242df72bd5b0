"""The efficiency table: the paper's frame rates beside ours, measured here and on record."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from typing import Any

from workbench.core.base.monitor import Monitor, silent
from workbench.proof.benchmarks.paces import ALL, GPU
from workbench.proof.benchmarks.records import RoomRecord, device_name, load, shipped_records


def measured_here(monitor: Monitor = silent) -> dict[str, float]:
    """Frame rates of the network on this machine, by row of the room `efficiency` [1/s]."""
    from workbench.proof.benchmarks.efficiency import NETWORK
    from workbench.proof.benchmarks.forces import SIZES, paces

    found = {}
    for number, pace in enumerate(paces(NETWORK)):
        found[f"network_{pace.name}"] = pace.fps
        monitor((number + 1) / len(SIZES), f"network at {pace.name}")
    return found


def efficiency(here: Mapping[str, float], records: Sequence[RoomRecord] | None = None) -> Any:
    """The table as plain data: a row per rate, a column per machine.

    Args:
        here: What was measured on the spot, by row.
        records: Made with `workbench bench`; None: those that ship.

    Raises:
        StoreError: If a record is damaged.
    """
    records = shipped_records() if records is None else records
    from workbench.pipeline.devices import torch_device

    now = f"here, now: {device_name(torch_device())}, load {load():.1f}"
    columns = [f"paper: {GPU}", now, *(record.title for record in records)]
    rows = [
        {
            "what": pace.what,
            "size": pace.size,
            "frame": pace.meaning,
            "row": pace.row,
            "fps": [pace.fps, here.get(pace.row), *(one.value(pace.row) for one in records)],
        }
        for pace in ALL
    ]
    return {"machines": columns, "rows": rows}


def efficiency_html(table: Mapping[str, Any]) -> str:
    """The table for the report; what was not measured is a dash."""
    heads = "".join(f"<th>{html.escape(name)} [1/s]</th>" for name in table["machines"])
    body = "".join(
        f"<tr><td>{row['what']}, {row['size']}</td><td>{row['frame']}</td>"
        + "".join(f"<td class='n'>{_number(value)}</td>" for value in row["fps"])
        + "</tr>"
        for row in table["rows"]
    )
    return f"<table><tr><th></th><th>a frame is</th>{heads}</tr>{body}</table>"


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.3g}" if value < 100 else f"{value:,.0f}"
