"""Contacts on the skin, laid flat: exact on planes, seen from above and from aside."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from sim.optics.proof.specimen import finger
from workbench.core.design.camera import Camera
from workbench.core.design.design import SensorDesign
from workbench.core.design.optics import Optics
from workbench.learning.dataset.photo_labels import FORCE, TARGET
from workbench.pipeline.store import Store
from workbench.tasks.contact_frame import in_contact_frame, in_sensor_frame
from workbench.tasks.examples import Examples
from workbench.tasks.seen_images import change, view_of
from workbench.tasks.skin_sight import HALF_MM, PATCH_PX, SkinSight
from workbench.tasks.task import Net

WIDTH, HEIGHT, PAD = 96, 72, 6
RADIUS_MM = 2.0


def seen(slope: float) -> tuple[SkinSight, np.ndarray]:
    """A pinhole at the origin above the plane z = 20 + slope x [mm], and what its pixels see."""
    columns = np.arange(-PAD, WIDTH + PAD) - 0.5 * (WIDTH - 1)
    rows = np.arange(-PAD, HEIGHT + PAD) - 0.5 * (HEIGHT - 1)
    across, down = np.meshgrid(columns / 60.0, rows / 60.0)
    away_mm = 20.0 / (1.0 - slope * across)
    hit = np.stack([across * away_mm, down * away_mm, away_mm], axis=-1)
    return SkinSight(hit, np.zeros(3), PAD), hit[PAD:-PAD, PAD:-PAD]


def disc(hit: np.ndarray, middle_mm: np.ndarray) -> np.ndarray:
    """A round spot on the skin, as a camera sees it, shape (1, H, W, 3), int16."""
    off_mm = np.linalg.norm(hit - middle_mm, axis=2)
    return np.repeat((90 * (off_mm < RADIUS_MM)).astype(np.int16)[None, ..., None], 3, axis=3)


@pytest.mark.parametrize(
    ("slope", "x_mm", "y_mm"), [(0.0, 0.0, 0.0), (0.0, 7.0, -4.0), (1.0, 3.0, 2.0)]
)
def test_a_round_spot_is_round_and_of_its_size_wherever_it_is(
    slope: float, x_mm: float, y_mm: float
) -> None:
    """Its foot to a quarter millimetre; its moments along both axes are R^2 / 4, to a sixth.

    A pixel is .33 mm wide, so the rim of the spot is known to that.
    """
    sight, hit = seen(slope)
    middle_mm = np.array([x_mm, y_mm, 20.0 + slope * x_mm])
    grey = disc(hit, middle_mm)
    touch = sight.touch(grey)
    assert touch.foot_mm == pytest.approx(middle_mm, abs=0.25)
    normal = np.array([-slope, 0.0, 1.0]) / np.hypot(slope, 1.0)
    assert touch.axes[2] == pytest.approx(normal, abs=0.02)
    assert touch.axes @ touch.axes.T == pytest.approx(np.eye(3), abs=1e-9)
    square = sight.flat(touch)
    flat = square.laid(grey)[0, ..., 0].astype(np.float64)
    assert np.abs(square.drop_mm).max() < 0.05
    places_mm = ((np.arange(PATCH_PX) + 0.5) / PATCH_PX * 2.0 - 1.0) * HALF_MM
    for weight in (flat.sum(axis=0), flat.sum(axis=1)):
        middle = (weight * places_mm).sum() / weight.sum()
        moment = (weight * (places_mm - middle) ** 2).sum() / weight.sum()
        assert abs(middle) < 0.3
        assert moment == pytest.approx(RADIUS_MM**2 / 4.0, rel=1.0 / 6.0)


def test_how_curved_skin_lay_before_is_told() -> None:
    """A wall of 15 mm radius seen from inside: R - sqrt(R2 - x2) below the plane at the foot."""
    radius_mm, (columns, rows) = 15.0, np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    turn = (columns - 0.5 * (WIDTH - 1)) / 70.0
    along_mm = 0.2 * (rows - 0.5 * (HEIGHT - 1))
    hit = np.stack([radius_mm * np.sin(turn), along_mm, radius_mm * np.cos(turn)], axis=-1)
    sight = SkinSight(hit, np.zeros(3), 0)
    middle_mm = hit[HEIGHT // 2, WIDTH // 2 + 8]
    touch = sight.touch(disc(hit, middle_mm))
    drop_mm = sight.flat(touch).drop_mm
    places_mm = ((np.arange(PATCH_PX) + 0.5) / PATCH_PX * 2.0 - 1.0) * HALF_MM
    there = np.einsum("k,ij->ijk", touch.axes[0, [0, 2]], places_mm[None] + 0.0 * drop_mm)
    there += np.einsum("k,ij->ijk", touch.axes[1, [0, 2]], places_mm[:, None] + 0.0 * drop_mm)
    around_mm = np.linalg.norm(there, axis=2)
    wanted_mm = radius_mm - np.sqrt(radius_mm**2 - around_mm**2)
    inside = np.s_[8:-8, 8:-8]
    assert drop_mm[inside] == pytest.approx(wanted_mm[inside], abs=0.06)
    assert drop_mm[inside].max() > 0.5


def test_what_the_camera_does_not_see_counts_as_unchanged() -> None:
    """At the edge of the image half of the patch is out of sight."""
    sight, hit = seen(0.0)
    middle_mm = hit[HEIGHT // 2, -4]
    square = sight.flat(sight.touch(disc(hit, middle_mm)))
    flat = square.laid(np.full((1, HEIGHT, WIDTH, 3), 50, np.int16))
    assert (flat == 0).mean() > 0.3 and (flat == 50).mean() > 0.4


def test_without_a_contact_the_middle_is_shown() -> None:
    """Nothing differs, and nothing fails."""
    sight, _ = seen(0.0)
    touch = sight.touch(np.zeros((1, HEIGHT, WIDTH, 3), np.int16))
    assert touch.foot_mm == pytest.approx([0.0, 0.0, 20.0], abs=0.1)


def test_a_finger_is_seen_whatever_the_photographs_size(tmp_path: Path) -> None:
    """A photograph twice as large shows the same: foot to a tenth of a millimetre."""
    mesh = finger(edge_mm=1.5)
    optics = Optics(camera=Camera(width_px=160, height_px=120))
    view = view_of(Net.LITE, mesh, SensorDesign(optics=optics), Store(tmp_path))
    idle = np.full((120, 160, 3), 60, np.uint8)
    touched = idle.copy()
    touched[50:62, 90:102] = 160
    large = [np.kron(each, np.ones((2, 2, 1), np.uint8)) for each in (touched, idle)]
    one, two = change([touched], idle, view), change([large[0]], large[1], view)
    assert one.grey.shape == two.grey.shape == (1, PATCH_PX, PATCH_PX, 3)
    assert one.foot_mm == pytest.approx(two.foot_mm, abs=0.1)
    assert len(one.at) == 8


def test_vectors_turn_with_the_skin_and_come_back() -> None:
    """A force along the normal is (0, 0, f) at every place; there and back is the same."""
    rng = np.random.default_rng(0)
    axes = np.linalg.qr(rng.normal(size=(5, 3, 3)))[0]
    feet_mm = rng.normal(size=(5, 3))
    found = Examples(
        names=tuple("abcde"),
        places=np.array(list("abcde")),
        inputs=np.zeros((5, 1, 2, 2, 3), np.int16),
        at=np.zeros((5, 8), np.float32),
        feet_mm=feet_mm,
        axes=axes,
        motion=np.zeros(5),
        truth=np.hstack([2.0 * axes[:, 2], feet_mm + axes[:, 0], np.full((5, 1), 0.4)]),
        outputs=(*FORCE, *TARGET, "depth_mm"),
    )
    turned = in_contact_frame(found)
    assert turned == pytest.approx(np.tile([0.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.4], (5, 1)), abs=1e-12)
    assert in_sensor_frame(turned, found) == pytest.approx(found.truth, abs=1e-12)
    part = dataclasses.replace(found, truth=found.truth[:, :2], outputs=FORCE[:2])
    assert (in_contact_frame(part) == part.truth).all(), "half a vector is left as it is"
