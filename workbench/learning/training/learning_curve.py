"""What more data buy: the same training on growing shares of the training cases.

Each share takes the first cases of the balanced order, goes through them the more often the fewer
they are, so that all trainings take as many steps, and is measured on the same other cases. Each is
a training in a folder of its own, so a curve that was stopped goes on where it was.
"""

from __future__ import annotations

import dataclasses
import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from workbench.core.base.check import within
from workbench.core.base.monitor import Monitor, silent
from workbench.learning.dataset.cases import Split
from workbench.learning.training.chart import Series, chart
from workbench.learning.training.learn import train
from workbench.learning.training.plan import Plan, Resources, Tell
from workbench.learning.training.presses import Presses
from workbench.system.whole_files import write_atomically

JSON, PNG = "learning_curve.json", "learning_curve.png"


def learning_curve(
    presses: Presses,
    plan: Plan,
    fractions: Sequence[float],
    out: Path,
    *,
    resources: Resources,
    tell: Tell = lambda progress: None,
    monitor: Monitor = silent,
) -> dict[str, Any]:
    """Train on each share and write `learning_curve.json` and `.png`.

    Args:
        presses: The data.
        plan: What is trained how, on all cases.
        fractions: Shares of the training cases, in (0, 1].
        out: Folder of the curve.
        resources: Of all of it: the time is shared evenly by what is left to do.
        tell: Told after each epoch.
        monitor: Told within an epoch; may raise.

    Raises:
        As `train`.
    """
    for fraction in fractions:
        within(fraction, 1e-6, 1.0, what="share", unit="", at="--fractions")
    every = len(presses.cases(Split.TRAIN))
    counts = sorted({max(1, round(fraction * every)) for fraction in fractions})
    began_s, rows = time.monotonic(), []
    whole = len(dataclasses.replace(plan, cases=0).states(presses))
    for number, cases in enumerate(counts):
        samples = len(dataclasses.replace(plan, cases=cases).states(presses))
        passes = max(1, round(plan.settings.passes * whole / samples))
        settings = dataclasses.replace(plan.settings, passes=passes)
        left = resources.minutes - (time.monotonic() - began_s) / 60.0
        share = max(left, 1e-3) / (len(counts) - number) if resources.minutes else 0.0
        done = train(
            presses,
            dataclasses.replace(plan, settings=settings, cases=cases),
            out / f"cases{cases:04d}",
            resources=dataclasses.replace(resources, minutes=share),
            tell=tell,
            monitor=monitor,
        )
        rows.append(
            {
                "cases": cases,
                "samples": samples,
                "fraction": cases / every,
                "epochs": len(done.rows),
                "best_epoch": done.best_epoch,
                "finished": done.finished,
                "weights": str(done.weights.relative_to(out)),
                "scores": done.scores,
            }
        )
        found = {"target": plan.target.value, "preset": plan.settings.name, "rows": rows}
        write_atomically(out / JSON, json.dumps(found, indent=1).encode())
    _draw(out, rows)
    return {"target": plan.target.value, "preset": plan.settings.name, "rows": rows}


def _draw(out: Path, rows: Sequence[dict[str, Any]]) -> None:
    """Errors over that of the zero predictor, split by split; left out where OpenCV is missing."""
    flat = []
    for row in rows:
        own: dict[str, float] = {"cases": row["cases"]}
        for split, found in row["scores"].items():
            if found["zero_mae"]:
                own[split] = found["mae"] / found["zero_mae"]
                own[f"mpm {split}"] = (found["mpm_mae"] or 0.0) / found["zero_mae"]
        flat.append(own)
    names = [split.value for split in Split if split is not Split.TRAIN]
    series = [Series.of(name, flat, "cases", name) for name in names]
    series += [Series.of(f"solver, {n}", flat, "cases", f"mpm {n}", reference=True) for n in names]
    series = [each for each in series if each.points]
    if not series:
        return
    try:
        from workbench.report.image_files import png_bytes

        drawn_png = png_bytes(chart(series, "Error over the zero predictor's, by training cases"))
    except ImportError:
        return
    write_atomically(out / PNG, drawn_png)
