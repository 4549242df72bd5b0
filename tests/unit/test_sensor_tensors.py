"""A sensor's frames as tensors beside its frames as arrays: the same forces, images and dots."""

from __future__ import annotations

import numpy as np
import pytest

from tests.unit.test_sensor import BALL_MM, at_tip, small_pack
from workbench.core.base.errors import DesignError, DeviceError
from workbench.sensor.frame import Frame
from workbench.sensor.sensor import Sensor
from workbench.sensor.tensor_frame import TensorFrame

pytestmark = pytest.mark.usefixtures("taichi_device")
torch = pytest.importorskip("torch")

POSES = np.stack([at_tip(-1.0), at_tip(0.6), at_tip(0.3, 0.5)])


@pytest.fixture(scope="module")
def both() -> tuple[Frame, TensorFrame]:
    """The same moment told in both ways, the second move of three sensors."""
    sensor = Sensor(small_pack())
    ball = sensor.object("sphere", size_mm=BALL_MM)
    sensor.render(POSES + np.eye(7)[2] * 0.1, ball)
    before = sensor.state()
    told = sensor.render(POSES, ball)
    looks = told.depth_mm, told.markers_px
    sensor.restore(before)
    left = sensor.render_tensors(torch.from_numpy(POSES), ball)
    assert looks is not None
    return told, left


@pytest.mark.parametrize(
    "name", ["force_N", "torque_Nmm", "displacement_mm", "pressure_MPa", "slip", "within_range"]
)
def test_what_is_felt_is_the_same(both: tuple[Frame, TensorFrame], name: str) -> None:
    """To the last bit, but for the torque's change of origin."""
    told, left = (np.asarray(getattr(frame, name)) for frame in both)
    assert left.shape == told.shape
    assert np.allclose(left, told, rtol=0.0, atol=1e-5 if name == "torque_Nmm" else 0.0)


def test_what_is_seen_is_the_same(both: tuple[Frame, TensorFrame]) -> None:
    """Images within a grey level, as weights are summed in another order; depths and dots."""
    told, left = both
    rgb = left.rgb.numpy()
    assert rgb.shape == told.rgb.shape
    assert np.abs(rgb.astype(int) - told.rgb).max() <= 1
    assert (rgb[0] != rgb[1]).any()
    assert np.allclose(left.depth_mm.numpy(), told.depth_mm, atol=1e-3, equal_nan=True)
    assert np.allclose(left.markers_px.numpy(), told.markers_px, atol=2e-3, equal_nan=True)
    assert np.isfinite(told.markers_px).any()


def test_the_next_frame_leaves_the_last_one_as_it_was() -> None:
    """Tensors are the caller's own, and a single pose is a batch of one."""
    sensor = Sensor(small_pack())
    ball = sensor.object("sphere", size_mm=BALL_MM)
    first = sensor.render_tensors(at_tip(0.5), ball)
    kept = first.force_N.clone(), first.rgb.clone()
    sensor.render_tensors(at_tip(-1.0), ball)
    assert torch.equal(first.force_N, kept[0])
    assert torch.equal(first.rgb, kept[1])
    assert first.force_N.shape == (1, 3)


def test_a_pytorch_without_the_gpu_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A CPU-only build beside a GPU is common: what to install or take instead is said."""
    from sim.optics.light import tensor_device

    monkeypatch.setattr(tensor_device, "computes_on_gpu", lambda: True)
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    with pytest.raises(DeviceError, match="finds no CUDA device"):
        tensor_device.tensor_device()


def test_a_pose_that_is_no_number_is_refused() -> None:
    """As of arrays."""
    sensor = Sensor(small_pack())
    with pytest.raises(DesignError, match="not finite"):
        sensor.feel_tensors(torch.full((2, 7), float("nan")), sensor.object("sphere"))
