"""What maps say that a reading will be able to tell, against closed forms and readings."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import sim.optics.maps.readability as told
from sim.optics.maps.look import look_of
from sim.optics.maps.skin_look import SkinLook
from sim.optics.proof.specimen import dent, finger
from sim.optics.raster.display import shown
from sim.optics.studio.render import Studio
from sim.reading import changed, fit
from sim.reading.reader import OWN_MM, OWN_SHARE, Reader
from sim.reading.untouched import open_untouched
from tests.synthetic_light import lit
from workbench.core.base.monitor import silent
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedMount, LedRing, LightModel
from workbench.core.design.optics import Optics

CAMERA = Camera(width_px=160, height_px=120)
RING = LedRing(count=3, radius_mm=12.5, mount=LedMount.SHELL, cone_deg=150.0)


def look(count: int, grey_per_deg: float, noise_grey: float = 2.0) -> SkinLook:
    """Places that show tilts in all directions alike, a tenth of a millimetre a pixel."""
    jacobian = np.zeros((count, 3, 2))
    jacobian[:, 0, 0] = jacobian[:, 1, 1] = grey_per_deg
    return SkinLook(
        visible=np.ones(count, dtype=bool),
        mm_per_pixel=np.full(count, 0.1),
        incidence_deg=np.zeros(count),
        jacobian=jacobian,
        noise=np.full((count, 3), noise_grey),
        glare=np.zeros(count),
        overexposed=np.zeros(count, bool),
    )


def test_the_beliefs_are_those_of_a_reading() -> None:
    """k and s, and the change from which it looks."""
    assert fit.CURVATURE == told.CURVATURE_PER_MM
    assert fit.MOVED_MM == told.MOVED_MM
    assert changed.LEAST_GREY == told.LEAST_GREY


def test_without_a_photograph_the_beliefs_alone_are_left() -> None:
    """Integral of 1 / (kappa^4 / k^2 + 1 / s^2) over 4 pi^2 is k s / 8, of a fine grid."""
    found = told.grid_variance(np.zeros((1, 2, 2)), np.array([0.25]))
    assert found[0] == pytest.approx(told.CURVATURE_PER_MM * told.MOVED_MM / 8.0, rel=0.1)


def test_more_light_by_tilt_makes_it_surer_and_noise_less_sure() -> None:
    """Error falls with the signal, rises with the noise, and knows only their ratio."""
    apart = np.full(3, 0.4)
    strong, weak = (np.eye(2)[None] * q * np.ones((3, 1, 1)) for q in (1e6, 1e4))
    assert (told.grid_variance(strong, apart) < 0.1 * told.grid_variance(weak, apart)).all()
    skin = finger(edge_mm=2.0).seen
    count = len(skin.points_mm)
    once, both = look(count, 1.0), look(count, 2.0, noise_grey=4.0)
    error_mm = told.depth_error_mm(skin, once)
    np.testing.assert_allclose(told.depth_error_mm(skin, both), error_mm, rtol=1e-6)
    noisier = dataclasses.replace(once, noise=2.0 * once.noise)
    assert (told.depth_error_mm(skin, noisier) > 1.2 * error_mm).all()


def test_a_dent_must_be_seen_and_be_sure() -> None:
    """Its change grows with the root of the depth: of a tenth of the light it is a hundred times
    as deep, or three deviations."""
    strong, weak = look(1, 10.0, 0.1), look(1, 1.0, 0.1)
    none, much = np.zeros(1), np.full(1, 0.5)
    ratio = told.readable_dent_mm(weak, none) / told.readable_dent_mm(strong, none)
    assert ratio[0] == pytest.approx(100.0, rel=1e-5)
    assert told.readable_dent_mm(strong, much)[0] == pytest.approx(1.5)


@pytest.mark.usefixtures("taichi_device")
def test_the_map_foretells_the_deviation_of_a_reading() -> None:
    """Within a factor of two, in a dent of the finger, of what its own matrix tells."""
    mesh = finger(edge_mm=0.8)
    light, table = lit(mesh, LightModel("hybrid"), RING)
    optics = Optics(camera=CAMERA, ring=RING)
    studio = Studio(mesh, light, optics, table=table)
    moved = dent(mesh.seen, at_mm=(13.0, 7.5, 22.0), depth_mm=0.5, radius_mm=3.0)
    random = np.random.default_rng(7)

    def photographed(displacement_mm: np.ndarray) -> np.ndarray:
        seen = studio.linear(displacement_mm[None].astype(np.float32))[0] * studio.exposure
        grey = 255.0 * shown(np.clip(seen, 0.0, 1.0), CAMERA.sensor)
        return np.clip(np.round(grey + random.normal(size=grey.shape)), 0, 255)

    reader = Reader(open_untouched(studio, CAMERA, photographed(np.zeros_like(moved))))
    touch = reader.read(photographed(moved))
    deep = (touch.inward_mm > 0.1) & np.isfinite(touch.sigma_mm)
    # What a reading adds for what it leaves out is no noise.
    own_mm = np.hypot(OWN_SHARE * touch.inward_mm, OWN_MM)
    by_noise_mm = np.sqrt(np.maximum(touch.sigma_mm**2 - own_mm**2, 0.0))[deep]
    found = look_of(mesh, light, optics, table, CAMERA, silent)
    foretold_mm = told.depth_error_mm(mesh.seen, found)[deep]
    ratio = np.nanmedian(foretold_mm) / np.median(by_noise_mm)
    assert 0.5 < ratio < 2.0
