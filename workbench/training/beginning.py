"""What a training begins with: a new network, or weights whose decoder is to learn another gel.

To tune, the encoder stays as it is: it sees the dent, which a prescribed path makes alike for every
stiffness, and so do the scale of the input and the size of a voxel in spacings. The scale of the
output is multiplied by the one number that fits the old network's fields to the new ones best:
where force is proportional to the stiffness, tuning begins at that answer.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.forces.network.spec import NetworkSpec
from sim.forces.network.weights import NetworkWeights
from sim.forces.training.fields import Fields, rms_of_nonzero
from sim.forces.training.settings import Numbers
from workbench.core.errors import DesignError
from workbench.dataset.cases import Split
from workbench.training.plan import Plan
from workbench.training.presses import Presses
from workbench.training.results import batches, single_predictor

if TYPE_CHECKING:
    from sim.forces.network.minkunet import MinkUNet
    from sim.forces.training.trainer import Scales, Trainer


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Beginning:
    """A network before its first epoch, with all that does not change while it learns."""

    network: MinkUNet
    scales: Scales
    voxel_per_spacing: float
    spacing_mm: float
    train: Fields
    zero_mae: float
    """Of the training samples, in the target's unit."""
    validation_zero_mae: float
    validation: Fields
    plan: Plan
    points_mm: np.ndarray
    device: str
    numbers: Numbers
    notes: tuple[str, ...]

    @property
    def parameters(self) -> int:
        """Weights of the network, frozen ones counted."""
        from sim.forces.network.minkunet import parameter_count

        return parameter_count(self.network)

    def trainer(self) -> Trainer:
        """What takes it through its epochs.

        Raises:
            DesignError: If no training sample has a target that is not zero.
            DeviceError: If the device has no room for the data.
        """
        from sim.forces.training.trainer import Trainer

        return Trainer(
            self.network,
            self.train,
            self.validation,
            points_mm=self.points_mm,
            voxel_mm=self.voxel_per_spacing * self.spacing_mm,
            target=self.plan.target,
            settings=self.plan.settings,
            scales=self.scales,
            device=self.device,
            numbers=self.numbers,
            seed=self.plan.seed,
        )

    def weights(self, arrays: Mapping[str, np.ndarray], card: Mapping[str, Any]) -> NetworkWeights:
        """The network with these arrays as weights to be kept."""
        return NetworkWeights(
            spec=self.network.spec,
            arrays=arrays,
            target=self.plan.target,
            input_scale_mm=self.scales.input_mm,
            output_scale=(self.scales.output,) * self.plan.target.channels,
            voxel_per_spacing=self.voxel_per_spacing,
            spacing_mm=self.spacing_mm,
            card=card,
        )


def begin(
    presses: Presses, states: Sequence[int], plan: Plan, *, device: str, numbers: Numbers
) -> Beginning:
    """Make network and scales ready.

    Args:
        presses: All data.
        states: What is trained on.
        plan: What is trained how.
        device: `cpu` or `cuda`.
        numbers: Type of the arithmetic.

    Raises:
        DesignError: If the weights to tune predict something else.
        SolveError: If a field is not finite.
    """
    from torch import nn

    from sim.forces.network.minkunet import new_network
    from sim.forces.network.voxels import spacing_mm
    from sim.forces.training.trainer import Scales

    train = presses.fields(plan.target, states)
    validation = presses.fields(plan.target, presses.of_split(Split.VALIDATION))
    notes = [] if len(validation) else ["there is no validation case: the last epoch is kept"]
    left_out = presses.about["left_out"]
    if left_out:
        notes.append(
            f"{len(left_out)} samples that did not converge are left out: {left_out[0]}, ..."
        )
    base = plan.base
    if base is None:
        network = new_network(_spec(plan), seed=plan.seed)
        # It begins by saying zero, which is right nearly everywhere, not noise of the field's size.
        nn.init.zeros_(network.last.weight)
        nn.init.zeros_(network.last.bias)
        scales = Scales(
            input_mm=rms_of_nonzero(train.inputs_mm) or 1.0,
            output=rms_of_nonzero(train.targets) or 1.0,
        )
        voxel = plan.settings.voxel_per_spacing
    else:
        network, scales, factor = _tuned(base, plan, train, presses, device)
        voxel = base.voxel_per_spacing
        notes.append(f"the output scale of {plan.base_name} is multiplied by {factor:.4g}")
    return Beginning(
        network=network,
        scales=scales,
        voxel_per_spacing=voxel,
        spacing_mm=spacing_mm(presses.points_mm, presses.faces),
        train=train,
        zero_mae=train.zero_mae,
        validation=validation,
        validation_zero_mae=validation.zero_mae,
        plan=plan,
        points_mm=presses.points_mm,
        device=device,
        numbers=numbers,
        notes=tuple(notes),
    )


def _spec(plan: Plan) -> NetworkSpec:
    return dataclasses.replace(plan.settings.spec, output_channels=plan.target.channels)


def _tuned(
    base: NetworkWeights, plan: Plan, train: Fields, presses: Presses, device: str
) -> tuple[MinkUNet, Scales, float]:
    """The network with its encoder frozen, its scales, and what the output's was multiplied by."""
    from sim.forces.network.minkunet import network_of
    from sim.forces.training.trainer import Scales

    if base.target != plan.target:
        raise DesignError(
            f"{plan.base_name} predicts {base.target}, not {plan.target}",
            hint=f"give --target {base.target}, or weights for {plan.target}",
            at="--weights",
        )
    predict = single_predictor(base, presses, device)
    found = np.concatenate([predict(own) for own in batches(train.inputs_mm, plan.settings.batch)])
    factor = best_factor(found, train.targets)
    network = network_of(base)
    network.freeze_encoder()
    # One scale for all channels, which turn into each other; ours are alike already.
    output = float(np.mean(base.output_scale)) * factor
    return network, Scales(input_mm=base.input_scale_mm, output=output), factor


def best_factor(found: np.ndarray, wanted: np.ndarray) -> float:
    """The number c that makes the sum of (wanted - c found)^2 least; 1 where none above 0 does.

    Least squares, not the least absolute error: most values are zero, and a poor network's best
    factor for them is zero.
    """
    pairs = [
        (float(np.vdot(ours, theirs)), float(np.vdot(ours, ours)))
        for ours, theirs in zip(found, wanted, strict=True)
    ]
    product, square = np.sum(pairs, axis=0)
    return float(product / square) if product > 0.0 else 1.0
