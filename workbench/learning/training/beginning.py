"""What a training begins with: a new network, or weights whose decoder is to learn another gel.

To tune, the encoder stays as it is: it sees the dent, which a prescribed path makes alike for every
stiffness, and so do the scale of the displacement and the sizes of voxel and patch in spacings. The
scale of the output is multiplied by the one number that fits the old network's fields to the new
ones best: where force is proportional to the stiffness, tuning begins at that answer. Where the
contact solver's force enters, its scale is multiplied by the ratio of the moduli, and that is the
number.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.forces.network.inputs import FORCE
from sim.forces.network.spec import NetworkSpec, Target
from sim.forces.network.weights import NetworkWeights
from sim.forces.training.fields import Fields, rms_of_nonzero
from workbench.core.base.errors import DesignError
from workbench.learning.dataset.cases import Split
from workbench.learning.training.plan import Plan, Resources
from workbench.learning.training.presses import RAW, Presses, RestSkin
from workbench.learning.training.results import batches, single_predictor

if TYPE_CHECKING:
    from sim.forces.network.minkunet import MinkUNet
    from sim.forces.training.feeds import Scales
    from sim.forces.training.trainer import Trainer


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Beginning:
    """A network before its first epoch, with all that does not change while it learns."""

    network: MinkUNet
    scales: Scales
    voxel_per_spacing: float
    patch_spacings: float
    train: tuple[Fields, ...]
    """Of each skin."""
    unit_mae: float
    """Of a network that says zero, on the training samples, in the target's unit."""
    validation_zero_mae: float
    """Of fields that are zero, on the validation samples."""
    corrects: bool
    validation: tuple[Fields, ...]
    """Of each skin."""
    plan: Plan
    skins: tuple[RestSkin, ...]
    """As `train`."""
    resources: Resources
    notes: tuple[str, ...]

    @property
    def samples(self) -> int:
        """That are trained on."""
        return sum(len(fields) for fields in self.train)

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
        from sim.forces.training.feeds import SeenSkin, feeds
        from sim.forces.training.trainer import Trainer, TrainingData

        settings, target = self.plan.settings, self.plan.target
        if self.unit_mae == 0.0:
            raise DesignError(
                f"of {self.samples} samples to train on none has a {target} that is not zero",
                hint="take a data set with presses that touch, in the split train",
                at="train",
            )
        seen = [
            SeenSkin(
                points_mm=skin.points_mm,
                voxel_mm=self.voxel_per_spacing * skin.spacing_mm,
                patch_mm=self.patch_spacings * skin.spacing_mm,
                turns=settings.turns,
            )
            for skin in self.skins
        ]
        train, validation = feeds(
            [
                list(zip(self.train, seen, strict=True)),
                list(zip(self.validation, seen, strict=True)),
            ],
            self.scales,
            spec=self.network.spec,
            target=target,
            device=self.resources.device,
        )
        return Trainer(
            self.network,
            TrainingData(
                train=train,
                validation=validation,
                unit=self.unit_mae / self.scales.output,
                output_scale=self.scales.output,
            ),
            settings,
            device=self.resources.device,
            numbers=self.resources.numbers,
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
            spacing_mm=float(np.mean([skin.spacing_mm for skin in self.skins])),
            force_scale_N=self.scales.force_N,
            corrects=self.corrects,
            patch_spacings=self.patch_spacings,
            card=card,
        )


def begin(presses: Presses, states: Sequence[int], plan: Plan, resources: Resources) -> Beginning:
    """Make network and scales ready.

    Args:
        presses: All data.
        states: What is trained on.
        plan: What is trained how.
        resources: Device and type of the arithmetic.

    Raises:
        DesignError: If the weights to tune predict something else.
        SolveError: If a field is not finite.
    """
    from torch import nn

    from sim.forces.network.minkunet import new_network
    from sim.forces.training.feeds import Scales

    base = plan.base
    takes_force = plan.settings.takes_force if base is None else base.takes_force
    wanted = plan.settings.corrects and plan.target in RAW
    corrects = wanted if base is None else base.corrects
    held_back = presses.of_split(Split.VALIDATION)

    def fields(chosen: Sequence[int]) -> tuple[Fields, ...]:
        own = presses.by_skin(chosen)
        return tuple(
            presses.fields(
                plan.target,
                own.get(skin, []),
                skin=skin,
                takes_force=takes_force,
                corrects=corrects,
            )
            for skin in range(len(presses.skins))
        )

    train, validation = fields(states), fields(held_back)
    notes = [] if held_back else ["there is no validation case: the last epoch is kept"]
    left_out = presses.about["left_out"]
    if left_out:
        notes.append(
            f"{len(left_out)} samples that did not converge are left out: {left_out[0]}, ..."
        )
    if base is None:
        network = new_network(_spec(plan), seed=plan.seed)
        # It begins by saying zero, which is right nearly everywhere, not noise of the field's size.
        nn.init.zeros_(network.last.weight)
        nn.init.zeros_(network.last.bias)
        forces_N = rms_of_nonzero(*(own.inputs[..., FORCE] for own in train))
        scales = Scales(
            input_mm=rms_of_nonzero(*(own.inputs[..., :3] for own in train)) or 1.0,
            force_N=(forces_N or 1.0) if takes_force else 0.0,
            output=rms_of_nonzero(*(own.targets for own in train)) or 1.0,
        )
        voxel, patch = plan.settings.voxel_per_spacing, plan.settings.patch_spacings
    else:
        network, scales, factor = _tuned(base, plan, states, presses, resources.device)
        voxel, patch = base.voxel_per_spacing, base.patch_spacings
        notes.append(f"the output scale of {plan.base_name} is multiplied by {factor:.4g}")
    return Beginning(
        network=network,
        scales=scales,
        voxel_per_spacing=voxel,
        patch_spacings=patch,
        train=train,
        unit_mae=float(
            np.average([own.zero_mae for own in train], weights=[len(own) for own in train])
        ),
        validation=validation,
        validation_zero_mae=presses.zero_mae(plan.target, held_back),
        corrects=corrects,
        plan=plan,
        skins=presses.skins,
        resources=resources,
        notes=tuple(notes),
    )


def _spec(plan: Plan) -> NetworkSpec:
    return dataclasses.replace(
        plan.settings.spec,
        input_channels=6 if plan.settings.takes_force else 3,
        output_channels=plan.target.channels,
    )


def _tuned(
    base: NetworkWeights, plan: Plan, states: Sequence[int], presses: Presses, device: str
) -> tuple[MinkUNet, Scales, float]:
    """The network with its encoder frozen, its scales, and what the output's was multiplied by."""
    from sim.forces.network.minkunet import network_of
    from sim.forces.training.feeds import Scales

    if base.target != plan.target:
        raise DesignError(
            f"{plan.base_name} predicts {base.target}, not {plan.target}",
            hint=f"give --target {base.target}, or weights for {plan.target}",
            at="--weights",
        )
    network = network_of(base)
    network.freeze_encoder()
    # One scale for all channels, which turn into each other; ours are alike already.
    output, force_N = float(np.mean(base.output_scale)), base.force_scale_N
    if base.takes_force:
        stiffer = _young_ratio(base, presses)
        force_N *= stiffer
        factor = stiffer if plan.target is Target.FORCE else 1.0
    else:
        found, wanted = [], []
        for skin, own in presses.by_skin(states).items():
            predict = single_predictor(base, presses.skins[skin], device)
            train = presses.fields(plan.target, own, skin=skin)
            found += [predict(part) for part in batches(train.inputs, plan.settings.batch)]
            wanted += list(batches(train.targets, plan.settings.batch))
        factor = best_factor(found, wanted)
    scales = Scales(input_mm=base.input_scale_mm, force_N=force_N, output=output * factor)
    return network, scales, factor


def _young_ratio(base: NetworkWeights, presses: Presses) -> float:
    """Young's modulus of the data over that of the weights.

    Raises:
        DesignError: If the weights do not say theirs.
    """
    theirs = base.card.get("young_MPa")
    if not isinstance(theirs, (int, float)) or not theirs > 0.0:
        raise DesignError(
            "the data card of the weights does not say at which Young's modulus they were trained",
            hint="train the weights again with this version",
            at="--weights",
        )
    return presses.about["recipes"][0]["design"]["material"]["young_MPa"] / float(theirs)


def best_factor(found: Sequence[np.ndarray], wanted: Sequence[np.ndarray]) -> float:
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
