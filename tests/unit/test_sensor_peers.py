"""MuJoCo's tactile sensor beside ours: what is timed touches, and what it returns."""

from __future__ import annotations

import numpy as np
import pytest

from tests.unit.test_sensor import BALL_MM, small_pack
from workbench.proof.benchmarks import sensor as bench
from workbench.proof.benchmarks import sensor_peers
from workbench.proof.judge import judge
from workbench.sensor.sensor import Sensor

pytestmark = pytest.mark.usefixtures("taichi_device")


def test_rows_of_peers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rates of all; a spring that a heavy ball makes stiff, and a skin that knows no mass."""
    pytest.importorskip("mujoco")
    # What is timed is run once.
    monkeypatch.setattr(sensor_peers, "median_s", lambda run: run() or 0.5)
    sensor = Sensor(small_pack())
    poses = bench.poses(sensor.object("sphere", size_mm=BALL_MM), 4)
    rows = sensor_peers.rows(sensor, poses)
    assert all(judge(row.name, row.case) for row in rows)
    rates = [row.value for row in rows if row.unit == "1/s"]
    assert rates == [8.0, 8.0, 8.0, 8.0]
    light_N, heavy_N = (row.value for row in rows if row.name == "sensor_peer_force")
    assert light_N is not None
    assert heavy_N == pytest.approx(100.0 * light_N, rel=1e-3)
    (skin,) = (row.value for row in rows if row.name == "sensor_force")
    assert skin is not None and skin > 0.1


def test_the_timed_ball_meets_taxels() -> None:
    """In every frame some stand in the ball, the deepest as deep as the benchmark says."""
    pytest.importorskip("mujoco")
    sensor = Sensor(small_pack())
    poses = bench.poses(sensor.object("sphere", size_mm=BALL_MM), 40)
    model, data = sensor_peers._simulated(sensor, touch=True)
    for pose in poses[::8]:
        sensor_peers._followed(model, data, pose[None])
        depth_mm = 1e3 * data.sensordata.reshape(3, -1)[0]
        # Between vertices 1 mm apart the dome is deeper than at them.
        assert depth_mm.max() == pytest.approx(bench.DEPTH_MM, abs=0.15)
        assert np.count_nonzero(depth_mm) > 5
