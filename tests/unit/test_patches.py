"""Patches: what a network looks at, what it says beyond, and that training and use see the same."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
from collections.abc import Callable

import numpy as np
import pytest
import torch

from sim.forces.network.kernel_maps import Kernel
from sim.forces.network.minkunet import arrays_of, new_network
from sim.forces.network.patches import PatchFinder, PatchPredictor
from sim.forces.network.predictor import Predictor
from sim.forces.network.spec import Target
from sim.forces.network.steady import steady_predictor
from sim.forces.network.turns import any_turn, turn_matrix, value_matrix
from sim.forces.network.voxels import Voxels, voxelise
from sim.forces.network.weights import NetworkWeights, weights_from_bytes, weights_to_bytes
from sim.forces.training.feeds import PatchFeed, Scales, SeenSkin
from sim.forces.training.fields import Fields
from sim.forces.training.scores import network_output
from tests.unit.made_presses import SPEC, made_presses
from workbench.core.base.errors import DesignError, SolveError, StoreError

PRESSES = made_presses(6, edges=(20,))
SKIN = PRESSES.skins[0]
SCALES = Scales(input_mm=0.3, force_N=0.02, output=0.004)
REACH_MM = 2.5


def weights(*, corrects: bool = True, **changes: object) -> NetworkWeights:
    """A network of noise that takes force and looks at patches; its points are 1 mm apart."""
    spec = dataclasses.replace(SPEC, input_channels=6, output_channels=3)
    return NetworkWeights(
        **{
            "spec": spec,
            "arrays": arrays_of(new_network(spec, seed=4)),
            "target": Target.FORCE,
            "input_scale_mm": SCALES.input_mm,
            "output_scale": (SCALES.output,) * 3,
            "voxel_per_spacing": 0.75,
            "spacing_mm": 1.0,
            "force_scale_N": SCALES.force_N,
            "corrects": corrects,
            "patch_spacings": REACH_MM,
            "card": {},
            **changes,
        }
    )


def given(states: list[int]) -> np.ndarray:
    """What enters, of some states."""
    return PRESSES.fields(Target.FORCE, states, takes_force=True).inputs


def corrections(states: list[int]) -> Fields:
    """What a network that corrects learns from, of some states."""
    return PRESSES.fields(Target.FORCE, states, takes_force=True, corrects=True)


def feed_of(fields: Fields) -> PatchFeed:
    """Samples as training takes them."""
    skin = SeenSkin(points_mm=SKIN.points_mm, voxel_mm=0.75, patch_mm=REACH_MM)
    return PatchFeed(
        [(fields, skin)],
        SCALES,
        spec=weights().spec,
        target=Target.FORCE,
        device="cpu",
    )


def feed(states: list[int]) -> PatchFeed:
    """Those of some states."""
    return feed_of(corrections(states))


def test_a_patch_is_what_lies_within_reach_of_the_field() -> None:
    """Against all distances; faint values found no patch, and no field has none."""
    finder = PatchFinder(SKIN.points_mm, reach_mm=REACH_MM)
    field = given([0])[0, :, 3:]
    size = np.abs(field).max(axis=1)
    bearing = SKIN.points_mm[size > 0.01 * size.max()]
    apart = np.linalg.norm(SKIN.points_mm[:, None] - bearing, axis=2).min(axis=1)
    patch = finder.patch(field)
    assert np.array_equal(patch, np.flatnonzero(apart < REACH_MM))
    assert 0 < len(patch) < 0.5 * len(field)
    assert not len(finder.patch(np.zeros_like(field)))
    faint = field.copy()
    faint[np.argmax(apart)] = 0.005 * size.max()
    assert np.array_equal(finder.patch(faint), patch)


def test_beyond_the_patch_the_solvers_force_stays() -> None:
    """A correction ends with the patch; a network that does not correct says zero there."""
    fields = given([1, 2])
    found = steady_predictor(weights(), SKIN.points_mm, SKIN.faces, device="cpu")
    assert isinstance(found, PatchPredictor)
    whole = found.predict(fields)
    assert np.array_equal(whole[0], found.predict(fields[0]))
    finder = PatchFinder(SKIN.points_mm, reach_mm=found._finder.reach_mm)
    alone = steady_predictor(
        weights(corrects=False), SKIN.points_mm, SKIN.faces, device="cpu"
    ).predict(fields)
    for own, bare, enters in zip(whole, alone, fields, strict=True):
        outside = np.ones(len(own), bool)
        outside[finder.patch(enters[:, 3:])] = False
        assert np.array_equal(own[outside], enters[outside, 3:])
        assert not bare[outside].any()
        assert np.allclose(own - enters[:, 3:], bare, atol=1e-7)
        assert np.abs(bare).max() > 1e-4


def test_a_press_that_touches_nothing_has_no_force() -> None:
    """Displaced by nobody: zero in, zero out, whatever the network would say."""
    found = PatchPredictor(weights(), SKIN.points_mm).predict(np.zeros((400, 6), np.float32))
    assert found.shape == (400, 3) and not found.any()


def test_training_sees_what_is_seen_in_use(monkeypatch: pytest.MonkeyPatch) -> None:
    """The network's output on a batch of the feed, point by point that of one look in use."""
    monkeypatch.setattr("sim.forces.network.patches.LOOKS", 1)
    states = [0, 1, 5]
    batch = feed(states).batch(range(3), None)
    network = new_network(weights().spec, seed=4).eval()
    with torch.no_grad():
        rows = network_output(network, batch)[:, 0].numpy() * SCALES.output
    predictor = PatchPredictor(
        weights(corrects=False, patch_spacings=REACH_MM), SKIN.points_mm, faces=None
    )
    predictor._voxel_mm = 0.75
    predictor._finder = PatchFinder(SKIN.points_mm, reach_mm=REACH_MM)
    first = 0
    for enters, length in zip(given(states), batch.lengths, strict=True):
        patch = predictor._finder.patch(enters[:, 3:])
        assert len(patch) == length
        found = predictor.predict(enters)[patch]
        np.testing.assert_allclose(rows[first : first + length], found, atol=2e-6)
        first += length
    assert first == len(rows)


def test_a_turned_sample_is_the_turned_press(monkeypatch: pytest.MonkeyPatch) -> None:
    """Inputs and targets turn together, each sample by its own draw, the same at every asking."""
    drawn: list[np.ndarray] = []

    def noted(rng: np.random.Generator) -> np.ndarray:
        drawn.append(any_turn(rng))
        return drawn[-1]

    monkeypatch.setattr("sim.forces.training.feeds.any_turn", noted)
    own = feed([0, 1])
    rest, turned = own.batch([0, 1], None), own.batch([0, 1], 11)
    start = rest.lengths[0]
    assert torch.equal(own.batch([1], 11).inputs, turned.inputs[start:])
    first, second, same = drawn
    assert np.array_equal(second, same) and not np.allclose(first, second)
    parts = (slice(0, start), slice(start, None))
    for part, matrix in zip(parts, (first, second), strict=True):
        assert np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-14)
        assert np.array_equal(np.abs(matrix[2]), [0.0, 0.0, 1.0])
        for ours, theirs in ((rest.inputs, turned.inputs), (rest.targets, turned.targets)):
            vectors = ours[part, 0].numpy().reshape(-1, 3) @ matrix.T
            found = theirs[part, 0].numpy().reshape(-1, 3)
            np.testing.assert_allclose(found, vectors, atol=1e-6)


def test_several_looks_are_the_mean_of_what_each_says(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the turned press by one look, turned back; stress included, whose six numbers mix."""
    enters = given([1])[0]
    looks = 4
    for target in (Target.FORCE, Target.STRESS):
        spec = dataclasses.replace(SPEC, input_channels=6, output_channels=target.channels)
        one = weights(
            corrects=False,
            spec=spec,
            arrays=arrays_of(new_network(spec, seed=4)),
            target=target,
            output_scale=(SCALES.output,) * target.channels,
        )
        monkeypatch.setattr("sim.forces.network.patches.LOOKS", looks)
        mean = PatchPredictor(one, SKIN.points_mm, faces=SKIN.faces).predict(enters)
        monkeypatch.setattr("sim.forces.network.patches.LOOKS", 1)
        seen = []
        for look in range(looks):
            matrix = turn_matrix(look, 4 * looks)
            predictor = PatchPredictor(one, SKIN.points_mm, faces=SKIN.faces)
            predictor._finder = PatchFinder(
                SKIN.points_mm @ matrix.T, reach_mm=predictor._finder.reach_mm
            )
            shifted = functools.partial(voxelise, shift=look / looks)

            def moved(
                points_mm: np.ndarray,
                *,
                voxel_mm: float,
                shift: float,
                shifted: Callable[..., Voxels] = shifted,
            ) -> Voxels:
                return shifted(points_mm, voxel_mm=voxel_mm)

            monkeypatch.setattr("sim.forces.network.patches.voxelise", moved)
            turned = (enters.reshape(-1, 2, 3) @ matrix.T).reshape(-1, 6).astype(np.float32)
            found = predictor.predict(turned)
            monkeypatch.setattr("sim.forces.network.patches.voxelise", voxelise)
            seen.append(found @ value_matrix(matrix.T, target).T)
        np.testing.assert_allclose(mean, np.mean(seen, axis=0), atol=1e-6)
        assert np.abs(seen[0] - mean).max() > 1e-5


def test_what_a_patch_leaves_out_counts_as_missed() -> None:
    """A force far from all that the solver knows of: its size is in the error of every network."""
    fields = corrections([0])
    far = int(np.argmax(np.linalg.norm(SKIN.points_mm - SKIN.points_mm[0], axis=1)))
    targets = fields.targets.copy()
    patch = PatchFinder(SKIN.points_mm, reach_mm=REACH_MM).patch(fields.inputs[0, :, 3:])
    far = next(point for point in (far, 0, 19) if point not in patch)
    targets[0, far] = [0.01, -0.02, 0.03]
    own = feed_of(dataclasses.replace(fields, targets=targets))
    batch = own.batch([0], None)
    assert batch.values == targets[0].size
    assert float(batch.missed[0]) * SCALES.output == pytest.approx(0.06, rel=1e-5)
    nothing = batch.errors(batch.targets.abs())
    assert float(nothing[0]) * SCALES.output == pytest.approx(np.abs(targets).mean(), rel=1e-5)


def test_samples_that_touch_nothing_count_by_their_target_alone() -> None:
    """In a batch with others and without: no output of the network is in their error."""
    fields = corrections([0, 1])
    inputs = fields.inputs.copy()
    inputs[1] = 0.0
    own = feed_of(dataclasses.replace(fields, inputs=inputs))
    size = np.abs(fields.targets[1]).mean() / SCALES.output
    for samples in ([0, 1], [1]):
        batch = own.batch(samples, 3)
        assert batch.lengths[-1] == 0
        wrong = torch.full(batch.targets.shape, 7.0)
        assert float(batch.errors(wrong)[-1]) == pytest.approx(size, rel=1e-5)
    assert batch.inputs.shape == (1, 1, 6) and not batch.inputs.any()


def test_each_predictor_refuses_weights_of_the_other_kind() -> None:
    """A patch network on the whole skin would answer, and wrongly."""
    with pytest.raises(DesignError, match="look at patches"):
        Predictor(weights(), SKIN.points_mm)
    with pytest.raises(DesignError, match="look at the whole skin"):
        PatchPredictor(weights(patch_spacings=0.0), SKIN.points_mm)


def test_neighbours_gathered_or_in_pairs_say_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """Gathered as on a GPU, in training; in use, see `test_recorded_patches`."""
    fed = feed([1, 2]).batch([0, 1], 5)
    monkeypatch.setattr("sim.forces.training.feeds.kernel_on", lambda device: Kernel.GATHER)
    network = new_network(weights().spec, seed=4).eval()
    gathered = feed([1, 2]).batch([0, 1], 5)
    assert fed.maps.levels[0].blocks and not gathered.maps.levels[0].blocks
    with torch.no_grad():
        outputs = [network_output(network, batch) for batch in (fed, gathered)]
    np.testing.assert_allclose(outputs[0], outputs[1], atol=1e-4)


@pytest.mark.gpu
def test_a_gpu_says_what_a_cpu_says() -> None:
    """Step by step here; there kernel by kernel at first, then recorded."""
    fields = given([0, 1, 2])
    here, found = (
        steady_predictor(weights(), SKIN.points_mm, SKIN.faces, device=device)
        for device in ("cpu", "cuda")
    )
    expected = here.predict(fields)
    for _ in range(3):
        np.testing.assert_allclose(
            found.predict(fields), expected, atol=1e-5 * np.abs(expected).max()
        )
    assert not found.notes


def test_the_file_keeps_the_size_of_the_patch() -> None:
    """And one of before patches has none: it looks at the whole skin."""
    name, content = weights_to_bytes(weights())
    kept = weights_from_bytes(name, content)
    assert kept.patch_spacings == REACH_MM
    _, whole = weights_to_bytes(weights(patch_spacings=0.0))
    line, rest = whole.split(b"\n", 2)[0], whole.split(b"\n", 2)[2]
    older = rest.replace(b'"patch_spacings": 0.0, ', b"")
    digest = hashlib.sha256(older).hexdigest()
    old = line[:-1] + b"1\n" + digest.encode() + b"\n" + older
    assert weights_from_bytes(f"tiny-force-{digest[:16]}.weights", old).patch_spacings == 0.0
    with pytest.raises(StoreError, match="the size of the patch"):
        weights_to_bytes(weights(patch_spacings=float("nan")))


def test_numbers_that_are_not_finite_are_refused() -> None:
    """On the way in, and on the way out."""
    fields = given([1])
    with pytest.raises(SolveError, match="given to the network are not finite"):
        PatchPredictor(weights(), SKIN.points_mm).predict(np.full_like(fields, np.nan))
    large = weights(output_scale=(3e38,) * 3)
    with pytest.raises(SolveError, match="field is not finite"):
        PatchPredictor(large, SKIN.points_mm).predict(1e4 * fields)
