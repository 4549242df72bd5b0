"""A ball as a model: its contact in closed form, and the radius found in an image of it."""

from __future__ import annotations

import numpy as np
import pytest

from sim.optics.proof.specimen import finger
from sim.optics.raster.display import shown
from sim.optics.studio.render import Studio
from sim.reading.ball_model import depth_in_ball_mm, fit_ball, touching_mm
from sim.reading.layer_law import Layer, influence_mm_per_MPa
from sim.reading.reader import Reader
from sim.reading.untouched import open_untouched
from tests.synthetic_light import lit
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedMount, LedRing, LightModel
from workbench.core.design.optics import Optics

CAMERA = Camera(width_px=160, height_px=120)
RING = LedRing(count=3, radius_mm=12.5, mount=LedMount.SHELL, cone_deg=150.0)
LAYER = Layer(thickness_mm=2.0, young_MPa=0.14, poisson=0.45)


def test_points_leave_a_ball_behind() -> None:
    """A ball of 2 mm that dips .5 mm below a plane: .5 in the middle, a cap around it."""
    x = np.linspace(0.0, 3.0, 31)
    points_mm = np.stack([x, 0.0 * x, 0.0 * x], axis=1)
    inward = np.tile([0.0, 0.0, -1.0], (len(x), 1))
    found = depth_in_ball_mm(points_mm, inward, np.array([0.0, 0.0, 1.5]), 2.0)
    cap = np.sqrt(np.maximum(4.0 - x**2, 0.0)) - 1.5
    np.testing.assert_allclose(found, np.maximum(cap, 0.0), atol=1e-12)


def test_contact_of_a_ball_is_that_of_hertz() -> None:
    """On a thick layer, d = a^2 / R: the skin follows the ball to about that radius."""
    line = np.linspace(-1.5, 1.5, 31)
    x, y = (each.ravel() for each in np.meshgrid(line, line))
    points_mm = np.stack([x, y, 0.0 * x], axis=1)
    thick = Layer(thickness_mm=60.0, young_MPa=0.1, poisson=0.45)
    area_mm2 = np.full(len(x), 0.01)
    moved = influence_mm_per_MPa(thick, points_mm, area_mm2)
    radius_mm, depth_mm = 5.0, 0.2
    centre = np.array([0.0, 0.0, radius_mm - depth_mm])
    wanted = depth_in_ball_mm(points_mm, np.tile([0.0, 0.0, -1.0], (len(x), 1)), centre, radius_mm)
    displaced = touching_mm(moved, wanted)
    away_mm = np.hypot(x, y)
    follows = (wanted > 0.0) & (displaced < wanted + 1e-6)
    assert away_mm[follows].max() == pytest.approx(np.sqrt(radius_mm * depth_mm), abs=0.1)
    assert (displaced >= wanted - 1e-6).all()
    # Outside it falls as Hertz' displacement does: .2 mm x .39 at 1.4 a, of a half-space.
    beside = displaced[np.argmin(np.abs(away_mm - 1.4) + np.abs(y))]
    assert beside == pytest.approx(_hertz_mm(1.4, radius_mm, depth_mm), rel=0.06)


def _hertz_mm(away_mm: float, radius_mm: float, depth_mm: float) -> float:
    """Displacement beside a Hertzian contact; Johnson, Contact Mechanics, equation 3.42a."""
    ratio = away_mm / np.sqrt(radius_mm * depth_mm)
    bracket = (2.0 - ratio**2) * np.arcsin(1.0 / ratio) + np.sqrt(ratio**2 - 1.0)
    return float(depth_mm / np.pi * bracket)


@pytest.mark.usefixtures("taichi_device")
def test_a_ball_is_found_in_its_image() -> None:
    """Its radius within 5 % from a first guess twice as large, at 1 grey of noise.

    The dent is the model's own: what is tested is the fit, not the law.
    """
    mesh = finger(edge_mm=0.8)
    light, table = lit(mesh, LightModel("hybrid"), RING)
    studio = Studio(mesh, light, Optics(camera=CAMERA, ring=RING), table=table)
    skin = mesh.seen
    target = int(np.argmin(np.linalg.norm(skin.points_mm - [13.0, 7.5, 22.0], axis=1)))
    near = np.flatnonzero(np.linalg.norm(skin.points_mm - skin.points_mm[target], axis=1) < 6.0)
    points_mm, inward = skin.points_mm[near], -skin.normals[near]
    radius_mm, depth_mm = 4.0, 0.6
    centre = skin.points_mm[target] - (radius_mm - depth_mm) * -skin.normals[target]
    from geometry.surface.surface import vertex_areas_mm2

    area_mm2 = vertex_areas_mm2(skin.points_mm, skin.faces)[near]
    response = influence_mm_per_MPa(LAYER, points_mm, area_mm2)
    moved = np.zeros_like(skin.points_mm)
    depths = touching_mm(response, depth_in_ball_mm(points_mm, inward, centre, radius_mm))
    moved[near] = depths[:, None] * inward
    random = np.random.default_rng(3)

    def photographed(displacement_mm: np.ndarray) -> np.ndarray:
        seen = studio.linear(displacement_mm[None].astype(np.float32))[0] * studio.exposure
        grey = 255.0 * shown(np.clip(seen, 0.0, 1.0), CAMERA.sensor)
        return np.clip(np.round(grey + random.normal(size=grey.shape)), 0, 255)

    reader = Reader(open_untouched(studio, CAMERA, photographed(np.zeros_like(moved))))
    photo = photographed(moved)
    touch = reader.read(photo)
    ball = fit_ball(reader, photo, touch, LAYER, 2.0 * radius_mm)
    assert ball is not None
    assert ball.radius_mm == pytest.approx(radius_mm, rel=0.05)
    assert ball.depth_mm == pytest.approx(depth_mm, abs=0.05)
    assert np.linalg.norm(ball.place_mm - skin.points_mm[target]) < 0.3
    assert ball.misfit < 1.5
    untouched = photographed(np.zeros_like(moved))
    assert fit_ball(reader, untouched, reader.read(untouched), LAYER, radius_mm) is None
