"""The whole chain as a user runs it: cold, warm, after a camera move; server start; cancel."""

from __future__ import annotations

import dataclasses
import functools
import json
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path

from workbench.core.base.errors import Cancelled, WorkbenchError
from workbench.core.design.design import Layers
from workbench.pipeline.stage import Call
from workbench.pipeline.stages import build
from workbench.pipeline.store import Store
from workbench.proof.row import Row, bounded

DESIGN = 'name = "bench"\nfamily = "finger"\n[optics.camera]\nfov_x_deg = {fov}\n'
STEPS = {"cold": 100.0, "warm": 100.0, "moved": 90.0}
"""Horizontal field of view of each run [degree]."""


def rows() -> list[Row]:
    """All rows of the room."""
    with tempfile.TemporaryDirectory() as text:
        # Asked for in this order, each run once: the later ones find what the first one stored.
        step = functools.cache(lambda name: _run(Path(text), fov=STEPS[name]))
        return [
            bounded("demo", "cold, all stages", lambda: step("cold")[0], unit="s", limit=120.0),
            bounded("demo", "nothing changed", lambda: step("warm")[0], unit="s", limit=15.0),
            bounded("demo", "camera moved", lambda: step("moved")[0], unit="s", limit=30.0),
            bounded(
                "cached_stages",
                "nothing changed, share of all stages",
                lambda: statistics.mean(step("warm")[1].values()),
                unit="1",
                limit=1.0,
                sense="min",
            ),
            rerun_row(lambda: step("moved")[1]),
            bounded("cancel", "inside a call that does not listen", _cancel_s, unit="s", limit=3.0),
        ]


def rerun_row(cached: Callable[[], Mapping[str, bool]]) -> Row:
    """Stages that a camera move ran again: passes for exactly `shoot`, not for any other one."""
    redone: list[str] = []

    def count() -> float:
        redone.extend(stage for stage, found in cached().items() if not found)
        return float(len(redone))

    row = bounded("rerun_stages", "camera moved, shoot and no other", count, unit="1", limit=1.0)
    return dataclasses.replace(row, ok=row.ok and redone == ["shoot"])


def _run(folder: Path, *, fov: float) -> tuple[float, dict[str, bool]]:
    design = folder / "bench.toml"
    design.write_text(DESIGN.format(fov=fov), encoding="utf-8")
    command = [sys.executable, "-m", "workbench.cli", "run", str(design)]
    command += ["--project", str(folder / "project"), "--out", str(folder / "out")]
    start = time.perf_counter()
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    seconds = time.perf_counter() - start
    if done.returncode:
        raise WorkbenchError(f"workbench run exited with {done.returncode}: {done.stderr[-300:]}")
    summary = json.loads((folder / "out" / "summary.json").read_text(encoding="utf-8"))
    return seconds, {s["stage"]: s["cached"] for s in summary["stages"]}


def _cancel_s() -> float:
    """Time from a cancel to its return while the worker is deaf and has to be killed [s]."""
    from workbench.live.lanes import Lane

    asked = 0.0

    def monitor(fraction: float, note: str = "") -> None:
        nonlocal asked
        asked = time.perf_counter()
        raise Cancelled("bench")

    with tempfile.TemporaryDirectory() as folder:
        lane = Lane("cad", Store(folder))
        try:
            lane.run(_deaf_call(), monitor)
        except Cancelled:
            return time.perf_counter() - asked
        finally:
            lane.close()
    raise RuntimeError("the call was not cancelled")


def _deaf_call() -> Call:
    """A call to a worker that still imports for seconds: it cannot listen either."""
    from designs.family import resolve_shape

    return build.STAGE.call(
        build.BuildInputs(family="finger", shape=resolve_shape("finger", {}), layers=Layers())
    )
