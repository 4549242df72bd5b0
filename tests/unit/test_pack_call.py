"""The pack that the page asks for: one archive, which opens as a sensor once it is unpacked."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.unit.test_sensor import BALL_MM, TIP_MM, small_pack
from workbench.core.base.monitor import silent
from workbench.core.design.design import SensorDesign
from workbench.pipeline.store import Store
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.sensor import calls
from workbench.sensor.calls import WritePack
from workbench.sensor.pack import write_pack
from workbench.sensor.sensor import Sensor

pytestmark = pytest.mark.usefixtures("taichi_device")


def test_the_archive_opens_as_a_sensor(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It lies in the project under the design's name; its folder reads as the pack does."""
    asked: dict[str, Any] = {}

    def export(design: SensorDesign, folder: Path, project: Project, **named: Any) -> list[Path]:
        asked.update(named, name=design.name, project=project.folder)
        named["monitor"]("press", 0.5, "half")
        return write_pack(small_pack(), folder, {"outer.stl": b"solid"})

    monkeypatch.setattr(calls, "export_pack", export)
    told: list[float] = []
    call = WritePack(design=load_design("geltip"), project=tmp_path, width_px=96)
    made = call.answer(Store(tmp_path), {}, lambda fraction, note="": told.append(fraction))
    assert made == tmp_path / "packs" / "geltip.zip" and told == [0.5]
    assert (asked["name"], asked["project"], asked["width_px"]) == ("geltip", tmp_path, 96)
    with zipfile.ZipFile(made) as archive:
        archive.extractall(tmp_path / "elsewhere")
    sensor = Sensor.load(tmp_path / "elsewhere" / "geltip")
    pose = np.array([0.0, 0.0, TIP_MM + 0.5 * BALL_MM - 0.4, 1.0, 0.0, 0.0, 0.0])
    direct = Sensor(small_pack())
    frames = [s.render(pose, s.object("sphere", size_mm=BALL_MM)) for s in (sensor, direct)]
    assert frames[0].force_N[0, 2] > 0.05
    assert np.abs(frames[0].force_N - frames[1].force_N).max() < 1e-2 * frames[1].force_N[0, 2]
    again = call.answer(Store(tmp_path), {}, silent)
    assert again == made, "a pack made anew takes the place of the one before"
