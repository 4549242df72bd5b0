"""The checks behind `validate optics`: they hold, and they notice what is wrong."""

from __future__ import annotations

import dataclasses
import importlib.util
from pathlib import Path

import numpy as np
import pytest

from sim.optics.proof import map_checks, sensor_checks, view_checks
from sim.optics.proof.specimen import finger
from workbench.cli import validate_rooms as validate
from workbench.cli.command_line import main
from workbench.core.base.errors import DesignError, DeviceError
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LightModel
from workbench.core.result.results import MembraneMesh
from workbench.proof.validation.optics import mitsuba_images, mitsuba_witness
from workbench.proof.validation.optics.mitsuba_images import CAMERA, Case, Witness

SMALL = Camera(width_px=160, height_px=120)


@pytest.fixture(scope="module")
def mesh(taichi_device: str) -> MembraneMesh:
    return finger(edge_mm=0.8)


def test_drawing_is_casting(mesh: MembraneMesh) -> None:
    """Every changed pixel sees the same place to a micrometre; a round cavity folds none."""
    found = view_checks.drawing_error(mesh, SMALL, view_checks.standard_dent(mesh.seen))
    assert found.changed > 500 and found.folded_1 == 0.0 and found.disagree_1 == 0.0
    assert found.median_mm < 1e-3 and found.rare_mm < 0.02


def test_places_project_to_the_pixels_that_see_them(mesh: MembraneMesh) -> None:
    """Rays of a finer image to a hundredth of a pixel; without refraction 5 px and more."""
    median, high, null = view_checks.newton_error_px(mesh, SMALL)
    assert median < 0.01 and high < 0.1 and null > 4.0


def test_the_papers_depth_map_beats_the_undeformed_skin(mesh: MembraneMesh) -> None:
    """At index 1: median below 0.02 mm at edges of 0.8 mm, the null 0.1 mm and more."""
    found = view_checks.published_depth_error(mesh, SMALL)
    assert found.median_mm < 0.02 and found.null_median_mm > 0.1
    assert found.missing_1 == 0.0 and found.slower_1 > 1.0


def test_a_changed_still_pixel_is_noticed(mesh: MembraneMesh) -> None:
    """The images pass with 0; one grey level more in a still pixel gives 1."""
    model = LightModel.LINEAR
    frames = view_checks.dented(model, mesh)
    moved = view_checks.standard_dent(mesh.seen)
    still = view_checks.still_pixels(mesh, view_checks.optics_of(model), moved)
    assert 0.8 < still.mean() < 1.0
    assert view_checks.still_difference_grey(frames, still) == 0
    assert view_checks.still_difference_grey(frames, ~still) > 20
    row, column = np.argwhere(still)[0]
    # Modulo 256 the level wraps from 255 to 0, which is a difference as well.
    frames.rgb[1, row, column, 0] += 1
    assert view_checks.still_difference_grey(frames, still) >= 1


def test_the_sensor_checks_hold() -> None:
    """Photon transfer to 1 %, the disc's variance to 2 %, CIE's tables to their fit."""
    error, null = sensor_checks.noise_error()
    assert error < 0.01 and null == 1.0
    spread, light = sensor_checks.defocus_error()
    assert spread < 0.02 and light < 1e-5
    assert sensor_checks.chromaticity_error(sensor_checks.PLANCKIAN) < 0.004
    shifted = {"6500K": (0.3335, 0.3237)}
    assert sensor_checks.chromaticity_error(shifted) > 0.015


def test_a_hertz_dent_is_as_deep_and_as_wide_as_its_formula() -> None:
    """d at the middle, d / 2 at the contact radius, nothing beyond six of them."""
    skin = finger(edge_mm=0.2, cylinder_mm=4.0, radius_mm=8.0).seen
    vertex = int(np.argmin(np.linalg.norm(skin.points_mm - [0.0, 0.0, 12.0], axis=1)))
    moved = np.linalg.norm(map_checks.hertz_dent(skin, vertex, 0.55), axis=1)
    away = np.linalg.norm(skin.points_mm - skin.points_mm[vertex], axis=1)
    assert moved[vertex] == pytest.approx(0.1)
    # The slope there is d / a, 0.18: 0.05 mm beside the rim are 0.009 mm of height.
    rim = np.abs(away - 0.55) < 0.05
    assert rim.any() and moved[rim] == pytest.approx(np.full(rim.sum(), 0.05), abs=0.012)
    assert not moved[away > 6.0 * 0.55].any()
    # Far off it falls as 4 a / (3 pi r), and is faded from half of six radii on.
    far = np.abs(away - 2.9 * 0.55) < 0.05
    expected = 0.1 * 4.0 * 0.55 / (3.0 * np.pi * away[far])
    assert far.any() and moved[far] == pytest.approx(expected, rel=0.03)


@pytest.mark.slow
def test_the_map_of_sensitivity_follows_rendered_dents(taichi_device: str) -> None:
    """Correlation 0.8 or more over ten places."""
    assert map_checks.sensitivity_check().correlation > 0.8


def test_rings_and_octants_divide_the_disc() -> None:
    """Each pixel within 24 px is in one ring and in one octant."""
    rings, octants = (np.sum(masks, axis=0) for masks in (_rings(), mitsuba_witness.octants()))
    assert np.array_equal(rings, octants) and set(np.unique(rings)) == {0, 1}
    # Pixel centres within a circle of radius 24: its area to the pixels of its rim.
    assert rings[:, :, 0].sum() == pytest.approx(np.pi * 24.0**2, rel=0.01)


def _rings() -> list[np.ndarray]:
    return mitsuba_witness.rings()


def flat(traced: float, error: float) -> Witness:
    """Mitsuba sees 1 everywhere."""
    ones = np.ones((CAMERA.height_px, CAMERA.width_px, 3))
    return Witness(
        mitsuba=ones,
        error=error * ones,
        traced=traced * ones,
        product=0.9 * traced * ones,
        direct=0.4 * ones,
        moved=np.zeros(ones.shape[:2], dtype=bool),
    )


def test_the_standard_error_of_a_mean_falls_with_its_pixels() -> None:
    """Pixels of 1 +- 0.2: sqrt(N) 0.2 / N for the N values of a ring."""
    for inside in _rings():
        found = mitsuba_witness.standard_error(flat(1.0, 0.2), inside)
        assert found == pytest.approx(0.2 / np.sqrt(inside.sum()))


def test_a_tracer_that_is_four_percent_low_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """0.98 passes in every ring, 0.96 fails; where Mitsuba is noisy the ratio is only stated."""
    case = Case(index=1.0, dented=False)
    for traced, ok in ((0.98, True), (0.96, False)):
        monkeypatch.setattr(mitsuba_witness, "witness", lambda _, t=traced: flat(t, 0.01))
        rows = mitsuba_witness.case_rows(case)
        assert [row.ok for row in rows] == [ok] * 7
        assert all(row.null == pytest.approx(0.4) for row in rows)
    monkeypatch.setattr(mitsuba_witness, "witness", lambda _: flat(0.9, 3.0))
    *rings, octants = mitsuba_witness.case_rows(case)
    assert all(row.ok and row.limit is None and "not converged" in row.case for row in rings)
    assert not octants.ok


def test_without_mitsuba_one_row_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not a traceback: a failed row with the extra's name."""
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    (row,) = mitsuba_witness.rows()
    assert not row.ok and row.name == "mitsuba"
    assert 'pip install "sensor-workbench[mitsuba]"' in row.case


def test_a_mitsuba_that_stops_is_a_failed_row(tmp_path: Path) -> None:
    """The last line it said is in the message."""
    pytest.importorskip("mitsuba")
    (tmp_path / "scene.xml").write_text("<scene")
    with pytest.raises(DeviceError, match="Mitsuba stopped with"):
        mitsuba_images.render(tmp_path, samples=1, seed=1)


@pytest.mark.slow
def test_photons_and_mitsuba_agree_without_refraction(taichi_device: str) -> None:
    """At index 1 every ring is within 3 %, with few samples of both."""
    pytest.importorskip("mitsuba")
    case = Case(index=1.0, dented=True)
    seen = mitsuba_images.witness(case, photons=1_000_000, samples=40)
    for inside in _rings():
        assert mitsuba_witness.ratio(seen.traced, seen.mitsuba, inside) == pytest.approx(
            1.0, abs=0.03
        )
        assert mitsuba_witness.ratio(seen.direct, seen.mitsuba, inside) < 0.6


def test_an_unknown_reference_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The message names the room and those there are; exit code 2."""
    assert validate.room_of("optics", "mitsuba") == "optics_mitsuba"
    with pytest.raises(DesignError, match="no reference 'blender'") as caught:
        validate.room_of("optics", "blender")
    assert caught.value.at == "--reference" and "mitsuba" in (caught.value.hint or "")
    words = ["validate", "contact", "--reference", "mitsuba", "--project", str(tmp_path)]
    assert main(words) == 2
    assert "the room 'contact' has no reference 'mitsuba'" in capsys.readouterr().err


def test_a_dent_that_no_camera_sees_is_refused(mesh: MembraneMesh) -> None:
    """The images of a dent behind the camera have no contact box."""
    frames = view_checks.dented(LightModel.LINEAR, mesh)
    unmoved = dataclasses.replace(frames, moved=np.zeros_like(frames.moved))
    with pytest.raises(Exception, match="the camera does not see the dent"):
        view_checks.dent_scores(unmoved)
