"""Off-screen drawings are made without a display, in frame, and without warnings."""

from __future__ import annotations

import itertools
from types import SimpleNamespace
from typing import Any

import cv2
import numpy as np
import pytest

from geometry.drawing import rendering, sensor_drawings
from geometry.drawing.exploded import STACK, exploded
from geometry.surface.primitives import rounded_box, sphere
from geometry.surface.surface import vertex_normals
from workbench.core.base.errors import DeviceError
from workbench.core.result.fabrication import FabricationPart, HousingSet, MouldSet, PartGroup
from workbench.core.result.results import Label, LabelledSurface, Skin, Solid
from workbench.report import report

SMALL = (240, 180)
NOTHING = np.zeros(0, dtype=np.uint8)


def decoded(png: np.ndarray) -> np.ndarray:
    image = cv2.imdecode(png, cv2.IMREAD_UNCHANGED)
    assert image is not None
    return image


def part(name: str, half_mm: float, centre: tuple[float, float, float], **more: Any) -> Any:
    points, faces = rounded_box(half_mm, 0.2 * half_mm)
    return FabricationPart(
        group=PartGroup.SENSOR,
        name=name,
        points_mm=points + np.asarray(centre),
        faces=faces,
        brep=NOTHING,
        volume_mm3=1.0,
        watertight=True,
        **{"explode": (0.0, 0.0, 0.0), **more},
    )


def moulds(azimuth_deg: float) -> MouldSet:
    """Two halves that open along the azimuth, and a core that leaves downward."""
    angle = np.radians(azimuth_deg)
    x, y = float(np.cos(angle)), float(np.sin(angle))
    halves = [
        part(name, 5.0, (sign * 5.0 * x, sign * 5.0 * y, 5.0), pull=(sign * x, sign * y, 0.0))
        for name, sign in (("half_a", 1.0), ("half_b", -1.0))
    ]
    core = part("core", 4.0, (0.0, 0.0, 4.0), pull=(0.0, 0.0, -1.0))
    return MouldSet(
        parts=(*halves, core),
        split_azimuth_deg=azimuth_deg,
        overlap_mm3=0.0,
        thinnest_wall_mm=1.0,
        cast_volume_mm3=1.0,
    )


HOUSING = HousingSet(
    parts=(
        part("support", 3.0, (0.0, 0.0, 3.0)),
        part("led_ring_holder", 2.0, (0.0, 0.0, 0.0)),
        part("camera_mount", 1.0, (0.0, 0.0, -4.0)),
        part("housing_base", 4.0, (0.0, 0.0, -4.0)),
        part("slider_0", 1.0, (5.0, 0.0, 0.0), explode=(10.0, 0.0, 0.0)),
    )
)


def solid(label: Label = Label.OUTER, number: int = -1) -> Solid:
    """A ball as membrane whose upper half has the label and the number."""
    points, faces = sphere(5.0)
    upper = points[faces].mean(axis=1)[:, 2] > 0.0
    membrane = LabelledSurface(
        points_mm=points,
        faces=faces,
        labels=np.where(upper, label | Label.OUTER, Label.OUTER).astype(np.uint8),
        numbers=np.where(upper, number, -1).astype(np.int16),
    )
    return Solid(
        membrane=membrane,
        support=membrane,
        base=membrane,
        outer_brep=NOTHING,
        core_brep=NOTHING,
        membrane_brep=NOTHING,
        support_brep=NOTHING,
        base_brep=NOTHING,
        volume_mm3=1.0,
    )


def expect_in_frame(image: np.ndarray, *, fill: float) -> None:
    """White border, something on it that reaches `fill` of the height or the width."""
    drawn = image.min(axis=2) < 250
    assert not drawn[[0, -1]].any()
    assert not drawn[:, [0, -1]].any()
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    shares = np.ptp(rows) / image.shape[0], np.ptp(columns) / image.shape[1]
    assert max(shares) > fill


@pytest.mark.parametrize("margins", [(0.0, 0.0), (0.0, 0.2), (0.3, 0.1)])
@pytest.mark.parametrize("wide", [True, False])
def test_a_drawing_is_in_the_middle_of_what_its_margins_leave(
    margins: tuple[float, float], wide: bool
) -> None:
    """Of a width of 2 from -1 to 1 that is -1 + 2 left to 1 - 2 right; 1 / 1.06 of it, or of the
    height, is filled."""
    plotter = SimpleNamespace(
        window_size=(400, 250),
        camera=SimpleNamespace(),
        reset_camera_clipping_range=lambda: None,
    )
    # Seen along -X: Y to the right, Z up.
    points = np.random.default_rng(4).uniform(-1.0, 1.0, (50, 3))
    points += [7.0, -3.0, 2.0]
    points *= [1.0, 5.0, 1.0] if wide else [1.0, 1.0, 5.0]
    rendering.look(plotter, np.array([2.0, 0.0, 0.0]), points, margins)
    half_height = plotter.camera.parallel_scale
    across = (points - plotter.camera.focal_point)[:, 1] / (half_height * 400 / 250)
    upward = (points - plotter.camera.focal_point)[:, 2] / half_height
    left, right = -1.0 + 2.0 * margins[0], 1.0 - 2.0 * margins[1]
    assert across.min() + across.max() == pytest.approx(left + right)
    assert upward.min() + upward.max() == pytest.approx(0.0, abs=1e-12)
    if wide:
        assert np.ptp(across) == pytest.approx((right - left) / 1.06)
    else:
        assert np.ptp(upward) == pytest.approx(2.0 / 1.06)


@pytest.mark.parametrize("channels", [3, 4])
def test_a_png_keeps_the_colours_of_the_screen(channels: int) -> None:
    """Red, green, blue and what shows through come back, in OpenCV's order of blue first."""
    screen = np.random.default_rng(2).integers(0, 256, (5, 7, channels), dtype=np.uint8)
    plotter = SimpleNamespace(
        enable_anti_aliasing=lambda kind: None,
        screenshot=lambda **asked: screen,
        close=lambda: None,
    )
    image = decoded(rendering.png(plotter, clear=channels == 4))
    np.testing.assert_array_equal(image[..., 2::-1], screen[..., :3])
    np.testing.assert_array_equal(image[..., 3:], screen[..., 3:])


@pytest.mark.slow
def test_drawings_are_filled_and_not_clipped(capfd: pytest.CaptureFixture[str]) -> None:
    """The body reaches 1 / 1.06 of the drawing (0.9 allows for rounded ends), never its border."""
    ball, triangles = sphere(3.0)
    skin = Skin(points_mm=ball, faces=triangles, normals=vertex_normals(ball, triangles))
    for png in (
        sensor_drawings.exploded_sensor(solid(), moulds(20.0), HOUSING, SMALL),
        sensor_drawings.membrane_drawing(solid(), SMALL, clear=False),
        sensor_drawings.skin_field(skin, ball[:, 2], "height [mm]", SMALL),
    ):
        image = decoded(png)
        assert image.shape == (180, 240, 3)
        expect_in_frame(image, fill=0.9)
    assert capfd.readouterr().err == ""


@pytest.mark.slow
def test_actuators_are_tinted_on_a_clear_ground() -> None:
    """Alpha is 0 in the corner; the driven upper half is blue, the lower half is red."""
    image = decoded(sensor_drawings.membrane_drawing(solid(Label.ACTUATOR, 0), SMALL))
    assert image.shape == (180, 240, 4)
    assert image[0, 0, 3] == 0
    upper, lower = image[40, 120].astype(int), image[150, 120].astype(int)
    assert upper[3] == lower[3] == 255
    assert upper[0] > upper[2] + 40
    assert lower[2] > lower[0] + 40


@pytest.mark.slow
def test_field_is_pale_at_zero_and_dark_at_its_largest() -> None:
    """0 to 1 from the bottom of a ball to its top: the top is darker by half the range."""
    ball, triangles = sphere(3.0)
    skin = Skin(points_mm=ball, faces=triangles, normals=vertex_normals(ball, triangles))
    values = (ball[:, 2] + 3.0) / 6.0
    eye = np.array([1.0, 0.0, 0.0])
    image = decoded(sensor_drawings.skin_field(skin, values, "height", SMALL, eye=eye))
    # The legend takes the right of the drawing; the ball is in the middle of the rest.
    middle = round((1.0 - sensor_drawings.LEGEND_SHARE) / 2.0 * SMALL[0])
    rows = np.flatnonzero(image[:, middle].min(axis=1) < 240)
    top, bottom = (image[row, middle].astype(int) for row in (rows[8], rows[-8]))
    assert top.mean() < bottom.mean() - 50


@pytest.mark.parametrize("azimuth_deg", [0.0, 35.0, 250.0])
def test_exploded_parts_stand_apart(azimuth_deg: float) -> None:
    """The stack goes downward in its order; mould and sensor do not meet across the drawing."""
    places = exploded(solid(), moulds(azimuth_deg), HOUSING, sensor_drawings.EYE)
    assert len(places) == 3 + len(STACK) + 1
    points = {place.name: place.points_mm for place in places}
    for above, below in itertools.pairwise(STACK):
        assert points[above][:, 2].min() > points[below][:, 2].max()
    assert points["core"][:, 2].max() < points["half_a"][:, 2].min()
    right, _ = rendering.screen_axes(sensor_drawings.EYE)
    edge_mm = max((points[name] @ right).max() for name in ("half_a", "half_b", "core"))
    assert edge_mm < min((points[name] @ right).min() for name in (*STACK, "slider_0"))


def test_mould_opens_the_same_way_for_every_split() -> None:
    """From one half to the other the way is the same after splits at 35 and at 250 degrees."""
    ways = []
    for azimuth_deg in (35.0, 250.0):
        first, second, *_ = exploded(solid(), moulds(azimuth_deg), HOUSING, sensor_drawings.EYE)
        way = first.points_mm.mean(axis=0) - second.points_mm.mean(axis=0)
        ways.append(way / np.linalg.norm(way))
    np.testing.assert_allclose(ways[0], ways[1], atol=1e-9)


def test_no_renderer_is_a_device_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """An impossible window: DeviceError with a remedy, and the process lives."""
    monkeypatch.setenv(rendering.WINDOW, "vtkNoSuchWindow")
    monkeypatch.setattr(rendering, "PROBE", "raise SystemExit(1)")
    rendering._window.cache_clear()
    with pytest.raises(DeviceError, match="no off-screen renderer"):
        rendering._window()
    rendering._window.cache_clear()


def test_report_goes_without_drawings_where_nothing_renders(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Neither membrane nor displacement is drawn, and the page says why."""

    def missing() -> str:
        raise DeviceError("no off-screen renderer works here", hint="install libegl1")

    monkeypatch.setattr(rendering, "_window", missing)
    unread: Any = None
    drawn = report.drawings(solid(), unread, unread, None)
    assert (drawn.membrane, drawn.pressed, drawn.parts) == (None, None, None)
    assert "no off-screen renderer" in report._drawn(drawn.pressed, "caption")
