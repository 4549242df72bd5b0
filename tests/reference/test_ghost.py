"""Mirror images of the skin in the cavity's wall against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from sim.optics.camera.camera import axis_cosines
from sim.optics.proof.ghost import mirrored_radiance
from sim.optics.proof.specimen import finger
from sim.optics.proof.transport_scenes import plane, sphere
from sim.specimens import skins_only
from workbench.core.design.camera import Camera
from workbench.core.result.results import MembraneMesh, Skin

CAMERA = Camera(width_px=32, height_px=24, fov_x_deg=80.0, position_mm=(0.0, 0.0, 0.0))
INDEX = 1.41


def between(skin: Skin, wall: Skin) -> MembraneMesh:
    return skins_only(outer=skin, inner=wall, cavity=wall)


def joined(one: Skin, other: Skin) -> Skin:
    """Two skins as one."""
    return Skin(
        points_mm=np.vstack([one.points_mm, other.points_mm]),
        faces=np.vstack([one.faces, other.faces + len(one.points_mm)]).astype(np.int32),
        normals=np.vstack([one.normals, other.normals]),
    )


def turned(skin: Skin) -> Skin:
    """Turned half about +X: what faced up faces down."""
    turn = np.array([1.0, -1.0, -1.0])
    return Skin(points_mm=skin.points_mm * turn, faces=skin.faces, normals=skin.normals * turn)


def reflectance(cosine: np.ndarray) -> np.ndarray:
    """Fresnel's R in its trigonometric form."""
    angle = np.arccos(cosine)
    bent = np.arcsin(np.sin(angle) / INDEX)
    across = (np.sin(angle - bent) / np.sin(angle + bent)) ** 2
    along = (np.tan(angle - bent) / np.tan(angle + bent)) ** 2
    return (across + along) / 2.0


def slabs() -> MembraneMesh:
    """Flat walls 1 mm above and below the camera, skin 1 mm behind each; 2 m wide."""
    wall, skin = plane(1.0, 1000.0, 2), plane(2.0, 1000.0, 2)
    return between(joined(skin, turned(skin)), joined(wall, turned(wall)))


@pytest.mark.parametrize("bounces", [1, 2, 5])
def test_between_flat_walls_the_ghosts_sum_like_powers(bounces: int) -> None:
    """Uniform skin of radiance 1: sum over k from 1 to K of R^k T = R (1 - R^K)."""
    mesh = slabs()
    radiance = np.ones((len(mesh.seen.points_mm), 3))
    found = mirrored_radiance(mesh, CAMERA, INDEX, radiance, bounces=bounces)
    mirrored = reflectance(axis_cosines(CAMERA)).reshape(24, 32, 1)
    exact = np.broadcast_to(mirrored * (1.0 - mirrored**bounces), found.shape)
    assert found == pytest.approx(exact, rel=1e-5)


def test_the_first_ghost_shows_the_skin_below() -> None:
    """Upper skin black, lower skin red: one crossing gives R T, red alone; the next R^3 T."""
    mesh = slabs()
    radiance = np.zeros((len(mesh.seen.points_mm), 3))
    radiance[mesh.seen.points_mm[:, 2] < 0.0, 0] = 1.0
    mirrored = reflectance(axis_cosines(CAMERA)).reshape(24, 32)
    found = mirrored_radiance(mesh, CAMERA, INDEX, radiance, bounces=4)
    exact = (mirrored + mirrored**3) * (1.0 - mirrored)
    assert found[:, :, 0] == pytest.approx(exact, rel=1e-5)
    assert not found[:, :, 1:].any()


def test_without_refraction_there_is_no_ghost() -> None:
    """At index 1 the wall reflects nothing."""
    mesh = finger(edge_mm=1.5)
    radiance = np.ones((len(mesh.seen.points_mm), 3))
    assert not mirrored_radiance(mesh, CAMERA, 1.0, radiance).any()


def test_in_the_middle_of_a_sphere_every_ray_comes_back() -> None:
    """At normal incidence R = ((n - 1) / (n + 1))^2: the ghosts are R (1 - R^5) everywhere."""
    mesh = between(sphere(12.0, 4), sphere(10.0, 4))
    radiance = np.ones((len(mesh.seen.points_mm), 3))
    found = mirrored_radiance(mesh, CAMERA, INDEX, radiance)
    straight = ((INDEX - 1.0) / (INDEX + 1.0)) ** 2
    # Interpolated normals of chords 1 mm long are off by a thousandth of a radian.
    assert found == pytest.approx(np.full(found.shape, straight * (1.0 - straight**5)), rel=1e-3)
