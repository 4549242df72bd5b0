"""Errors keep their fields across processes and carry value, limit, unit and remedy."""

from __future__ import annotations

import pickle

import pytest

from workbench.core.base import errors
from workbench.core.base.errors import DesignError, SolveError, WorkbenchError
from workbench.core.design.camera import Camera
from workbench.core.design.design import Elastomer, Layers, Meshing, SensorDesign
from workbench.core.design.lighting import LedRing
from workbench.core.design.optics import Optics
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.press import ContactSettings, Press

CLASSES = [
    value
    for value in vars(errors).values()
    if isinstance(value, type) and issubclass(value, WorkbenchError)
]


@pytest.mark.parametrize("cls", CLASSES)
def test_fields_survive_pickling(cls: type[WorkbenchError]) -> None:
    """message, hint and at are equal after a round trip."""
    error = pickle.loads(pickle.dumps(cls("what", hint="do", at="field")))
    assert type(error) is cls
    assert (error.message, error.hint, error.at) == ("what", "do", "field")


def test_solve_error_keeps_its_frame() -> None:
    """frame, residual and last_good survive as well."""
    error = pickle.loads(pickle.dumps(SolveError("x", frame=3, residual=0.5, last_good=2)))
    assert (error.frame, error.residual, error.last_good) == (3, 0.5, 2)


def test_exit_codes() -> None:
    """2 bad input, 3 failed computation, 130 cancelled."""
    assert DesignError.exit_code == 2
    assert SolveError.exit_code == errors.StoreError.exit_code == errors.DeviceError.exit_code == 3
    assert errors.Cancelled.exit_code == 130


NAN = float("nan")
BAD = [
    (lambda: Layers(elastomer_mm=0.0), "layers.elastomer_mm", "0 mm is outside 0.2 to 20 mm"),
    (lambda: Elastomer(poisson=0.5), "material.poisson", "0.5 is outside 0 to 0.495"),
    (lambda: Elastomer(young_MPa=-1), "material.young_MPa", "-1 MPa is outside"),
    (lambda: Camera(fov_x_deg=0), "optics.camera.fov_x_deg", "0 degree is outside 5 to 175"),
    (lambda: Camera(fov_x_deg=200), "optics.camera.fov_x_deg", "200 degree is outside"),
    (lambda: Camera(wxyz=(2.0, 0.0, 0.0, 0.0)), "optics.camera.wxyz", "length 2.000"),
    (lambda: Camera(wxyz=(NAN, 0.0, 0.0, 0.0)), "optics.camera.wxyz", "length nan"),
    (lambda: Camera(position_mm=(0.0, NAN, 0.0)), "optics.camera.position_mm", "not a finite"),
    (lambda: Camera(position_mm=(0.0, 0.0, 900.0)), "optics.camera.position_mm", "900 mm"),
    (lambda: LedRing(phase_deg=NAN), "optics.ring.phase_deg", "not a finite number"),
    (lambda: LedRing(tilt_deg=NAN), "optics.ring.tilt_deg", "not a finite number"),
    (lambda: LedRing(count=65), "optics.ring.count", "65 is outside 0 to 64"),
    (lambda: Optics(ring=LedRing(count=0)), "optics.ring.count", "points of light 0 is outside 1"),
    (lambda: LedRing(colours=("red",)), "optics.ring.colours", "'red'"),
    (lambda: Meshing(hex_mm=float("nan")), "meshing.hex_mm", "not a finite number"),
    (lambda: Press(depth_mm=-1), "press.depth_mm", "-1 mm is outside 0 to 50 mm"),
    (lambda: Press(frames=0), "press.frames", "0 is outside 1 to 500"),
    (lambda: Press(target_mm=(0, float("inf"), 0)), "press.target_mm", "not finite"),
    (lambda: Indenter(size_mm=0), "indenter.size_mm", "0 mm is outside"),
    (lambda: Indenter(kind=IndenterKind.MESH), "indenter.mesh", "needs a mesh"),
    (lambda: ContactSettings(grid_mm=0.01), "contact.grid_mm", "0.01 mm is outside 0.1 to 3"),
    (lambda: SensorDesign().replace("optics.lens", 1), "optics.lens", "no field"),
]


@pytest.mark.parametrize(("make", "at", "words"), BAD, ids=[at for _, at, _ in BAD])
def test_refused_value_names_value_limit_unit_and_remedy(make: object, at: str, words: str) -> None:
    """Each bad value has one message, the field and a hint."""
    with pytest.raises(DesignError) as caught:
        make()  # type: ignore[operator]
    assert caught.value.at == at
    assert words in caught.value.message
    assert caught.value.hint
