"""Places that a stage knows: what they say of the camera, against closed forms and by recovery."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from sim.optics.proof.specimen import finger
from workbench.calibration import known_places
from workbench.calibration.ball_presses import BallPress
from workbench.calibration.derivatives import Fit, Task
from workbench.calibration.gauss_newton import normal_equations
from workbench.calibration.known_places import EACH_MM, STEP_PX, ZERO_MM, place_misfit, place_rows
from workbench.calibration.light_basis import LightBasis
from workbench.calibration.photo_rows import Slopes
from workbench.calibration.powers import Powers
from workbench.calibration.seen.photo_set import BallPhoto, Circle
from workbench.calibration.seen.seen_places import SeenPlaces
from workbench.calibration.unknowns import Kind, Scene, moved_scene, unknowns
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera
from workbench.core.design.design import SensorDesign
from workbench.core.design.lighting import Lamp
from workbench.core.design.optics import Coating, Optics
from workbench.core.result.results import MembraneMesh

CAMERA = Camera(width_px=160, height_px=120)
OF_CAMERA = Kind.CAMERA_PLACE, Kind.CAMERA_TURN
CIRCLES = [
    Circle(column_px=float(column), row_px=float(row), radius_px=8.0)
    for column, row in ((30, 20), (80, 15), (130, 25), (25, 60), (80, 60), (135, 62), (40, 100))
]
MISSING: Any = None
"""Of what lights and stores are: places need neither."""


@pytest.fixture(scope="module")
def mesh() -> MembraneMesh:
    return finger(edge_mm=0.8)


def photo(number: int, place_mm: np.ndarray | None) -> BallPhoto:
    return BallPhoto(
        name=f"p{number}.png",
        image=np.zeros((120, 160, 3), np.uint8),
        ball_mm=6.0,
        circle=None,
        place_mm=place_mm,
        depth_mm=None,
        force_N=None,
        held_out=False,
    )


def task_of(mesh: MembraneMesh, seen: SeenPlaces, off_mm: np.ndarray, known: int) -> Task:
    """Circles where a camera sees them, the first of them told by a stage that is off."""
    presses = []
    for number, circle in enumerate(CIRCLES):
        place = seen.place(circle, "p")
        told = place.point_mm + off_mm if number < known else None
        presses.append(
            BallPress(
                photo=photo(number, told),
                place=place,
                least_mm=0.1,
                most_mm=1.0,
                guess_mm=0.5,
                depths_mm=np.array([0.0, 1.0]),
                displacement_mm=np.zeros((2, len(mesh.seen.points_mm), 3), np.float32),
                normal_N=np.zeros(2),
            )
        )
    scene = Scene(camera=CAMERA, coating=Coating(), lights=(Lamp(),))
    return Task(
        design=SensorDesign(optics=Optics(camera=CAMERA)),
        mesh=mesh,
        store=MISSING,
        scene=scene,
        among=tuple(u for u in unknowns(scene, known=False) if u.kind in OF_CAMERA),
        presses=tuple(presses),
        boxes=tuple(CIRCLES),
        targets=MISSING,
        images=(),
    )


def fit_at(task: Task, values: np.ndarray) -> Fit:
    scene, values = moved_scene(task.scene, task.among, values, task.mesh)
    nothing = Powers(
        lights=np.zeros((3, 0)),
        ambient=np.zeros(3),
        depths_mm=np.zeros(len(CIRCLES)),
        error_grey=0.0,
        null_grey=0.0,
    )
    basis: LightBasis = MISSING
    return Fit(values=values, scene=scene, circles=task.boxes, basis=basis, powers=nothing)


def slopes_at(task: Task, fit: Fit) -> list[Slopes]:
    """By differences of the places alone."""
    found = []
    now = known_places._seen_mm(task, fit)
    for number, each in enumerate(task.among):
        values = fit.values.copy()
        values[number] += each.step
        moved = known_places._seen_mm(task, fit_at(task, values))
        slope_mm = (moved - now) / each.step
        found.append(Slopes(rest=np.zeros((0, 3)), presses=(), places_mm=slope_mm))
    return found


def test_a_stage_finds_the_camera(mesh: MembraneMesh) -> None:
    """Half a millimetre and a degree off: found to .05 mm and .1 degree, and misfit goes to 0."""
    hidden = np.array([0.4, -0.5, 0.3, 1.0, -0.7, 0.5])
    fit, count = (
        fit_at(task_of(mesh, SeenPlaces(mesh, Optics(camera=CAMERA)), np.zeros(3), 0), hidden),
        len(CIRCLES),
    )
    seen = SeenPlaces(mesh, Optics(camera=fit.scene.camera))
    task = task_of(mesh, seen, np.zeros(3), count)
    now = fit_at(task, np.zeros(6))
    assert place_misfit(task, now) > 20.0
    # Circles are right, and nothing else is known of the camera.
    prior_sd = np.concatenate([np.full(6, 10.0), np.full(3 * count, 1e-9)])
    for _ in range(4):
        rows = place_rows(task, now, slopes_at(task, now))
        before = np.concatenate([now.values, np.zeros(3 * count)])
        step = normal_equations(rows, before, prior_sd).step()
        now = fit_at(task, now.values + step[:6])
    assert now.values[:3] == pytest.approx(hidden[:3], abs=0.05)
    assert now.values[3:] == pytest.approx(hidden[3:], abs=0.1)
    assert place_misfit(task, now) < 0.1


def test_rows_are_the_derivatives_of_the_misfit(mesh: MembraneMesh) -> None:
    """By a pixel's shift of each circle, of which five of seven are known: others have no row."""
    task = task_of(mesh, SeenPlaces(mesh, Optics(camera=CAMERA)), np.array([0.3, -0.2, 0.1]), 5)
    fit, count = fit_at(task, np.zeros(6)), len(CIRCLES)
    (rows,) = place_rows(task, fit, slopes_at(task, fit))
    assert rows.slope.shape == (10, 6 + 10) and rows.residual.shape == (10,)
    for column, value in zip(rows.slope.T, rows.value, strict=True):
        axis, k = divmod(int(value) - 6 - count, count)
        if axis < 0:
            continue
        name, circles = ("column_px", "row_px")[axis], list(fit.circles)
        circles[k] = dataclasses.replace(circles[k], **{name: getattr(circles[k], name) + STEP_PX})
        moved = place_misfit(task, dataclasses.replace(fit, circles=tuple(circles)))
        assert moved == pytest.approx(float(((rows.residual + column) ** 2).sum()), rel=1e-6)


def test_a_zero_that_is_off_counts_once(
    mesh: MembraneMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All places off alike by d along z: (d / deviation)^2 once, not once for each place.

    Of K sides along z with lengths t the mean is known to s / |t| besides the zero, so the misfit
    is d^2 |t|^2 / (s^2 + z^2 |t|^2): Sherman and Morrison's formula.
    """
    monkeypatch.setattr(known_places, "TURN_DEG", 0.0)
    off_mm = 0.2
    task = task_of(mesh, SeenPlaces(mesh, Optics(camera=CAMERA)), np.array([0.0, 0.0, off_mm]), 7)
    # Only what lies along z of each place's tangents is off; x and y of the zero are other values.
    sides = known_places._tangents(task).reshape(-1, 3)
    covariance = EACH_MM**2 * np.eye(14) + ZERO_MM**2 * sides @ sides.T
    told = off_mm * sides[:, 2]
    expected = told @ np.linalg.solve(covariance, told)
    found = place_misfit(task, fit_at(task, np.zeros(6)))
    assert found == pytest.approx(expected, rel=1e-6)
    assert found < (off_mm / ZERO_MM) ** 2, "the zero alone explains it"
    one = task_of(mesh, SeenPlaces(mesh, Optics(camera=CAMERA)), np.array([0.0, 0.0, off_mm]), 1)
    assert place_misfit(one, fit_at(one, np.zeros(6))) < found


def test_without_a_stage_nothing_is_added(mesh: MembraneMesh) -> None:
    """Neither to the misfit nor to the rows."""
    task = task_of(mesh, SeenPlaces(mesh, Optics(camera=CAMERA)), np.zeros(3), 0)
    fit = fit_at(task, np.full(6, 0.2))
    assert place_misfit(task, fit) == 0.0 and place_rows(task, fit, slopes_at(task, fit)) == []


def test_a_contact_is_where_the_stage_was(mesh: MembraneMesh) -> None:
    """On the skin below the told place, with the radius that is seen; far from it the frame is
    another's, and who wrote it is told."""
    places = SeenPlaces(mesh, Optics(camera=CAMERA))
    seen = places.place(CIRCLES[0], "p0.png")
    side = np.cross(seen.normal, [0.0, 0.0, 1.0])
    told = seen.point_mm + 0.8 * side / np.linalg.norm(side) + 0.3 * seen.normal
    found = places.contact(CIRCLES[0], photo(0, told))
    away = found.point_mm - told
    assert np.linalg.norm(away - (away @ found.normal) * found.normal) < 1e-6
    assert abs(away @ found.normal) == pytest.approx(0.3, abs=0.05)
    assert found.radius_mm == seen.radius_mm
    assert places.contact(CIRCLES[0], photo(0, None)).point_mm == pytest.approx(seen.point_mm)
    with pytest.raises(DesignError, match=r"p0\.png was pressed at .* more than 4") as caught:
        places.contact(CIRCLES[0], photo(0, seen.point_mm + np.array([0.0, 0.0, 25.0])))
    assert "frame of the design" in (caught.value.hint or "")
