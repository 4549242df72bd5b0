"""What is pressed into a twin, which frames become photographs, and what their tables say."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometry.surface.surface import vertex_areas_mm2
from tests.unit.test_dataset_cases import flat_skin
from workbench.calibration.seen.photo_set import read_photo_set
from workbench.core.base.errors import DesignError
from workbench.core.result.force_field import ForceField, Source
from workbench.learning.dataset.sequences import FRAMES
from workbench.project.named_designs import load_design
from workbench.twin.cases import PRESS_FRAMES, Ground, Kind, case
from workbench.twin.draw import draw_twin
from workbench.twin.stage import EACH_MM, TURN_DEG, ZERO_MM, draw_stage
from workbench.twin.taking import ball_row, label_row, onset, photos_of
from workbench.twin.truth import Truth, read_truth, write_truth
from workbench.twin.twin_folder import TwinFolder, open_folder
from workbench.twin.twin_plan import Solver, TwinPlan

PAD = load_design("pad")
TWIN = draw_twin(PAD, 7)
GROUND = Ground(places_mm=flat_skin(8.0, 0.5).points_mm)
PLAN = TwinPlan(seed=7)
SQUARE = flat_skin(5.0, 10.0)


def field(frames: int, share: np.ndarray | None = None) -> ForceField:
    """A path on four vertices."""
    none: dict[str, Any] = dict.fromkeys(("residual", "balance"), np.zeros(frames))
    return ForceField(
        source=Source.FEM,
        displacement_mm=np.zeros((frames, 4, 3), np.float32),
        contact_force_N=np.zeros((frames, 4, 3), np.float32),
        reaction_N=np.outer(np.arange(1.0, frames + 1.0), [0.0, 0.0, 0.1]),
        target_mm=np.array([1.0, 2.0, 3.0]),
        normal=np.array([0.0, 0.0, 1.0]),
        tangent_u=np.array([1.0, 0.0, 0.0]),
        indenter_pose=np.zeros((frames, 7)),
        converged=np.ones(frames, bool),
        pressure_MPa=np.full((frames, 4), 0.02, np.float32),
        sliding_share=np.zeros(frames) if share is None else share,
        **none,
    )


def test_paths_are_the_same_however_many_are_made() -> None:
    """Path 5 follows from seed and number alone; the ball is printed, other objects are not."""
    for kind in Kind:
        one, again = (case(TWIN, PLAN, GROUND, kind, 5) for _ in range(2))
        assert (one.press, one.place, one.name) == (again.press, again.place, again.name)
    ball = case(TWIN, PLAN, GROUND, Kind.CALIBRATION, 0)
    assert ball.indenter.texture.raised
    assert ball.indenter.size_mm == 6.0 + TWIN.ball_error_mm
    assert not case(TWIN, PLAN, GROUND, Kind.PRESS, 0).indenter.texture.raised


def test_objects_and_places_meet_in_all_pairs() -> None:
    """Twelve objects at twenty-five places: no object belongs to a place."""
    cases = [case(TWIN, PLAN, GROUND, Kind.PRESS, number) for number in range(60)]
    assert len({each.name for each in cases}) == 12
    assert len({each.place for each in cases}) == 25
    assert len({(each.name, each.place) for each in cases}) == 60
    depths = [each.depth_at_mm(frame) for each in cases for frame in range(PRESS_FRAMES)]
    assert 0.3 <= min(depths)
    assert max(depths) <= 1.0


def test_calibration_places_lie_apart() -> None:
    """Ten balls on 8 x 8 mm, none nearer to another than 1.5 mm."""
    places = np.array(
        [case(TWIN, PLAN, GROUND, Kind.CALIBRATION, number).press.target_mm for number in range(10)]
    )
    away = np.linalg.norm(places[:, None] - places[None], axis=2) + 10.0 * np.eye(10)
    assert away.min() > 1.5


def test_a_slide_gives_eight_frames_before_gross_slip_and_eight_that_end_in_it() -> None:
    """The rule of data sets, on shares that are known: onset in frame 12."""
    slide = case(TWIN, PLAN, GROUND, Kind.SLIDE, 0)
    share = np.linspace(0.0, 0.9, 24)
    share[12:] = 1.0
    assert onset(slide, share) == 12
    taken = photos_of(TWIN, slide, field(24, share))
    hold, slip = ([each for each in taken if each.slip is slips] for slips in (False, True))
    for each in (hold, slip):
        assert len(each) == FRAMES
        assert np.diff([photo.frame for photo in each]).tolist() == [1] * (FRAMES - 1)
    assert hold[-1].frame < 12 <= slip[-1].frame
    assert len({photo.number for photo in taken}) == len({photo.name for photo in taken}) == 16
    rows = [label_row(photo, field(24, share), SQUARE) for photo in taken]
    assert {row["slip"] for row in rows} == {"0", "1"}
    assert len({row["sequence"] for row in rows}) == 2
    assert photos_of(TWIN, slide, field(24, np.full(24, 0.3))) == []


def test_a_pure_press_that_slides_at_first_touch_is_no_slip() -> None:
    """Only frames of the drag count."""
    slide = case(TWIN, PLAN, GROUND, Kind.SLIDE, 0)
    share = np.zeros(24)
    share[:4] = 1.0
    assert onset(slide, share) is None


def test_labels_say_force_on_the_membrane_and_depth_of_the_frame() -> None:
    """Minus the force on the object; depth grows by thirds."""
    press = case(TWIN, PLAN, GROUND, Kind.PRESS, 3)
    rows = [label_row(each, field(3), SQUARE) for each in photos_of(TWIN, press, field(3))]
    assert [float(row["force_z_N"]) for row in rows] == pytest.approx([-0.1, -0.2, -0.3])
    thirds = press.press.depth_mm * np.array([1.0, 2.0, 3.0]) / 3.0
    assert [float(row["depth_mm"]) for row in rows] == pytest.approx(thirds.tolist(), abs=1e-4)
    assert "slip" not in rows[0]


@pytest.mark.parametrize("edge_mm", [0.25, 0.5])
def test_the_peak_of_a_label_knows_no_mesh(edge_mm: float) -> None:
    """.1 N on one vertex are .1 / pi MPa on the disc whatever its area, .02 MPa all over .02."""
    press = case(TWIN, PLAN, GROUND, Kind.PRESS, 3)
    taken, skin = photos_of(TWIN, press, field(3))[0], flat_skin(8.0, edge_mm)
    middle = int(np.argmin(np.linalg.norm(skin.points_mm, axis=1)))
    sharp_N, even_N = np.zeros((2, 3, len(skin.points_mm), 3))
    sharp_N[:, middle, 2] = -0.1
    even_N[:, :, 2] = -0.02 * vertex_areas_mm2(skin.points_mm, skin.faces)
    for forces_N, peak_MPa in ((sharp_N, 0.1 / np.pi), (even_N, 0.02)):
        row = label_row(taken, dataclasses.replace(field(3), contact_force_N=forces_N), skin)
        assert float(row["peak_MPa"]) == pytest.approx(peak_MPa, rel=0.05)


def test_a_calibration_folder_is_one_that_calibrate_reads(tmp_path: Path) -> None:
    """Diameter as typed, place as the stage says; depth, circle and force stay unknown."""
    folder = TwinFolder(path=tmp_path)
    image = np.full((24, 32, 3), 90, np.uint8)
    folder.write_photo(Kind.CALIBRATION, "idle.png", image)
    stage, rows = draw_stage(TWIN.seed), []
    for number in range(5):
        ball = case(TWIN, PLAN, GROUND, Kind.CALIBRATION, number)
        rows.append(ball_row(photos_of(TWIN, ball, field(2))[0], field(2), 6.0, stage))
    for row in rows:
        folder.write_photo(Kind.CALIBRATION, row["photo"], image)
    folder.write_table(Kind.CALIBRATION, rows)
    read = read_photo_set(folder.photos(Kind.CALIBRATION))
    assert [photo.ball_mm for photo in read.photos] == [6.0] * 5
    assert all(photo.depth_mm is None and photo.circle is None for photo in read.photos)
    for number, photo in enumerate(read.photos):
        told = stage.told_mm(field(2).target_mm, number)
        assert photo.place_mm == pytest.approx(told, abs=1e-3)


def test_a_stage_is_off_in_all_places_alike() -> None:
    """By its zero and a turn, and by .03 mm in each; another twin has another."""
    stage, places = draw_stage(3), np.random.default_rng(0).uniform(-10.0, 30.0, (400, 3))
    places.flags.writeable = False
    told = np.array([stage.told_mm(place, k) for k, place in enumerate(places)])
    axis, angle = np.radians(stage.turn_deg), np.linalg.norm(np.radians(stage.turn_deg))
    cross = np.cross(np.eye(3), axis / angle)
    rotation = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    assert rotation @ axis == pytest.approx(axis)
    # What is turned one way is told as turned the other way.
    off = told - places @ rotation - stage.zero_mm
    assert np.abs(off).max() < 5.0 * EACH_MM and off.std() == pytest.approx(EACH_MM, rel=0.1)
    assert np.abs(stage.zero_mm).max() <= ZERO_MM and np.abs(stage.turn_deg).max() <= TURN_DEG
    assert draw_stage(4).zero_mm != stage.zero_mm and draw_stage(3) == stage


def test_another_twin_is_refused_and_the_same_goes_on(tmp_path: Path) -> None:
    """Another seed or contact is another twin; more photographs are not."""
    open_folder(tmp_path, TWIN, PAD, PLAN)
    open_folder(tmp_path, TWIN, PAD, dataclasses.replace(PLAN, presses=3, jobs=4))
    for other in (
        dataclasses.replace(PLAN, seed=8),
        dataclasses.replace(PLAN, contact=Solver.MPM),
    ):
        with pytest.raises(DesignError, match="another twin"):
            open_folder(tmp_path, TWIN, PAD, other)


def test_truth_is_read_as_it_was_written(tmp_path: Path) -> None:
    """And what is none is refused by its name."""
    points, faces = np.eye(3, dtype=np.float32), np.array([[0, 1, 2]], np.int32)
    truth = Truth(
        rest_mm=points,
        displaced_mm=points + 0.5,
        faces=faces,
        normals=points,
        pressure_MPa=np.ones(3, np.float32),
        contact_force_N=points,
        force_N=np.array([0.0, 0.0, -1.0]),
        object_pose=np.zeros(7),
        target_mm=np.zeros(3),
        depth_mm=0.4,
        object_name="cube",
    )
    write_truth(tmp_path, "a", truth)
    read = read_truth(tmp_path / "truth" / "a.npz")
    assert (read.depth_mm, read.object_name) == (0.4, "cube")
    np.testing.assert_array_equal(read.displaced_mm, truth.displaced_mm)
    (tmp_path / "b.npz").write_bytes(b"none")
    with pytest.raises(DesignError, match=r"b\.npz"):
        read_truth(tmp_path / "b.npz")


def test_a_plan_is_refused_beyond_its_limits() -> None:
    """With value and limit."""
    with pytest.raises(DesignError, match="-1"):
        TwinPlan(presses=-1)
    assert TwinPlan().photons("cuda") == 64_000_000
    assert TwinPlan(photons_millions=2).photons("cpu") == 2_000_000
