"""A training between its epochs: what a step does, and what happens when one goes wrong."""

from __future__ import annotations

import dataclasses
import io
from typing import Any

import numpy as np
import pytest
import torch
from torch import Tensor

from sim.forces.network.minkunet import MinkUNet, arrays_of, new_network
from sim.forces.network.spec import Norm, Target
from sim.forces.training import trainer as trainer_module
from sim.forces.training.arithmetic import half_type
from sim.forces.training.averages import Average
from sim.forces.training.feeds import Batch, Scales, SeenSkin, feeds
from sim.forces.training.settings import Numbers, TrainingSettings
from sim.forces.training.trainer import Trainer, TrainingData
from tests.unit.made_presses import SETTINGS, SPEC, made_presses
from workbench.core.base.errors import DeviceError, SolveError
from workbench.learning.dataset.cases import Split

PRESSES = made_presses(12)
SKIN = PRESSES.skins[0]


PATCHES = dataclasses.replace(SETTINGS, patch_spacings=2.0, turns=1)
EITHER = pytest.mark.parametrize("settings", [SETTINGS, PATCHES], ids=["skins", "patches"])


def start(settings: TrainingSettings = SETTINGS, network: MinkUNet | None = None) -> Trainer:
    """A training of forces on the made-up presses."""
    fields = [
        PRESSES.fields(Target.FORCE, PRESSES.of_split(split))
        for split in (Split.TRAIN, Split.VALIDATION)
    ]
    scales = Scales(input_mm=0.3, output=0.01)
    skin = SeenSkin(
        points_mm=SKIN.points_mm,
        voxel_mm=0.75,
        patch_mm=settings.patch_spacings,
        turns=settings.turns,
    )
    train, validation = feeds(
        [[(own, skin)] for own in fields],
        scales,
        spec=settings.spec,
        target=Target.FORCE,
        device="cpu",
    )
    return Trainer(
        network or new_network(settings.spec, seed=1),
        TrainingData(
            train=train,
            validation=validation,
            unit=fields[0].zero_mae / scales.output,
            output_scale=scales.output,
        ),
        settings,
        seed=5,
    )


def same(one: MinkUNet, two: MinkUNet) -> bool:
    """Whether two networks are equal bit by bit."""
    ours, theirs = arrays_of(one), arrays_of(two)
    return all(np.array_equal(ours[name], theirs[name]) for name in ours)


@EITHER
def test_going_on_from_a_state_changes_no_bit(settings: TrainingSettings) -> None:
    """An epoch, a state through a file, another: the weights of two epochs in a row."""
    whole = start(settings)
    losses = [whole.run_epoch() for _ in range(2)]
    first = start(settings)
    first.run_epoch()
    buffer = io.BytesIO()
    torch.save(first.state(), buffer)
    second = start(settings)
    second.restore(torch.load(io.BytesIO(buffer.getvalue()), weights_only=True))
    assert second.run_epoch() == losses[1]
    assert second.epoch == 2
    assert same(second.kept, whole.kept)
    assert np.array_equal(second.validation_errors(), whole.validation_errors())


def test_another_seed_takes_another_order() -> None:
    """What the test above compares does depend on the order of samples."""
    one, other = start(), start()
    other._seed = 6
    assert one.run_epoch() != other.run_epoch()


@EITHER
def test_loss_of_a_network_that_says_zero_is_one(settings: TrainingSettings) -> None:
    """The mean error of zero is what losses are measured in, averaged over all samples."""
    network = new_network(SPEC, seed=1)
    torch.nn.init.zeros_(network.last.weight)
    torch.nn.init.zeros_(network.last.bias)
    # One batch holds all twelve samples, and its loss is taken before the step.
    settings = dataclasses.replace(settings, batch=12, averaging=0.0)
    assert len(PRESSES.of_split(Split.TRAIN)) == 12
    # Any angle but those of two turns changes the sizes of a vector's components.
    near = 0.01 if settings.patch_spacings else 1e-6
    running = start(settings, network)
    zero = PRESSES.fields(Target.FORCE, PRESSES.of_split(Split.VALIDATION)).zero_mae
    assert running.validation_errors().mean() == pytest.approx(zero, rel=1e-6)
    assert running.run_epoch() == pytest.approx(1.0, rel=near)


@EITHER
def test_training_lowers_the_loss(settings: TrainingSettings) -> None:
    """Ten epochs from noise; the errors of validation samples fall as well."""
    settings = dataclasses.replace(settings, epochs=10, turns=1)
    running = start(settings)
    before, first = running.validation_errors().mean(), running.run_epoch()
    for _ in range(9):
        last = running.run_epoch()
    assert last < 0.7 * first
    assert running.validation_errors().mean() < 0.7 * before


@EITHER
def test_parts_of_a_batch_make_the_same_step(settings: TrainingSettings) -> None:
    """Without normalisation gradients add: 4 samples at once and one by one, to float32."""
    settings = dataclasses.replace(
        settings, spec=dataclasses.replace(SPEC, norm=Norm.NONE), averaging=0.0, turns=1
    )
    whole, parts = start(settings), start(settings)
    parts._piece = 1
    samples, draw = list(range(4)), 9
    assert float(whole._gradients(samples, draw)) == pytest.approx(
        float(parts._gradients(samples, draw)), rel=1e-5
    )
    pairs = zip(whole.kept.parameters(), parts.kept.parameters(), strict=True)
    for ours, theirs in pairs:
        assert ours.grad is not None and theirs.grad is not None
        assert torch.allclose(ours.grad, theirs.grad, rtol=1e-3, atol=1e-6)


def full_above(most: int, monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """A device that holds so many samples at a time; returns the sizes that it was asked for."""
    asked: list[int] = []
    real = trainer_module.network_output

    def limited(network: MinkUNet, batch: Batch, **rest: Any) -> Tensor:
        asked.append(len(batch.missed))
        if len(batch.missed) > most:
            raise torch.OutOfMemoryError("CUDA out of memory")
        return real(network, batch, **rest)

    monkeypatch.setattr(trainer_module, "network_output", limited)
    return asked


@EITHER
def test_a_full_device_computes_smaller_parts_and_says_so(
    settings: TrainingSettings, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Batches of 12 on a device for 3: 12, 6, 3 at a time, the epoch ends, two notes."""
    asked = full_above(3, monkeypatch)
    running = start(dataclasses.replace(settings, batch=12))
    loss = running.run_epoch()
    assert np.isfinite(loss) and running.epoch == 1
    assert asked == [12, 6, 3, 3, 3, 3]
    assert len(running.notes) == 2
    assert "epoch 1" in running.notes[0] and "3 at a time" in running.notes[1]
    again = start(dataclasses.replace(settings, batch=12))
    again.restore(running.state())
    assert again._piece == 3 and again.notes == running.notes


def test_a_device_too_small_for_one_sample_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is left to halve: the error says that the checkpoint is kept."""
    full_above(0, monkeypatch)
    with pytest.raises(DeviceError, match="even for one sample") as caught:
        start().run_epoch()
    assert "last checkpoint is kept" in caught.value.hint


def test_a_small_patch_alone_in_a_batch_is_a_step() -> None:
    """One voxel at the coarsest level has no variance: samples one by one, thirteen in fours."""
    alone = start(dataclasses.replace(PATCHES, batch=1, patch_spacings=1.1, weight_decay=0.1))
    assert np.isfinite(alone.run_epoch())
    uneven = start(dataclasses.replace(PATCHES, batch=11))
    sizes = [len(samples) for samples, _ in uneven._batches()]
    assert sizes == [6, 6], "a batch of eleven leaves one sample over"


def test_a_loss_that_is_not_finite_stops_the_training(monkeypatch: pytest.MonkeyPatch) -> None:
    """A weight became NaN: the epoch is not counted, the message names epoch and step."""
    running = start()
    running.run_epoch()
    with torch.no_grad():
        running._network.last.weight[0, 0] = float("nan")
    with pytest.raises(SolveError, match=r"no longer finite in epoch 2, step 1"):
        running.run_epoch()
    assert running.epoch == 1


def test_a_frozen_encoder_stays_bit_by_bit() -> None:
    """Weights and statistics up to the coarsest level; the decoder does change."""
    network = new_network(SPEC, seed=2)
    network.freeze_encoder()
    before = arrays_of(network)
    running = start(dataclasses.replace(SETTINGS, averaging=0.0, weight_decay=0.1), network)
    running.run_epoch()
    after = arrays_of(running.kept)
    seen = ("stem", "downs", "down_norms", "encoder")
    for name, values in before.items():
        frozen = name.split(".")[0] in seen
        changed = not np.array_equal(values, after[name])
        assert changed is not frozen or "tracked" in name or name.startswith("stem_norm"), name


def test_the_average_is_the_sum_it_says() -> None:
    """keep = min(decay, (1 + n) / (10 + n)): 0.1 at the first step, the decay in the end."""
    network = new_network(SPEC, seed=3)
    average = Average(network, 0.9)
    old = {name: value.clone() for name, value in network.named_parameters()}
    with torch.no_grad():
        for value in network.parameters():
            value.add_(1.0)
    average.follow(network, 0)
    for name, value in average.network.named_parameters():
        assert torch.allclose(value, old[name] + 0.9, atol=1e-6), name
    average.follow(network, 10_000)
    for name, value in average.network.named_parameters():
        assert torch.allclose(value, old[name] + 0.91, atol=1e-6), name


def test_a_foot_pulls_less_at_small_errors_only() -> None:
    """Below the foot the gradient is the error over the foot, above it is 1; the report is L1."""
    settings = dataclasses.replace(SETTINGS, foot=0.5, turns=1, averaging=0.0)
    network = new_network(SPEC, seed=1)
    torch.nn.init.zeros_(network.last.weight)
    torch.nn.init.constant_(network.last.bias, 0.1)
    plain, footed = start(dataclasses.replace(settings, foot=0.0), network), start(settings)
    footed._network.load_state_dict(network.state_dict())
    batch = plain._data.train.batch(range(12), 0)
    error, minimised = plain._losses(batch)
    assert float(error) == float(minimised.detach())
    same_error, minimised = footed._losses(batch)
    assert float(same_error) == pytest.approx(float(error))
    wanted = batch.targets
    apart = (0.1 - wanted).abs().double()
    expected = torch.where(apart < 0.5, apart**2, apart - 0.25).mean() / wanted.abs().mean()
    assert float(minimised.detach()) == pytest.approx(float(expected), rel=1e-4)


@pytest.mark.parametrize(
    "words",
    ["DefaultCPUAllocator: can't allocate memory", "CUDA error: CUBLAS_STATUS_ALLOC_FAILED"],
)
def test_a_full_device_is_known_by_its_words_too(
    words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Libraries have no error type of their own for it; any other error stays what it is."""

    def fail(*_: Any, **__: Any) -> Tensor:
        raise RuntimeError(words)

    running = start()
    monkeypatch.setattr(trainer_module, "network_output", fail)
    with pytest.raises(DeviceError):
        running.run_epoch()
    words = "mat1 and mat2 shapes cannot be multiplied"
    with pytest.raises(RuntimeError, match="shapes cannot be multiplied"):
        running.run_epoch()


def test_short_types_are_chosen_by_device(monkeypatch: pytest.MonkeyPatch) -> None:
    """float32 on a CPU unless asked, bfloat16 where a GPU has it, else float16."""
    assert half_type("cpu", Numbers.AUTO) is None
    assert half_type("cpu", Numbers.HALF) is torch.bfloat16
    assert half_type("cuda", Numbers.SINGLE) is None
    for able, kind in ((True, torch.bfloat16), (False, torch.float16)):
        monkeypatch.setattr(torch.cuda, "is_bf16_supported", lambda able=able, **_: able)
        assert half_type("cuda", Numbers.AUTO) is kind


def test_bfloat16_takes_nearly_the_same_step() -> None:
    """Loss of the first batch within 2 %: eight bits of mantissa through twenty layers."""
    single, half = start(), start()
    half._half = torch.bfloat16
    assert single.run_epoch() == pytest.approx(half.run_epoch(), rel=0.02)
