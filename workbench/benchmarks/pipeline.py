"""The whole chain as a user runs it: cold, warm, after a camera move; server start; cancel."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from workbench.core.design import Layers
from workbench.core.errors import Cancelled
from workbench.rows import Row, bounded
from workbench.stages import Call
from workbench.store import Store

DESIGN = 'name = "bench"\nfamily = "finger"\n[optics.camera]\nfov_x_deg = {fov}\n'


def rows() -> list[Row]:
    """All rows of the room."""
    with tempfile.TemporaryDirectory() as text:
        folder = Path(text)
        cold_s, _ = _run(folder, fov=100.0)
        warm_s, stages = _run(folder, fov=100.0)
        moved_s, after_move = _run(folder, fov=90.0)
    redone = [stage for stage, cached in after_move.items() if not cached]
    return [
        bounded("demo", "cold, all stages", cold_s, unit="s", limit=120.0),
        bounded("demo", "nothing changed", warm_s, unit="s", limit=15.0),
        bounded("demo", "camera moved", moved_s, unit="s", limit=30.0),
        bounded(
            "cached_stages",
            "nothing changed",
            float(sum(stages.values())),
            unit="1",
            limit=len(stages),
            sense="min",
        ),
        bounded(
            "rerun_stages",
            f"camera moved: {', '.join(redone)}",
            float(len(redone)),
            unit="1",
            limit=1.0,
        ),
        bounded("cancel", "inside a call that does not listen", _cancel_s(), unit="s", limit=3.0),
    ]


def _run(folder: Path, *, fov: float) -> tuple[float, dict[str, bool]]:
    design = folder / "bench.toml"
    design.write_text(DESIGN.format(fov=fov))
    command = [sys.executable, "-m", "workbench.cli", "run", str(design)]
    command += ["--project", str(folder / "project"), "--out", str(folder / "out")]
    start = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True, env=os.environ)
    seconds = time.perf_counter() - start
    summary = json.loads((folder / "out" / "summary.json").read_text())
    return seconds, {s["stage"]: s["cached"] for s in summary["stages"]}


def _cancel_s() -> float:
    """Time from a cancel to its return while the worker is deaf and has to be killed [s]."""
    from workbench.lanes import Lane

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

    return Call("build", ("finger", resolve_shape("finger", {}), Layers()))
