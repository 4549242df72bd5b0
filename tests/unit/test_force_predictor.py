"""The network in use: what goes in and out, on which device, and what is refused."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import torch

from sim.forces.network import acceleration
from sim.forces.network.acceleration import Acceleration, accelerated
from sim.forces.network.kernel_maps import kernel_maps
from sim.forces.network.minkunet import arrays_of, network_of, new_network
from sim.forces.network.predictor import Precision, Predictor, maps_for_use, working_type
from sim.forces.network.spec import PAPER, SMALL, NetworkSpec, Target
from sim.forces.network.voxels import voxel_edge_mm, voxelise
from sim.forces.network.weights import NetworkWeights
from workbench.core.base.errors import DesignError, DeviceError, SolveError
from workbench.pipeline import devices
from workbench.proof.benchmarks.forces import shell

SPEC = NetworkSpec(name="tiny", planes=(8, 8, 12, 12, 12, 8, 8, 8), stem_planes=8)


def make_weights(spec: NetworkSpec = SPEC) -> NetworkWeights:
    return NetworkWeights(
        spec=spec,
        arrays=arrays_of(new_network(spec, seed=8)),
        target=Target.FORCE,
        input_scale_mm=0.5,
        output_scale=(0.1, 0.2, 0.4),
        voxel_per_spacing=0.75,
        spacing_mm=1.0,
        card={},
    )


def displacement(*shape: int) -> np.ndarray:
    return np.random.default_rng(2).normal(0.0, 0.3, (*shape, 3)).astype(np.float32)


def relative(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.abs(found - expected).max() / np.abs(expected).max())


def by_hand(weights: NetworkWeights, points_mm: np.ndarray, field_mm: np.ndarray) -> np.ndarray:
    """The network in float64 and unfolded, scaled and voxelised step by step."""
    voxels = voxelise(points_mm, voxel_mm=voxel_edge_mm(points_mm))
    features = voxels.mean(torch.from_numpy(field_mm.astype(np.float64))[:, None] / 0.5)
    with torch.no_grad():
        output = network_of(weights).double().eval()(features, kernel_maps(voxels))
    return voxels.to_points(output)[:, 0].detach().numpy() * np.array([0.1, 0.2, 0.4])


def test_prediction_equals_the_network_with_its_scales() -> None:
    """Scales, voxels, folding and points together, against float64: float32 rounding remains."""
    points_mm, field_mm = shell(400), displacement(400)
    weights = make_weights()
    predictor = Predictor(weights, points_mm, precision=Precision.SINGLE)
    found = predictor.predict(field_mm)
    assert found.dtype == np.float32 and found.shape == (400, 3)
    assert relative(found, by_hand(weights, points_mm, field_mm)) < 1e-5


def test_half_precision_stays_within_two_percent() -> None:
    """bfloat16 against float32, relative to the largest force; 0.5 % was measured."""
    points_mm, field_mm = shell(3000), displacement(3000)
    weights = make_weights(SMALL)
    half = Predictor(weights, points_mm, precision=Precision.HALF)
    single = Predictor(weights, points_mm, precision=Precision.SINGLE)
    assert half.dtype is torch.bfloat16
    error = relative(half.predict(field_mm), single.predict(field_mm))
    assert 1e-5 < error < 0.02


def test_batch_equals_separate_predictions() -> None:
    """Three samples at once: samples first, points second."""
    predictor = Predictor(make_weights(), shell(300), precision=Precision.SINGLE)
    batch_mm = displacement(3, 300)
    together = predictor.predict(batch_mm)
    assert together.shape == (3, 300, 3)
    for found, one_mm in zip(together, batch_mm, strict=True):
        assert relative(found, predictor.predict(one_mm)) < 1e-5


def test_predictions_repeat_bit_by_bit() -> None:
    """Two calls, and a second predictor, give the same bits."""
    field_mm = displacement(300)
    predictor = Predictor(make_weights(), shell(300))
    first = predictor.predict(field_mm)
    np.testing.assert_array_equal(predictor.predict(field_mm), first)
    np.testing.assert_array_equal(Predictor(make_weights(), shell(300)).predict(field_mm), first)


def test_result_is_not_overwritten_by_the_next_call() -> None:
    """Fields that a caller keeps stay as they were."""
    predictor = Predictor(make_weights(), shell(200))
    first = predictor.predict(displacement(200))
    kept = first.copy()
    predictor.predict(np.zeros((200, 3), np.float32))
    np.testing.assert_array_equal(first, kept)


def test_fields_that_are_not_finite_are_refused() -> None:
    """Two NaN in a displacement; and weights whose output leaves float32."""
    predictor = Predictor(make_weights(), shell(200))
    field_mm = displacement(200)
    field_mm[7, :2] = np.nan
    with pytest.raises(SolveError, match="2 of 600") as caught:
        predictor.predict(field_mm)
    assert caught.value.at == "given"
    weights = dataclasses.replace(make_weights(), output_scale=(1e38, 1e38, 1e38))
    with pytest.raises(SolveError, match="field is not finite"):
        Predictor(weights, shell(200)).predict(100.0 * displacement(200))


def test_wrong_shapes_and_clouds_are_refused() -> None:
    """Another number of points is a bug of the caller; a NaN point is bad input."""
    with pytest.raises(ValueError, match="given"):
        Predictor(make_weights(), shell(200)).predict(displacement(201))
    with pytest.raises(DesignError):
        Predictor(make_weights(), np.full((10, 3), np.nan, np.float32), faces=np.zeros((1, 3), int))


def test_full_device_is_a_device_error_with_a_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    """PyTorch's out-of-memory error, raised in the middle of a prediction."""
    predictor = Predictor(make_weights(), shell(200))

    def full(*_: object) -> torch.Tensor:
        raise torch.OutOfMemoryError("CUDA out of memory")

    monkeypatch.setattr(predictor.voxels.__class__, "to_points", full)
    with pytest.raises(DeviceError, match="no memory left") as caught:
        predictor.predict(displacement(200))
    assert "fewer samples" in caught.value.hint


def test_types_follow_device_and_wish() -> None:
    """float32 on request everywhere; half is float16 on CUDA and bfloat16 on a CPU."""
    assert working_type("cuda", Precision.SINGLE) is torch.float32
    assert working_type("cuda", Precision.AUTO) is torch.float16
    assert working_type("cpu", Precision.HALF) is torch.bfloat16
    assert working_type("cpu", Precision.SINGLE) is torch.float32


@pytest.mark.parametrize("able", [False, True])
def test_cpu_without_bfloat16_uses_float32(able: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Emulated bfloat16 would be slower."""
    monkeypatch.setattr(torch.cpu, "get_capabilities", lambda: {"avx512_bf16": able})
    expected = torch.bfloat16 if able else torch.float32
    assert working_type("cpu", Precision.AUTO) is expected


class OnCuda:
    """Stands for a tensor on a CUDA device."""

    device = torch.device("cuda")


def test_missing_compiler_gives_way_to_recording_and_says_so(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The note is the first line of what the compiler said; recording is kept."""

    def no_compiler(*_: object, **__: object) -> None:
        raise RuntimeError("Failed to find C compiler.\nlong story")

    monkeypatch.setattr(torch, "compile", no_compiler)
    monkeypatch.setattr(acceleration, "_recorded", lambda function, example: function)
    _, way, note = accelerated(abs, OnCuda(), acceleration=Acceleration.AUTO)  # type: ignore[arg-type]
    assert way is Acceleration.GRAPH
    assert note == "the network runs uncompiled: Failed to find C compiler."


def test_failed_recording_gives_way_to_plain_kernels(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also said; but no memory is an error, not a reason for something slower."""

    def fails(error: Exception) -> None:
        def record(*_: object) -> None:
            raise error

        monkeypatch.setattr(acceleration, "_recorded", record)

    fails(RuntimeError("operation not permitted when stream is capturing"))
    _, way, note = accelerated(abs, OnCuda(), acceleration=Acceleration.GRAPH)  # type: ignore[arg-type]
    assert way is Acceleration.EAGER and "kernel by kernel" in note
    fails(torch.OutOfMemoryError("full"))
    with pytest.raises(torch.OutOfMemoryError):
        accelerated(abs, OnCuda(), acceleration=Acceleration.GRAPH)  # type: ignore[arg-type]


def test_every_membrane_is_compiled_not_the_first_eight(monkeypatch: pytest.MonkeyPatch) -> None:
    """Twelve functions with the same code: PyTorch alone would compile eight."""
    compiled: list[int] = []

    def count(graph: torch.fx.GraphModule, _: object) -> torch.fx.GraphModule:
        compiled.append(1)
        return graph

    compile_with = torch.compile
    monkeypatch.setattr(torch, "compile", lambda f, **rest: compile_with(f, backend=count, **rest))
    torch.compiler.reset()
    for size in range(12):
        values = torch.ones(size + 1)
        acceleration._compiled(lambda x, values=values: x + values.sum(), torch.ones(size + 1))
    torch.compiler.reset()
    assert len(compiled) == 12


def test_rule_of_pairs_looks_at_voxels_and_width() -> None:
    """In bfloat16: pairs at the two finest levels of the published network at 5,000 points, nowhere
    at 1,000 points or in the small network; in float32 everywhere."""
    for points, spec, expected in ((5000, PAPER, 2), (1000, PAPER, 0), (5000, SMALL, 0)):
        points_mm = shell(points)
        voxels = voxelise(points_mm, voxel_mm=voxel_edge_mm(points_mm))
        maps = maps_for_use(voxels, torch.bfloat16, spec)
        assert [bool(level.blocks) for level in maps.levels] == [n < expected for n in range(5)]
        assert all(level.blocks for level in maps_for_use(voxels, torch.float32, spec).levels)


@pytest.mark.gpu
@pytest.mark.slow
@pytest.mark.parametrize("way", [Acceleration.EAGER, Acceleration.GRAPH, Acceleration.COMPILED])
def test_cuda_equals_the_cpu(way: Acceleration) -> None:
    """float32 to rounding, float16 within 0.5 % of the largest force, call after call."""
    points_mm, fields_mm = shell(2000), displacement(3, 2000)
    weights = make_weights(SMALL)
    expected = Predictor(weights, points_mm, precision=Precision.SINGLE).predict(fields_mm)
    for precision, limit in ((Precision.SINGLE, 1e-4), (Precision.HALF, 5e-3)):
        predictor = Predictor(
            weights, points_mm, device="cuda", precision=precision, acceleration=way
        )
        assert relative(predictor.predict(fields_mm), expected) < limit
        for field_mm, wanted in zip(fields_mm, expected, strict=True):
            assert relative(predictor.predict(field_mm), wanted) < limit
        assert predictor.notes == () and predictor.acceleration is way


def test_torch_device_follows_driver_build_and_wish(monkeypatch: pytest.MonkeyPatch) -> None:
    """A GPU that this build cannot use is passed over, unless it was asked for by name."""
    monkeypatch.setattr(devices, "cuda_count", lambda: 1)
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    monkeypatch.delenv(devices.VARIABLE, raising=False)
    assert devices.torch_device() == "cpu"
    monkeypatch.setenv(devices.VARIABLE, "cuda")
    with pytest.raises(DeviceError, match="finds no CUDA device"):
        devices.torch_device()
    monkeypatch.setattr(torch.cuda, "is_available", lambda: True)
    assert devices.torch_device() == "cuda"
    monkeypatch.setenv(devices.VARIABLE, "cpu")
    assert devices.torch_device() == "cpu"
