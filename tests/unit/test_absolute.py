"""Absolute images: shadows on skin that did not move."""

from __future__ import annotations

import numpy as np
import pytest

from sim.optics.field.bake import bake_light
from sim.optics.proof.specimen import dent, finger
from sim.optics.studio.render import Studio
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedMount, LedRing, LightModel
from workbench.core.design.optics import Composition, Optics
from workbench.core.result.results import MembraneMesh

pytestmark = pytest.mark.usefixtures("taichi_device")

RING = LedRing(count=1, radius_mm=12.5, phase_deg=0.0, mount=LedMount.SHELL)
CAMERA = Camera(width_px=160, height_px=120)


@pytest.fixture(scope="module")
def mesh() -> MembraneMesh:
    return finger(edge_mm=1.0)


def linear(mesh: MembraneMesh, model: LightModel, composition: Composition) -> np.ndarray:
    """Background, and a deep dent above the LED: (2, H, W, 3)."""
    optics = Optics(camera=CAMERA, ring=RING, light_model=model, composition=composition)
    studio = Studio(mesh, bake_light(mesh, RING, model=model), optics)
    moved = dent(mesh.outer, at_mm=(15.0, 0.0, 22.0), depth_mm=2.5, radius_mm=4.0)
    return studio.linear(np.stack([np.zeros_like(moved), moved]))


def test_a_dent_shadows_skin_beyond_it_only_in_an_absolute_image(mesh: MembraneMesh) -> None:
    """Over the background some 40 mm2 behind the dent keep their light; absolutely they lose it."""
    over = linear(mesh, LightModel.DIRECT, Composition.OVER_BACKGROUND)
    absolute = linear(mesh, LightModel.DIRECT, Composition.ABSOLUTE)
    assert np.array_equal(over[0], absolute[0])
    still = (over[1] == over[0]).all(axis=2)
    darker = (absolute[1] < 0.5 * absolute[0]).any(axis=2) & still
    assert darker.sum() > 50
    # One light can only be taken away from skin that did not move; rounding decides nothing.
    assert (absolute[1][still] <= absolute[0][still] * (1.0 + 1e-5)).all()


@pytest.mark.parametrize("model", [LightModel.LINEAR, LightModel.PLANE_TARGET])
def test_fields_without_shadows_have_one_composition(mesh: MembraneMesh, model: LightModel) -> None:
    """The paper's fields know no shadow: both compositions are equal to rounding."""
    over = linear(mesh, model, Composition.OVER_BACKGROUND)
    absolute = linear(mesh, model, Composition.ABSOLUTE)
    assert absolute == pytest.approx(over, rel=1e-5, abs=1e-7)


def test_traced_radiance_is_shown_on_all_of_the_skin(mesh: MembraneMesh) -> None:
    """Radiance 1 at rest and 2 in the frame: an absolute image doubles every pixel."""
    optics = Optics(
        camera=CAMERA,
        ring=RING,
        light_model=LightModel.PHOTONS,
        composition=Composition.ABSOLUTE,
    )
    light = bake_light(mesh, RING, model=LightModel.PHOTONS)
    rest = np.ones((len(mesh.outer.points_mm), 3), dtype=np.float32)
    studio = Studio(mesh, light, optics, radiance=rest)
    moved = dent(mesh.outer, at_mm=(15.0, 0.0, 22.0), depth_mm=0.5, radius_mm=4.0)
    still = studio.linear(np.zeros_like(moved)[None], radiance=rest[None])[0]
    shown = studio.linear(moved[None], radiance=2.0 * rest[None])[0]
    assert shown == pytest.approx(2.0 * still, rel=1e-4)
