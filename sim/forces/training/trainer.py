"""One network through its epochs: batches, steps, and what it needs to go on later.

The loss is the mean absolute error at the points, not at the voxels: it is then what the tables
report, and where two points share a voxel the network learns their median instead of the points
being averaged before they are compared. It is divided by the loss of zero output, so that 1 means
"no better than saying zero" for every membrane, target and unit.

With a foot b the step minimises the mean of e^2 / (2 b) below b and e - b/2 above. Ninety-nine of a
hundred values are zero, and under the plain absolute error each pulls as hard as a value in the
dent however small its error is, so the network learns to say zero first and leaves that late. The
foot shrinks with the rate: the end of the training is that of the plain error. What is reported is
always the plain error.

With `peak_heed` h, an error at a point whose true field is the share s of its sample's largest
counts 1 + h s times: few points make the peak that users ask for, and the plain mean lets them go.

What a batch is, whole skins or patches, is for the feed (`feeds`). Order and orientation of the
batches depend on seed and epoch alone: a training that goes on from its state does what it would
have done.

When the device runs out of memory, the step is done again in smaller parts whose gradients add:
the same step but for the statistics of normalisation, which see a part at a time.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn.functional import smooth_l1_loss

from sim.forces.network.minkunet import MinkUNet
from sim.forces.training.arithmetic import adam, half_type, is_full, no_room, room_for
from sim.forces.training.averages import Average
from sim.forces.training.feeds import Batch, Feed
from sim.forces.training.scores import network_output, sample_errors
from sim.forces.training.settings import Numbers, TrainingSettings, rate_factor
from workbench.core.base.errors import SolveError
from workbench.core.base.monitor import Monitor, silent

_Result = TypeVar("_Result")

DRAWS_BELOW = 2**62
"""End of the numbers that orientations are drawn from."""
CHECK_STEPS = 20
"""Steps between two looks at the loss: each look waits for the device."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TrainingData:
    """What a network learns from, and what its errors are measured in."""

    train: Feed
    """What the loss is of."""
    validation: Feed
    """What the best epoch is chosen by; may be empty."""
    unit: float
    """Mean absolute error of zero output on what is trained on, over the output's scale."""
    output_scale: float
    """What outputs are multiplied by, in the target's unit."""


class Trainer:
    """A training between two epochs.

    Attributes:
        epoch: Epochs that are done.
        notes: What the user should know about how it runs; empty when all is well.
    """

    def __init__(
        self,
        network: MinkUNet,
        data: TrainingData,
        settings: TrainingSettings,
        *,
        device: str = "cpu",
        numbers: Numbers = Numbers.AUTO,
        seed: int = 0,
    ) -> None:
        """Bring the network to the device.

        Args:
            network: Untrained, or with its encoder frozen to be tuned.
            data: What it learns from.
            settings: Of the training.
            device: `cpu` or `cuda`.
            numbers: Type of the arithmetic.
            seed: Of the order of samples.

        Raises:
            DeviceError: If the device has no room for the network.
        """
        self.settings = settings
        self.epoch = 0
        self.notes: list[str] = []
        self._data = data
        self._seed = seed
        self._half = half_type(device, numbers)
        self._piece = settings.batch
        self._factor = 1.0
        self._steps = math.ceil(len(data.train) * settings.passes / settings.batch)
        with room_for(device):
            self._network = network.to(device)
            self._average = Average(network, settings.averaging) if settings.averaging else None
        self._optimiser = adam(network, settings, fused=device != "cpu")
        self._scaler = torch.amp.GradScaler(device, enabled=self._half is torch.float16)
        self._device = device

    @property
    def kept(self) -> MinkUNet:
        """The network that is measured and kept: the average where there is one."""
        return self._average.network if self._average else self._network

    @property
    def rate(self) -> float:
        """Learning rate of the last step."""
        return self.settings.rate * self._factor

    def run_epoch(self, monitor: Monitor = silent) -> float:
        """One epoch; returns its mean absolute error over that of zero.

        Raises:
            SolveError: If the loss is not finite: the state of the last epoch is what is left.
            DeviceError: If the device has no memory for a single sample.
        """
        self._network.train()
        total = torch.zeros((), device=self._device)
        for step, (samples, draw) in enumerate(self._batches()):
            done = self.epoch * self._steps + step
            self._factor = rate_factor(done, self._steps * self.settings.epochs, self.settings)
            total += self._step(samples, draw)
            if self._average:
                self._average.follow(self._network, done)
            if step % CHECK_STEPS == 0 or step == self._steps - 1:
                self._expect_finite(total, step)
                monitor((step + 1) / self._steps)
        self.epoch += 1
        return float(total) / self._steps

    def validation_errors(self, monitor: Monitor = silent) -> np.ndarray:
        """Mean absolute error of each validation sample, in the target's unit, shape (S,).

        Raises:
            DeviceError: If the device has no memory for a single sample.
        """
        return self._with_room(
            lambda: sample_errors(
                self.kept.eval(),
                self._data.validation,
                output_scale=self._data.output_scale,
                batch=self._piece,
                tick=lambda: monitor(1.0),
            )
        )

    def state(self) -> dict[str, Any]:
        """All that a training needs to go on: tensors, numbers and texts."""
        return {
            "epoch": self.epoch,
            "piece": self._piece,
            "notes": list(self.notes),
            "network": self._network.state_dict(),
            "average": self._average.network.state_dict() if self._average else None,
            "optimiser": self._optimiser.state_dict(),
            "scaler": self._scaler.state_dict(),
        }

    def restore(self, state: dict[str, Any]) -> None:
        """Go on from a state of the same training."""
        self.epoch, self._piece = state["epoch"], state["piece"]
        self.notes = list(state["notes"])
        self._network.load_state_dict(state["network"])
        if self._average:
            self._average.network.load_state_dict(state["average"])
        self._optimiser.load_state_dict(state["optimiser"])
        self._scaler.load_state_dict(state["scaler"])

    def _batches(self) -> Iterator[tuple[list[int], int]]:
        """Samples of each step of this epoch, and the number that their orientations hang on."""
        rng = np.random.default_rng([self._seed, self.epoch])
        count = len(self._data.train)
        order = np.concatenate([rng.permutation(count) for _ in range(self.settings.passes)])
        draws = rng.integers(DRAWS_BELOW, size=self._steps).tolist()
        # Parts as equal as can be: statistics of a batch with one sample left would be its own.
        for samples, draw in zip(np.array_split(order, self._steps), draws, strict=True):
            yield samples.tolist(), draw

    def _step(self, samples: list[int], draw: int) -> Tensor:
        """One step of the optimiser; its error, still on the device."""
        for group in self._optimiser.param_groups:
            group["lr"] = self.settings.rate * self._factor
        loss = self._with_room(lambda: self._gradients(samples, draw))
        if self.settings.clip:
            self._scaler.unscale_(self._optimiser)
            nn.utils.clip_grad_norm_(self._network.parameters(), self.settings.clip)
        self._scaler.step(self._optimiser)
        self._scaler.update()
        return loss

    def _gradients(self, samples: list[int], draw: int) -> Tensor:
        """Gradients of the loss of some samples, part by part."""
        self._optimiser.zero_grad(set_to_none=True)
        total = torch.zeros((), device=self._device)
        for first in range(0, len(samples), self._piece):
            part = samples[first : first + self._piece]
            error, loss = self._losses(self._data.train.batch(part, draw))
            share = len(part) / len(samples)
            self._scaler.scale(loss * share).backward()
            total += error * share
        return total

    def _losses(self, batch: Batch) -> tuple[Tensor, Tensor]:
        """The mean absolute error and what is minimised, both over the error of zero."""
        found = network_output(self._network, batch, half=self._half)
        error = batch.errors((found - batch.targets).abs()).mean() / self._data.unit
        foot, heed = self.settings.foot * self._factor, self.settings.peak_heed
        if not foot and not heed:
            return error.detach(), error
        away = smooth_l1_loss(found, batch.targets, beta=foot, reduction="none")
        if heed:
            away = away * (1.0 + heed * batch.sizes)
        return error.detach(), batch.errors(away).mean() / self._data.unit

    def _with_room(self, work: Callable[[], _Result]) -> _Result:
        """The work's result; it is done again with smaller parts while the device is full."""
        while True:
            try:
                return work()
            except RuntimeError as error:
                if not is_full(error):
                    raise
                if self._piece == 1:
                    raise no_room(self._device) from error
            # Out of the handler: the exception holds what filled the device.
            self._optimiser.zero_grad(set_to_none=True)
            torch.cuda.empty_cache()
            self._piece = (self._piece + 1) // 2
            self.notes.append(
                f"the device ran out of memory in epoch {self.epoch + 1}: from here on samples are "
                f"computed {self._piece} at a time"
            )

    def _expect_finite(self, total: Tensor, step: int) -> None:
        if not math.isfinite(float(total)):
            raise SolveError(
                f"the loss is no longer finite in epoch {self.epoch + 1}, step {step + 1}",
                hint="the checkpoint of the epoch before is kept; lower --rate and begin anew in "
                "another folder, or go on with --numbers single",
                at="training",
            )
