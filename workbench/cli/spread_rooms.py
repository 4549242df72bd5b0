"""Several rooms of the validation, one after the other here or side by side on a cluster."""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from workbench.cli.cluster_option import open_cluster
from workbench.cli.validate_rooms import ROOMS, with_data
from workbench.core.base.errors import DesignError
from workbench.core.base.units import human_seconds
from workbench.project.project import Project
from workbench.proof.judge import judged
from workbench.proof.row import Row, as_json, as_text, failed, gathered
from workbench.system.terminal import Progress, complain, say

if TYPE_CHECKING:
    from workbench.cluster.opening import Cluster


def print_rooms(options: argparse.Namespace, rooms: Sequence[str], project: Project) -> int:
    """Measure rooms, each in one piece, and print them as asked; 1 where a row is not ok.

    Raises:
        DesignError: If rows were to be kept, or there is no such cluster.
        LaneError: If no worker comes, or the scheduler is lost.
    """
    if options.record is not None:
        raise DesignError(
            "a record keeps one room, measured by this machine",
            hint="name one room, without --cluster",
            at="--record",
        )
    found: dict[str, Sequence[Row]] = {}
    started = time.monotonic()
    printer = Progress(as_json=options.json)
    with open_cluster(options.cluster, project.store, printer) as cluster:
        for room, rows in _measured(rooms, options.data, cluster):
            found[room] = rows
            bad = sum(not row.ok for row in rows)
            after = human_seconds(time.monotonic() - started)
            told = f"{room}: {len(rows)} rows, {bad} not ok, after {after}"
            complain(f"{len(found)} of {len(rooms)}: {told}")
    if options.json:
        lines = [line for room in rooms for line in json.loads(as_json(found[room]))]
        say(json.dumps(lines, indent=1))
    else:
        say("\n\n".join(f"{room}\n{as_text(found[room])}" for room in rooms))
    return 0 if all(row.ok for rows in found.values() for row in rows) else 1


def measured_room(room: str, data: Path | None = None) -> list[Row]:
    """All rows of a room, also by a worker that is told no more than its name."""
    rooms = ROOMS if data is None else with_data(room, data)
    return judged(gathered(room, rooms[room]))


def _measured(
    rooms: Sequence[str], data: Path | None, cluster: Cluster | None
) -> Iterator[tuple[str, Sequence[Row]]]:
    """Each room with its rows, as they end."""
    if cluster is None:
        yield from ((room, measured_room(room, data)) for room in rooms)
        return
    from distributed import KilledWorker, as_completed

    futures = {cluster.client.submit(measured_room, room, data, pure=False): room for room in rooms}
    for future in as_completed(futures, loop=cluster.client.loop):
        room = futures[future]
        try:
            yield room, future.result()
        except KilledWorker:
            yield room, [failed(room, "the whole room", why="its workers were lost")]
