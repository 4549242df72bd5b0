"""Dents in photographs of a specimen, as networks are shown them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.optics.studio.render import Studio
from sim.reading.reader import Reader
from tests.unit.test_reader import mesh, photographed, pressed, reader, studio
from workbench.core.design.design import Elastomer, SensorDesign
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.store import Store
from workbench.reading import design_reader
from workbench.reading.design_reader import DesignReader
from workbench.tasks.dent_sight import DentSight
from workbench.tasks.networks.patch import GREY_PER_MM

__all__ = ["mesh", "reader", "studio"]
pytestmark = pytest.mark.usefixtures("taichi_device")


def test_a_dent_is_shown_in_grey_levels_of_a_millimetre(
    mesh: MembraneMesh,
    studio: Studio,
    reader: Reader,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    """Half a millimetre is 128 grey levels to a tenth, nothing is 0; each idle is opened once."""
    opened: list[Any] = []

    def open_reader(design: SensorDesign, idle: np.ndarray, store: Store, *, monitor: Any) -> Any:
        opened.append((design.optics.camera.width_px, len(idle)))
        wall_mm = np.full(len(mesh.seen.points_mm), 2.0)
        return DesignReader(reader=reader, mesh=mesh, material=Elastomer(), wall_mm=wall_mm)

    monkeypatch.setattr(design_reader, "open_reader", open_reader)
    sight = DentSight(SensorDesign(), Store(tmp_path))
    idle = photographed(studio, None).astype(np.uint8)
    touched = photographed(studio, pressed(mesh)).astype(np.uint8)
    found, nothing = sight.dent_grey(touched, idle), sight.dent_grey(idle, idle)
    assert found.shape == idle.shape and found.dtype == np.int16
    assert found.max() == pytest.approx(0.5 * GREY_PER_MM, rel=0.1)
    assert (found == found[..., :1]).all()
    assert not nothing.any()
    assert opened == [(160, 120)]
