"""A training from data to weights: goes on from its checkpoint, stops early, writes what it found.

```
DIR/checkpoint.pt   all that it needs to go on, after every epoch
DIR/curves.*        a row per epoch: .jsonl, .csv, .png
DIR/training.json   what was trained on what, how far it is, scores, notes
DIR/NAME.weights    the network of the best epoch, with its data card
```

Weights are written when it ends, stops early, or its time is up; a training whose time was up goes
on when the same command is given again.
"""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.forces.network.weights import Storage
from workbench.core.base.freed_memory import freed_memory_kept
from workbench.core.base.monitor import Monitor, silent
from workbench.learning.dataset.cases import Split
from workbench.learning.dataset.lock import held
from workbench.learning.training.beginning import Beginning, begin
from workbench.learning.training.card import data_card, training_card
from workbench.learning.training.checkpoint import read_checkpoint, write_checkpoint
from workbench.learning.training.curves import write_chart, write_curves
from workbench.learning.training.plan import (
    Course,
    Plan,
    Resources,
    Tell,
    Trained,
    TrainingProgress,
)
from workbench.learning.training.presses import Presses
from workbench.learning.training.results import final_weights
from workbench.pipeline.weight_files import save_weights
from workbench.system.whole_files import write_atomically

if TYPE_CHECKING:
    from sim.forces.training.trainer import Trainer

SUMMARY = "training.json"
CHART_S = 10.0
"""Least time between two charts of the curves [s]."""


def train(
    presses: Presses,
    plan: Plan,
    out: Path,
    *,
    resources: Resources,
    tell: Tell = lambda progress: None,
    monitor: Monitor = silent,
) -> Trained:
    """Train, or go on where it was.

    Args:
        presses: The data.
        plan: What is trained how.
        out: Folder of the training.
        resources: Device, type of the arithmetic and time.
        tell: Told after each epoch.
        monitor: Told within an epoch; may raise.

    Raises:
        DesignError: If there is nothing to train on.
        StoreError: If the folder holds another training, or cannot be written.
        SolveError: If a field is not finite, or the loss becomes so; the last checkpoint is kept.
        DeviceError: If the device runs out of memory; the last checkpoint is kept.
    """
    with held(out, doing="training in"), freed_memory_kept():
        return _Training(presses, plan, out, resources, tell).run(monitor)


class _Training:
    """One training, while it runs."""

    def __init__(
        self, presses: Presses, plan: Plan, out: Path, resources: Resources, tell: Tell
    ) -> None:
        self.presses, self.plan, self.out, self.resources = presses, plan, out, resources
        self._tell = tell
        self._begun_s = time.monotonic()
        self._drawn_s = 0.0
        self.key = plan.key(presses)
        self.states = plan.states(presses)
        self.validation = presses.of_split(Split.VALIDATION)
        found = read_checkpoint(out, self.key)
        self.begun: Beginning = begin(presses, self.states, plan, resources)
        self.trainer: Trainer = self.begun.trainer()
        self.rows: list[dict[str, Any]] = []
        self.best: dict[str, np.ndarray] = {}
        self.best_epoch = 0
        self.seconds = 0.0
        self._nulls = self._null_errors()
        if found is not None:
            self._restore(found)

    def run(self, monitor: Monitor) -> Trained:
        settings, minutes = self.plan.settings, self.resources.minutes
        paused = False
        while not self._ended and not paused:
            started = time.monotonic()
            loss = self.trainer.run_epoch(monitor)
            self._add_row(loss, self.trainer.validation_errors(monitor), started)
            self._save()
            left = settings.epochs - self.trainer.epoch
            pace_s = float(np.median([row["seconds"] for row in self.rows[-9:]]))
            self._tell(
                TrainingProgress(
                    row=self.rows[-1],
                    epochs=settings.epochs,
                    eta_s=left * pace_s,
                    notes=self.trainer.notes,
                )
            )
            paused = bool(minutes) and time.monotonic() - self._begun_s > 60.0 * minutes
        return self._write_results()

    @property
    def _ended(self) -> bool:
        settings, done = self.plan.settings, self.trainer.epoch
        late = bool(settings.patience) and done - self.best_epoch >= settings.patience
        return done >= settings.epochs or (late and done > 0)

    def _add_row(self, loss: float, errors: np.ndarray, started_s: float) -> None:
        from sim.forces.network.minkunet import arrays_of

        mae = float(errors.mean()) if len(errors) else None
        zero = self._nulls["zero_mae"]
        self.rows.append(
            {
                "epoch": self.trainer.epoch,
                "rate": self.trainer.rate,
                "train_loss": loss,
                "train_mae": loss * self.begun.unit_mae,
                "validation_loss": mae / zero if mae is not None and zero else None,
                "validation_mae": mae,
                **self._nulls,
                "seconds": time.monotonic() - started_s,
            }
        )
        best = min((row["validation_mae"] for row in self.rows[:-1]), default=None, key=_or_large)
        if mae is None or best is None or mae < best:
            self.best_epoch = self.trainer.epoch
            self.best = arrays_of(self.trainer.kept)

    def _null_errors(self) -> dict[str, float | None]:
        """Errors of the predictors that need no network on the validation samples."""
        target, states = self.plan.target, self.validation
        if not states:
            return {"zero_mae": None, "mpm_mae": None}
        raw = self.presses.raw_errors(target, states)
        return {
            "zero_mae": self.begun.validation_zero_mae,
            "mpm_mae": None if raw is None else float(raw.mean()),
        }

    def _save(self) -> None:
        import torch

        self.seconds += self.rows[-1]["seconds"]
        write_checkpoint(
            self.out,
            self.key,
            {
                "trainer": self.trainer.state(),
                "rows": self.rows,
                "best_epoch": self.best_epoch,
                "best": {name: torch.from_numpy(array) for name, array in self.best.items()},
                "seconds": self.seconds,
            },
        )
        write_curves(self.out, self.rows)
        if time.monotonic() - self._drawn_s > CHART_S:
            write_chart(self.out, self.rows, self.plan.target)
            self._drawn_s = time.monotonic()

    def _restore(self, content: dict[str, Any]) -> None:
        self.trainer.restore(content["trainer"])
        self.rows = list(content["rows"])
        self.best_epoch, self.seconds = content["best_epoch"], content["seconds"]
        self.best = {name: tensor.numpy() for name, tensor in content["best"].items()}

    def _write_results(self) -> Trained:
        plan = self.plan
        shown = plan.base.card.get("indenters", ()) if plan.base else ()
        card = data_card(self.presses, self.states, plan.target, shown)
        card["training"] = training_card(
            self.begun,
            Course(
                rows=self.rows,
                best_epoch=self.best_epoch,
                seconds=self.seconds,
                finished=self._ended,
            ),
            cases=len({self.presses.states[number].case for number in self.states}),
        )
        weights, scores = final_weights(
            self.presses,
            self.begun.weights(self.best, card),
            device=self.resources.device,
            batch=plan.settings.batch,
        )
        path = save_weights(self.out, weights, storage=Storage.HALF)
        notes = (*self.begun.notes, *self.trainer.notes)
        for old in self.out.glob("*.weights"):
            if old != path:
                old.unlink(missing_ok=True)
        if not write_chart(self.out, self.rows, plan.target):
            notes += ("the curves are not drawn: OpenCV is missing here",)
        done = Trained(
            weights=path,
            rows=tuple(self.rows),
            best_epoch=self.best_epoch,
            finished=self._ended,
            scores=scores,
            notes=notes,
        )
        summary = {
            "key": self.key,
            "weights": path.name,
            "finished": done.finished,
            "best_epoch": done.best_epoch,
            "epochs": len(self.rows),
            "scores": scores,
            "notes": list(notes),
            "card": card,
        }
        write_atomically(self.out / SUMMARY, json.dumps(summary, indent=1).encode())
        return done


def _or_large(value: float | None) -> float:
    return float("inf") if value is None else value
