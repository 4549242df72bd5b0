"""Scores of readings: of a right one, of one that says nothing, and beside their nulls."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from sim.optics.proof.specimen import dent, finger
from sim.optics.studio.render import Studio
from sim.reading.maps import pixel_maps
from sim.reading.reader import Reader, Touch
from sim.reading.rest_skin import normals_of
from sim.reading.untouched import open_untouched
from tests.synthetic_light import lit
from tests.unit.test_reader import CAMERA, RING, photographed
from workbench.core.design.design import Elastomer
from workbench.core.design.lighting import LightModel
from workbench.core.design.optics import Optics
from workbench.core.result.results import MembraneMesh
from workbench.reading.design_reader import DesignReader
from workbench.reading.read_photo import Reading
from workbench.twin.scoring import Scorer, mean_score
from workbench.twin.truth import Truth

pytestmark = pytest.mark.usefixtures("taichi_device")


@pytest.fixture(scope="module")
def mesh() -> MembraneMesh:
    return finger(edge_mm=0.8)


@pytest.fixture(scope="module")
def opened(mesh: MembraneMesh) -> DesignReader:
    light, table = lit(mesh, LightModel("hybrid"), RING)
    studio = Studio(mesh, light, Optics(camera=CAMERA, ring=RING), table=table)
    return DesignReader(
        reader=Reader(open_untouched(studio, CAMERA, photographed(studio, None))),
        mesh=mesh,
        material=Elastomer(),
        wall_mm=np.full(len(mesh.outer.points_mm), 2.0),
    )


@pytest.fixture(scope="module")
def moved(mesh: MembraneMesh) -> np.ndarray:
    return dent(mesh.seen, at_mm=(13.0, 7.5, 22.0), depth_mm=0.5, radius_mm=3.0)


def truth(mesh: MembraneMesh, moved: np.ndarray) -> Truth:
    return Truth(
        rest_mm=mesh.seen.points_mm,
        displaced_mm=mesh.seen.points_mm + moved,
        faces=mesh.seen.faces,
        normals=mesh.seen.normals,
        pressure_MPa=np.zeros(0),
        contact_force_N=np.zeros((0, 3)),
        force_N=np.array([0.0, 0.0, -2.0]),
        object_pose=np.zeros(7),
        target_mm=np.zeros(3),
        depth_mm=0.5,
        object_name="ball",
    )


def reading(opened: DesignReader, touch: Touch, force_N: np.ndarray) -> Reading:
    skin = opened.reader.rest.skin
    normals = normals_of(skin, opened.reader.displaced_mm(touch))
    return Reading(
        photo="a",
        touch=touch,
        normals=normals,
        maps=pixel_maps(opened.reader, touch, normals),
        force_N=force_N,
        force_sigma_N=0.1,
        contact_area_mm2=1.0,
        ball_radius_mm=3.0,
    )


def test_a_right_reading_and_one_of_nothing(
    opened: DesignReader, mesh: MembraneMesh, moved: np.ndarray
) -> None:
    """Exact: the true displacement is off by nothing; nothing is off by the null, IoU 0."""
    rest, known = opened.reader.rest, truth(mesh, moved)
    depth_mm = np.einsum("vc,vc->v", moved, rest.skin.inward)
    right = opened.reader.read(photographed(rest.studio, moved))
    sigma_mm = np.full(len(depth_mm), 0.01)
    right = dataclasses.replace(right, inward_mm=depth_mm, sigma_mm=sigma_mm, contact=None)
    scorer = Scorer(opened)
    best = scorer.score(reading(opened, right, np.array([0.0, 0.0, -1.0])), known)
    # A dent moves along one direction, a reading along normals that turn by some degrees.
    assert best.depth_mm < 0.01
    assert best.contact_iou > 0.9
    assert best.within_sigma > 0.8
    assert best.seen == pytest.approx(1.0, abs=0.2)
    assert best.force_error == pytest.approx(0.5)
    assert 0.0 < best.depth_ceiling_mm < 0.3 * best.depth_null_mm
    nothing = dataclasses.replace(right, inward_mm=np.zeros_like(depth_mm))
    none = scorer.score(reading(opened, nothing, np.zeros(3)), known)
    assert none.depth_mm == pytest.approx(none.depth_null_mm)
    assert none.normal_deg == pytest.approx(none.normal_null_deg)
    assert none.contact_iou == 0.0
    assert none.within_sigma == 0.0
    assert none.force_error == pytest.approx(1.0)
    assert none.depth_mm > 10.0 * best.depth_mm
    mean = mean_score([best, none])
    assert mean.depth_mm == pytest.approx((best.depth_mm + none.depth_mm) / 2.0)
    assert set(best.figures) == set(mean.figures)


def test_more_noise_leaves_less_skin_readable(
    opened: DesignReader, mesh: MembraneMesh, moved: np.ndarray
) -> None:
    """All of it at no noise, none where noise hides any tilt."""
    known = truth(mesh, moved)
    touch = opened.reader.read(photographed(opened.reader.rest.studio, moved))
    shares = [
        Scorer(opened)
        .score(reading(opened, dataclasses.replace(touch, noise_grey=noise), np.zeros(3)), known)
        .readable
        for noise in (1e-3, 1.0, 1e3)
    ]
    assert shares[0] == pytest.approx(1.0)
    assert shares[0] >= shares[1] >= shares[2]
    assert shares[2] == 0.0
