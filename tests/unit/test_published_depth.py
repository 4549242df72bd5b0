"""The paper's depth map where it is right, and what it leaves out."""

from __future__ import annotations

import numpy as np
import pytest

from sim.optics.camera.camera import pixel_centres, pixel_directions
from sim.optics.proof.published_depth import published_depth_z
from sim.optics.proof.transport_scenes import plane
from workbench.core.design.camera import Camera, LensModel
from workbench.core.result.results import Skin

CAMERA = Camera(width_px=48, height_px=36, fov_x_deg=60.0, position_mm=(0.0, 0.0, 0.0))


def still(skin: Skin) -> np.ndarray:
    return np.zeros_like(skin.points_mm)


def above(*skins: Skin) -> Skin:
    """Several planes as one skin."""
    counts = np.cumsum([0, *(len(skin.points_mm) for skin in skins)])
    return Skin(
        points_mm=np.vstack([skin.points_mm for skin in skins]),
        faces=np.vstack([s.faces + n for s, n in zip(skins, counts[:-1], strict=True)]),
        normals=np.vstack([skin.normals for skin in skins]),
    )


@pytest.mark.parametrize("lens", [LensModel.PINHOLE, LensModel.EQUIDISTANT])
def test_a_level_plane_has_one_depth(lens: LensModel) -> None:
    """20 mm along the axis in every pixel, not the range, which grows to the edge."""
    camera = Camera(
        width_px=48, height_px=36, fov_x_deg=60.0, position_mm=(0.0, 0.0, 0.0), lens=lens
    )
    skin = plane(20.0, 30.0, 40)
    assert published_depth_z(skin, camera, still(skin)) == pytest.approx(np.full((36, 48), 20.0))


def test_a_tilted_plane_is_interpolated_exactly() -> None:
    """z = 20 + x / 4: along a pixel's ray (a, b, 1) the depth is 20 / (1 - a / 4)."""
    skin = plane(20.0, 40.0, 60)
    lift = np.zeros_like(skin.points_mm)
    lift[:, 2] = skin.points_mm[:, 0] / 4.0
    ray = pixel_directions(CAMERA, pixel_centres(CAMERA))
    exact = (20.0 / (1.0 - ray[:, 0] / ray[:, 2] / 4.0)).reshape(36, 48)
    # A cubic through a smooth function of depth, 60 particles across: better than a micrometre.
    assert published_depth_z(skin, CAMERA, lift) == pytest.approx(exact, abs=1e-3)


def test_outside_the_particles_there_is_no_depth() -> None:
    """A skin of 10 mm at 20 mm fills the middle of the image only; the rest is NaN."""
    skin = plane(20.0, 5.0, 10)
    depth = published_depth_z(skin, CAMERA, still(skin))
    assert np.isnan(depth[0, 0]) and depth[18, 24] == pytest.approx(20.0)
    # tan 30 degrees is 24 px, 5 mm at 20 mm are 10.4 px on each side: columns 14 to 33.
    assert np.flatnonzero(np.isfinite(depth[18])).tolist() == list(range(14, 34))


def test_hidden_particles_are_dropped() -> None:
    """A near plate hides the middle of a far one: its depth there is the near one's."""
    near, far = plane(10.0, 2.0, 20), plane(20.0, 30.0, 40)
    depth = published_depth_z(above(near, far), CAMERA, still(above(near, far)))
    assert depth[18, 24] == pytest.approx(10.0)
    # Slopes of the cubic are estimated over all particles: the jump is felt far away.
    assert depth[18, 2] == pytest.approx(20.0, abs=0.05)


def test_an_edge_of_an_occlusion_is_blurred() -> None:
    """Between near and far particles the cubic passes through depths that no skin has."""
    near, far = plane(10.0, 2.0, 20), plane(20.0, 30.0, 40)
    depth = published_depth_z(above(near, far), CAMERA, still(above(near, far)))
    between = (depth > 10.5) & (depth < 19.5)
    assert between.any()


def test_a_displacement_of_another_size_is_refused() -> None:
    """It says which array."""
    with pytest.raises(ValueError, match="displacement"):
        published_depth_z(plane(20.0, 5.0, 4), CAMERA, np.zeros((3, 3)))
