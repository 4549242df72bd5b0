"""Networks of a task: made by name, trained, kept in files, and asked.

A training is kept under the key of all that it rests on; one that was ended by force begins anew,
those before it are read.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core.base.digest import digest
from workbench.core.base.monitor import Monitor
from workbench.tasks.contact_frame import in_contact_frame, in_sensor_frame
from workbench.tasks.examples import Examples
from workbench.tasks.features import ON_FEATURES, shown_to, turnable
from workbench.tasks.safety_scale import SafetyScale
from workbench.tasks.splits import Parts
from workbench.tasks.task import Look, Net, Task, Told

if TYPE_CHECKING:
    from torch import nn

    from workbench.tasks.networks.learn import Learned, Part, Settings

FORMAT = 6


SETTINGS = {
    (Net.OWN, Look.PLAIN): (60, 2e-3, 16, 1e-3),
    (Net.OWN, Look.MARKED): (60, 2e-3, 16, 1e-3),
    (Net.PAPER, Look.PLAIN): (50, 1e-3, 32, 0.0),
    (Net.PAPER, Look.MARKED): (50, 1e-3, 32, 0.0),
    (Net.PAPER, Look.WINDOW): (15, 5e-4, 4, 0.0),
}
"""Epochs, largest step, batch, weight decay. Source of the first three of the paper's: SimTac,
*Sim2Real task setup*."""
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
    net: Net
    weights_from: str
    outputs: tuple[str, ...]
    scale: Scale | None
    safety: SafetyScale | None
    epoch: int
    curve: list[dict[str, float]]

    def told(self, found: Examples) -> np.ndarray:
        """What it says of examples: classes (N,), or values (N, K) in their own units."""
        from workbench.tasks.networks.learn import told_by

        raw = told_by(self.network, shown_to(self.net, found), found.at)
        if self.scale is None:
            return raw.argmax(axis=1)
        values = self.scale.middle + self.scale.spread * raw
        return in_sensor_frame(values, found) if self.safety is None else self.safety.both(values)


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
            StoreError: If the file cannot be written.
        """
        import torch

        from workbench.tasks.networks.kept_training import read_training, write_training
        from workbench.tasks.networks.learn import Part

        torch.manual_seed(seed)
        truth = self._learned_of(found)
        scale = _scale(truth[parts.train], self.safety)
        outputs = 1 if self.safety else len(found.outputs)
        inputs = shown_to(self.net, found)
        train, validation = (
            Part(inputs=inputs[rows], at=found.at[rows], truth=_wanted(truth[rows], scale))
            for rows in (parts.train, parts.validation)
        )
        network, weights_from = made(self.net, self.task, outputs, train, self.safety)
        network.to(self.device)
        path = self.folder / f"{name}-seed{seed}.pt"
        key = self._key(found, parts, seed, weights_from)
        kept = read_training(path, key)
        if kept is not None:
            network.load_state_dict(kept["state"])
            epoch, curve = kept["epoch"], kept["curve"]
        else:
            learned = self._learned(network, (train, validation), (found.outputs, seed), monitor)
            epoch, curve = learned.epoch, learned.curve
            learning = {"state": network.state_dict(), "epoch": epoch, "curve": curve}
            write_training(path, key, learning)
        return Trained(
            network=network,
            net=self.net,
            weights_from=weights_from,
            outputs=found.outputs,
            scale=scale,
            safety=self.safety,
            epoch=epoch,
            curve=curve,
        )

    def _learned_of(self, found: Examples) -> np.ndarray:
        """What of examples is learned: classes (N,), or values (N, K) before they are scaled."""
        if found.truth.ndim == 1:
            return found.truth
        return in_contact_frame(found) if self.safety is None else self.safety.level(found)

    def _learned(
        self,
        network: nn.Module,
        parts: tuple[Part, Part],
        drawn: tuple[tuple[str, ...], int],
        monitor: Monitor,
    ) -> Learned:
        """Let a network of some outputs learn by a seed; a head is solved for."""
        names, seed = drawn
        if self.net is Net.MOTION:
            from workbench.tasks.networks.committee import Committee, learn_committee

            assert isinstance(network, Committee)
            return learn_committee(network, parts, seed, monitor)
        if self.net in ON_FEATURES:
            from workbench.tasks.networks.head import Head, fit_values

            assert isinstance(network, Head)
            return fit_values(network, parts, cautious=self.net is Net.MEASURES)
        if self.net is Net.DENT:
            from workbench.tasks.networks.dent import DentNet, Lesson, learn_dents

            assert isinstance(network, DentNet)
            lesson = Lesson(names=names, seed=seed, kept=self.folder / "drawn-dents.pt")
            return learn_dents(network, parts, lesson, monitor)
        from workbench.tasks.networks.learn import learn

        return learn(network, parts, self._settings, seed, monitor)

    @property
    def learning(self) -> dict[str, Any]:
        """How it learns, as results tell it."""
        if self.net is Net.DENT:
            from workbench.tasks.networks.dent import SETTINGS as DENT_SETTINGS

            return dict(DENT_SETTINGS)
        if self.net is Net.MOTION:
            from workbench.tasks.networks.committee import SETTINGS as MOTION_SETTINGS

            return dict(MOTION_SETTINGS)
        if self.net not in ON_FEATURES:
            return dataclasses.asdict(self._settings)
        from workbench.tasks.networks.head import PENALTIES

        return {"penalties": list(PENALTIES)}

    @property
    def _settings(self) -> Settings:
        """How long and how fast it learns."""
        from workbench.tasks.networks.learn import Settings

        epochs, rate, batch, decay = SETTINGS[self.net, self.task.look]
        classes = self.task.told is Told.CLASS
        if (self.net, self.task.look, classes) == (Net.PAPER, Look.PLAIN, True):
            epochs = PAPER_CLASS_EPOCHS
        moved = turnable(self.task) and self.net is not Net.PAPER
        return Settings(epochs=epochs, rate=rate, batch=batch, decay=decay, moved=moved)

    def _key(self, found: Examples, parts: Parts, seed: int, weights_from: str) -> str:
        from workbench.tasks.networks import shown

        held_fixed = {"format": FORMAT, "net": self.net.value, "from": weights_from, "seed": seed}
        held = dataclasses.asdict(self.safety) if self.safety else {}
        return digest(
            [
                {**held_fixed, **held, "grey": shown.GREY, "gain": shown.GAIN},
                self.learning,
                [
                    shown_to(self.net, found),
                    found.at,
                    found.truth.astype(np.float64),
                    found.axes,
                    *parts,
                ],
                list(found.outputs),
            ]
        )


def made(
    net: Net, task: Task, outputs: int, part: Part, safety: SafetyScale | None = None
) -> tuple[nn.Module, str]:
    """A network by name, and where its first weights come from.

    Args:
        net: Which one.
        task: Says whether it sees images or windows.
        outputs: Numbers that it tells.
        part: What it learns from.
        safety: Scale of the level of pressure, where one is told.
    """
    if net is Net.OWN:
        from workbench.tasks.networks.own import OwnNet

        return OwnNet(outputs), "random weights"
    if net is Net.DENT:
        from workbench.tasks.networks.dent import DentNet

        return DentNet(outputs), "drawn dents of the objects, without a press"
    if net is Net.MOTION:
        from workbench.tasks.networks.committee import Committee

        return Committee(outputs, part), ON_FEATURES[net]
    if net in ON_FEATURES:
        from workbench.tasks.networks.head import Head

        known = {}
        if safety is not None and net is Net.MEASURES:
            from workbench.tasks.networks.measures import PRESSURE

            known[PRESSURE] = safety.level_per_log
        return Head(outputs, part, told_places=net is Net.LITE, known=known), ON_FEATURES[net]
    from workbench.tasks.networks.published import ResNet, VggLstm

    published = (VggLstm if task.look is Look.WINDOW else ResNet)(outputs)
    return published, published.weights_from


def _scale(truth: np.ndarray, safety: SafetyScale | None) -> Scale | None:
    """Middle and spread of the values to learn from; those of a level are 0 and 1."""
    if truth.ndim == 1:
        return None
    if safety is not None:
        return Scale(middle=np.zeros(1), spread=np.ones(1))
    spread = truth.std(axis=0)
    return Scale(middle=truth.mean(axis=0), spread=np.where(spread > 0.0, spread, 1.0))


def _wanted(truth: np.ndarray, scale: Scale | None) -> np.ndarray:
    if scale is None:
        return truth.astype(np.int64)
    count = len(scale.middle)
    return ((truth[:, :count] - scale.middle) / scale.spread).astype(np.float32)
