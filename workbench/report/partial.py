"""What a press that failed leaves in the folder of its run: the frames that settled.

Images, `contact.npz`, `forces.csv`, poses and VTK files hold those frames only; `summary.json` says
which frame failed and why. There is no report and no mould: the run has failed. What keeps them
from being written stands in the hint; why the press failed is what the designer must read first.

Of a press that was stopped by Ctrl-C there are arrays, tables and VTK files only, within a second.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from workbench.core.base.errors import SolveError, Stopped, WorkbenchError
from workbench.core.base.monitor import Monitor
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.pipeline.stage import Outcome, Ref
from workbench.pipeline.store import Store
from workbench.planning.plan import StageMonitor, plan, results, stage_monitor
from workbench.planning.running import PARTIAL, run
from workbench.report.fabrication_tables import plain_numbers
from workbench.report.image_files import write_images
from workbench.report.outputs import summary_table, write_press
from workbench.system.whole_files import write_atomically


@contextlib.contextmanager
def keeping_partial(
    out: Path,
    design: SensorDesign,
    case: PressCase,
    store: Store,
    outcomes: Sequence[Outcome],
    *,
    monitor: StageMonitor | None = None,
) -> Iterator[None]:
    """Write what settled before a press failed, say so in the error, and let it go on.

    Args:
        out: Folder of the run.
        design: The sensor.
        case: The press.
        store: Where the failed stage kept its frames.
        outcomes: Stages that are done.
        monitor: Told how far the images of the settled frames are.

    Raises:
        SolveError: That of the press, its message saying what was written, or its hint why not.
    """
    try:
        yield
    except SolveError as error:
        if error.kept:
            shooting = stage_monitor(monitor, "shoot")
            try:
                count = _write(out, design, case, store, outcomes, error, shooting)
            except WorkbenchError as unwritten:
                error.hint += f"; what settled was not written: {unwritten.message}"
            else:
                error.message += f"; {_settled(count, out)}"
        raise
    except Stopped as stopped:
        if stopped.kept:
            count = _write_arrays(out, design, case, store, stopped.kept)
            stopped.message += f"; {_settled(count, out)}"
        raise


def _settled(count: int, out: Path) -> str:
    if count == 1:
        return f"frame 1 settled and is in {out}"
    return f"frames 1 to {count} settled and are in {out}"


def _write_arrays(out: Path, design: SensorDesign, case: PressCase, store: Store, key: str) -> int:
    """Write what needs no rendering, for which there is no time; returns the count of frames."""
    contact = store.load(PARTIAL, key)
    load = results(store, plan(design, case), ("build", "mesh"))
    write_press(out, case.press, load["build"], load["mesh"], contact)
    return len(contact.reaction_N)


def _write(
    out: Path,
    design: SensorDesign,
    case: PressCase,
    store: Store,
    outcomes: Sequence[Outcome],
    error: SolveError,
    monitor: Monitor,
) -> int:
    """Write the settled frames; returns their count."""
    calls = plan(design, case)
    kept = Ref(stage=PARTIAL, key=error.kept)
    seen = calls["shoot"].reading(calls["press"].ref, kept)
    done = [*outcomes, run(store, seen, monitor)]
    contact, shot = store.load(PARTIAL, error.kept), store.load("shoot", seen.key)
    load = results(store, calls, ("build", "mesh"))
    write_press(out, case.press, load["build"], load["mesh"], contact)
    seconds = store.entry(PARTIAL, error.kept).seconds
    summary: dict[str, Any] = summary_table(design, case, contact, shot, seconds, done)
    summary["images"] = write_images(out, shot)
    summary["failed"] = {
        "stage": "press",
        "frame": error.frame + 1,
        "frames": case.press.frame_count,
        "settled": len(contact.reaction_N),
        "residual": error.residual,
        **error.as_dict(),
    }
    text = json.dumps(plain_numbers(summary), indent=1, allow_nan=False)
    write_atomically(out / "summary.json", text.encode())
    return len(contact.reaction_N)
