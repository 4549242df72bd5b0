"""Symmetries of the sensor that its images must have."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.optics.field.bake import bake_light
from sim.optics.proof.specimen import dent, finger
from sim.optics.studio.render import shoot
from tests.synthetic_light import UNTRACED
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedRing, LightModel
from workbench.core.design.optics import Optics
from workbench.core.result.sensing import TactileFrames

pytestmark = pytest.mark.usefixtures("taichi_device")

SMALL = Camera(width_px=120, height_px=120, fov_x_deg=90.0)
DENT_MM = (15.0, 0.0, 22.0)
ONE_LEVEL = 1
"""Float32 sums in another order can fall to the other side of a rounding border."""


def rendered(optics: Optics, at_mm: tuple[float, float, float] | None = None) -> TactileFrames:
    mesh = finger(edge_mm=1.0)
    light = bake_light(mesh, optics.ring, model=optics.light_model)
    if at_mm is None:
        return shoot(mesh, light, optics)
    moved = dent(mesh.outer, at_mm=at_mm, depth_mm=1.2, radius_mm=4.0)
    return shoot(mesh, light, optics, displacement_mm=moved[None])


def turned(azimuth_deg: float) -> tuple[float, float, float, float]:
    half = math.radians(azimuth_deg) / 2
    return (math.cos(half), 0.0, 0.0, math.sin(half))


@pytest.mark.parametrize("model", UNTRACED)
def test_turning_the_camera_by_120_degrees_permutes_the_colours(model: LightModel) -> None:
    """The ring maps onto itself with red, green, blue cycled; so does the image, exposure kept."""
    # Edges of 1.01 mm put 93 vertices around the skin and 75 around the cavity: both multiples
    # of 3, without which the mesh itself is not symmetric.
    mesh = finger(edge_mm=1.01)
    frames = []
    for azimuth_deg in (0.0, 120.0):
        camera = Camera(width_px=120, height_px=120, fov_x_deg=90.0, wxyz=turned(azimuth_deg))
        optics = Optics(camera=camera, light_model=model)
        frames.append(shoot(mesh, bake_light(mesh, optics.ring, model=model), optics))
    straight, other = (frame.rgb[0].astype(int) for frame in frames)
    # What stood in red at 0 degrees stands in green at 120.
    assert np.abs(other[..., [1, 2, 0]] - straight).max() <= ONE_LEVEL
    assert frames[1].exposure == pytest.approx(frames[0].exposure, rel=1e-4)
    assert np.abs(other - straight).max() > 30


def test_a_dent_at_plus_x_appears_on_the_right() -> None:
    """Camera +X is sensor +X: all changed pixels lie right of the centre, none of them left."""
    frames = rendered(Optics(camera=SMALL, light_model=LightModel.DIRECT), DENT_MM)
    columns = np.flatnonzero(frames.moved[1].any(axis=0))
    rows = np.flatnonzero(frames.moved[1].any(axis=1))
    assert columns.min() > 60
    assert rows.mean() == pytest.approx(59.5, abs=1.0)


def test_a_dent_at_plus_y_appears_below() -> None:
    """Camera +Y is down: all changed pixels lie below the centre."""
    frames = rendered(Optics(camera=SMALL, light_model=LightModel.DIRECT), (0.0, 15.0, 22.0))
    assert np.flatnonzero(frames.moved[1].any(axis=1)).min() > 60


def test_twice_the_power_is_the_same_image() -> None:
    """Exposure follows the power: half the gain and equal pixels."""
    single = rendered(Optics(camera=SMALL, light_model=LightModel.DIRECT))
    double = rendered(Optics(camera=SMALL, ring=LedRing(power=2.0), light_model=LightModel.DIRECT))
    assert double.exposure == pytest.approx(single.exposure / 2, rel=1e-5)
    assert np.abs(double.rgb.astype(int) - single.rgb).max() <= ONE_LEVEL


def test_a_mirrored_dent_gives_the_mirrored_depth() -> None:
    """Reflecting y reflects the rows of depth_z; the mesh has the same symmetry."""
    above = rendered(Optics(camera=SMALL, light_model=LightModel.DIRECT), (0.0, -15.0, 22.0))
    below = rendered(Optics(camera=SMALL, light_model=LightModel.DIRECT), (0.0, 15.0, 22.0))
    difference = above.depth_z_mm[1] - below.depth_z_mm[1][::-1]
    # Diagonals of the quads do not mirror. The dent curves with radius r^2 / (4 depth) = 3.3 mm,
    # so that chords of 1 mm edges lie up to 1 / (8 x 3.3) = 0.04 mm beside it.
    assert np.abs(difference).max() < 0.05
    # What is compared must be more than that tolerance: the dent shows ten times as strongly.
    assert np.abs(above.depth_z_mm[1] - above.depth_z_mm[0]).max() > 0.5
