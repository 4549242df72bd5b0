"""Off-screen pictures are made without a display and without warnings."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from geometry import pictures
from geometry.primitives import rounded_box, sphere
from geometry.surface import vertex_normals
from workbench.core.errors import DeviceError
from workbench.core.fabrication import FabricationPart, MouldSet, PartGroup
from workbench.core.results import Skin

SMALL = (240, 180)


def decoded(png: np.ndarray) -> np.ndarray:
    image = cv2.imdecode(png, cv2.IMREAD_COLOR)
    assert image is not None
    return image


@pytest.mark.slow
def test_mould_and_field_are_drawn(capfd: pytest.CaptureFixture[str]) -> None:
    """White ground, something coloured on it, nothing on stderr."""
    points, faces = rounded_box(5.0, 0.5)
    part = FabricationPart(
        group=PartGroup.MOULD,
        name="half_a",
        points_mm=points,
        faces=faces,
        brep=np.zeros(0, np.uint8),
        volume_mm3=1000.0,
        watertight=True,
        explode=(10.0, 0.0, 0.0),
    )
    moulds = MouldSet(
        parts=(part,),
        split_azimuth_deg=0.0,
        overlap_mm3=0.0,
        thinnest_wall_mm=1.0,
        cast_volume_mm3=1.0,
    )
    ball, triangles = sphere(3.0)
    skin = Skin(points_mm=ball, faces=triangles, normals=vertex_normals(ball, triangles))
    for png in (
        pictures.exploded_mould(moulds, SMALL),
        pictures.skin_field(skin, ball[:, 2], "height [mm]", SMALL),
    ):
        image = decoded(png)
        assert image.shape == (180, 240, 3)
        assert (image[0, 0] == 255).all()
        assert (image.min(axis=2) < 200).mean() > 0.02
    assert capfd.readouterr().err == ""


def test_no_renderer_is_a_device_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """An impossible window: DeviceError with a remedy, and the process lives."""
    monkeypatch.setenv(pictures.WINDOW, "vtkNoSuchWindow")
    monkeypatch.setattr(pictures, "PROBE", "raise SystemExit(1)")
    pictures._window.cache_clear()
    with pytest.raises(DeviceError, match="no off-screen renderer"):
        pictures._window()
    pictures._window.cache_clear()
