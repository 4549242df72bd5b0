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

All samples stay on the device. A batch is one orientation of the membrane (`frames`), so that all
its samples share voxels and kernel maps. Order and orientation of the batches depend on seed and
epoch alone: a training that goes on from its state does what it would have done.

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
from sim.forces.network.spec import Target
from sim.forces.training.arithmetic import adam, half_type, is_full, no_room
from sim.forces.training.averages import Average
from sim.forces.training.fields import Fields
from sim.forces.training.frames import Frame, frames_of
from sim.forces.training.scores import network_output, sample_errors
from sim.forces.training.settings import Numbers, TrainingSettings, rate_factor
from workbench.core.errors import DesignError, SolveError
from workbench.core.monitor import Monitor, silent

_Result = TypeVar("_Result")

CHECK_STEPS = 20
"""Steps between two looks at the loss: each look waits for the device."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Scales:
    """What fields are divided by before they enter or leave the network."""

    input_mm: float
    force_N: float = 0.0
    """Of the contact solver's force; 0: it does not enter."""
    output: float
    """In the unit of the target; one for all channels, which turn into each other."""

    @property
    def inputs(self) -> tuple[float, ...]:
        """Of each vector that enters."""
        return (self.input_mm, self.force_N) if self.force_N else (self.input_mm,)


class Trainer:
    """A training between two epochs.

    Attributes:
        epoch: Epochs that are done.
        notes: What the user should know about how it runs; empty when all is well.
    """

    def __init__(
        self,
        network: MinkUNet,
        train: Fields,
        validation: Fields,
        *,
        points_mm: np.ndarray,
        voxel_mm: float,
        target: Target,
        settings: TrainingSettings,
        scales: Scales,
        device: str = "cpu",
        numbers: Numbers = Numbers.AUTO,
        seed: int = 0,
    ) -> None:
        """Bring network, membrane and samples to the device.

        Args:
            network: Untrained, or with its encoder frozen to be tuned.
            train: What the loss is of.
            validation: What the best epoch is chosen by; may be empty.
            points_mm: Vertices of the skin at rest [mm], shape (V, 3).
            voxel_mm: Edge of a voxel.
            target: What is predicted.
            settings: Of the training.
            scales: Of input and output.
            device: `cpu` or `cuda`.
            numbers: Type of the arithmetic.
            seed: Of the order of samples.

        Raises:
            DesignError: If there is no sample, or all targets are zero.
            DeviceError: If the device has no room for the data.
        """
        zero_mae = train.zero_mae
        if zero_mae == 0.0:
            raise DesignError(
                f"of {len(train)} samples to train on none has a {target} that is not zero",
                hint="take a data set with presses that touch, in the split train",
                at="train",
            )
        self.settings = settings
        self.scales = scales
        self.epoch = 0
        self.notes: list[str] = []
        self._seed = seed
        self._unit = zero_mae / scales.output
        self._half = half_type(device, numbers)
        self._piece = settings.batch
        self._factor = 1.0
        self._steps = math.ceil(len(train) * settings.passes / settings.batch)
        try:
            self._network = network.to(device)
            self._input_scale = torch.tensor(scales.inputs, device=device).repeat_interleave(3)
            self._frames = frames_of(
                points_mm,
                voxel_mm=voxel_mm,
                spec=network.spec,
                target=target,
                turns=settings.turns,
                device=device,
            )
            self._train = _on(train, device)
            self._validation = _on(validation, device)
            self._average = Average(network, settings.averaging) if settings.averaging else None
        except RuntimeError as error:
            if not is_full(error):
                raise
            raise no_room(device) from error
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
        for step, (samples, turn) in enumerate(self._batches()):
            done = self.epoch * self._steps + step
            self._factor = rate_factor(done, self._steps * self.settings.epochs, self.settings)
            total += self._step(samples, self._frames[turn])
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
                self._frames[0],
                *self._validation,
                input_scale=self._input_scale,
                output_scale=self.scales.output,
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

    def _batches(self) -> Iterator[tuple[Tensor, int]]:
        """Samples and orientation of each step of this epoch."""
        rng = np.random.default_rng([self._seed, self.epoch])
        count = len(self._train[0])
        order = np.concatenate([rng.permutation(count) for _ in range(self.settings.passes)])
        turns = rng.integers(len(self._frames), size=self._steps).tolist()
        for step, turn in enumerate(turns):
            first = step * self.settings.batch
            samples = torch.from_numpy(order[first : first + self.settings.batch])
            yield samples.to(self._device), turn

    def _step(self, samples: Tensor, frame: Frame) -> Tensor:
        """One step of the optimiser; its error, still on the device."""
        for group in self._optimiser.param_groups:
            group["lr"] = self.settings.rate * self._factor
        loss = self._with_room(lambda: self._gradients(samples, frame))
        if self.settings.clip:
            self._scaler.unscale_(self._optimiser)
            nn.utils.clip_grad_norm_(self._network.parameters(), self.settings.clip)
        self._scaler.step(self._optimiser)
        self._scaler.update()
        return loss

    def _gradients(self, samples: Tensor, frame: Frame) -> Tensor:
        """Gradients of the loss of some samples, part by part."""
        self._optimiser.zero_grad(set_to_none=True)
        total = torch.zeros((), device=self._device)
        for part in samples.split(self._piece):
            error, loss = self._losses(part, frame)
            share = len(part) / len(samples)
            self._scaler.scale(loss * share).backward()
            total += error * share
        return total

    def _losses(self, samples: Tensor, frame: Frame) -> tuple[Tensor, Tensor]:
        """The mean absolute error and what is minimised, both over the error of zero."""
        inputs, targets = (fields.index_select(0, samples) for fields in self._train)
        turned = (inputs.unflatten(2, (-1, 3)) @ frame.vectors.t()).flatten(2)
        given = (turned / self._input_scale).transpose(0, 1)
        wanted = (targets @ (frame.values.t() / self.scales.output)).transpose(0, 1)
        found = network_output(self._network, frame, given.contiguous(), half=self._half)
        error = (found - wanted).abs().mean() / self._unit
        foot = self.settings.foot * self._factor
        if not foot:
            return error.detach(), error
        return error.detach(), smooth_l1_loss(found, wanted, beta=foot) / self._unit

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


def _on(fields: Fields, device: str) -> tuple[Tensor, Tensor]:
    return (
        torch.from_numpy(np.ascontiguousarray(fields.inputs, dtype=np.float32)).to(device),
        torch.from_numpy(np.ascontiguousarray(fields.targets, dtype=np.float32)).to(device),
    )
