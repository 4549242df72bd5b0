"""Twins by Mitsuba: what is written for it, how its process is run, and, where it is, its light."""

from __future__ import annotations

import dataclasses
import importlib.util
import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.optics.camera.camera import pixel_directions
from sim.optics.light.lights import place_leds
from sim.optics.proof.specimen import finger
from sim.optics.transport.scene import open_scene
from sim.optics.transport.sources import open_sources
from tests.unit.test_twin_make import PLAN, Stand, made
from workbench.core.base.errors import Cancelled, DesignError, DeviceError
from workbench.core.base.monitor import silent
from workbench.core.design.camera import Camera, LensModel
from workbench.core.design.lighting import LedRing, LightModel
from workbench.core.design.optics import Coating, Optics
from workbench.twin import make as making
from workbench.twin import mitsuba_photographer as photographer
from workbench.twin.mitsuba_photographer import check_mitsuba, seen_by_mitsuba
from workbench.twin.mitsuba_scene import (
    ALUMINIUM,
    AROUND,
    ARRAYS,
    Pose,
    camera_pose,
    disc_mesh,
    flakes_of,
    write_scene,
)
from workbench.twin.twin_plan import CPU_PHOTONS, MITSUBA_PHOTONS, Light, TwinPlan

OPTICS = Optics(
    camera=Camera(width_px=32, height_px=24),
    ring=LedRing(count=3, radius_mm=6.0, size_mm=3.0, height_mm=0.5, phase_deg=90.0),
    coating=Coating(albedo=0.6, specular=0.0),
    light_model=LightModel("photons"),
)
AT_REST = Pose(displacement_mm=None, photons=400_000, seed=3)


@pytest.fixture
def stand(monkeypatch: pytest.MonkeyPatch) -> Stand:
    found = Stand(monkeypatch)
    monkeypatch.setattr(making, "MitsubaPhotographer", lambda *given: found)
    monkeypatch.setattr(making, "check_mitsuba", lambda optics: None)
    return found


@pytest.mark.parametrize(
    "coating", [Coating(), Coating(albedo=0.1, specular=0.5), Coating(specular=0.0)]
)
def test_flakes_and_binder_send_back_what_the_product_s_coating_does(coating: Coating) -> None:
    """Along the normal F0 by flakes, rho (1 - F0) by the binder: the same light, another way."""
    matte, share, roughness = flakes_of(coating)
    assert share * ALUMINIUM == pytest.approx(coating.specular)
    assert (1.0 - share) * matte == pytest.approx(coating.albedo * (1.0 - coating.specular))
    assert roughness == coating.roughness and 0.0 <= matte <= 1.0


def test_the_camera_looks_where_the_product_s_does() -> None:
    """Mitsuba's pixel directions, +X left and +Y up of a pinhole, are those of the workbench."""
    turned = Camera(width_px=64, height_px=48, wxyz=(0.9938, 0.08, -0.06, 0.04))
    pose = camera_pose(turned)
    half = np.tan(np.radians(turned.fov_x_deg) / 2.0)
    at_px = np.array([[0.5, 0.5], [40.5, 10.5], [63.5, 47.5]])
    x, y = ((at_px - (32.0, 24.0)) / 32.0 * half).T
    mine = np.column_stack([-x, -y, np.ones(3)]) @ pose[:3, :3].T
    mine /= np.linalg.norm(mine, axis=1, keepdims=True)
    np.testing.assert_allclose(mine, pixel_directions(turned, at_px), atol=1e-6)


def test_discs_have_the_place_axis_and_size_of_the_leds() -> None:
    """A polygon of 24 corners about each light, its area within 1.2 % of the circle's."""
    transport = OPTICS.transport
    assert transport is not None
    leds = place_leds(OPTICS.ring, ())
    sources = open_sources(leds, open_scene(finger(edge_mm=2.0), transport))
    points, normals, faces = disc_mesh(sources, np.arange(3))
    middles_mm = points.reshape(3, AROUND, 3).mean(axis=1)
    np.testing.assert_allclose(middles_mm, leds.position_mm, atol=1e-5)
    np.testing.assert_allclose(normals[::AROUND], leds.axis, atol=1e-6)
    first, second, third = (points[faces[:, k]] for k in range(3))
    across = np.cross(second - first, third - first)
    # Turned so that it shines along its axis.
    assert (np.einsum("ij,ij->i", across, normals[faces[:, 0]]) > 0.0).all()
    area_mm2 = 0.5 * np.linalg.norm(across, axis=1).reshape(3, -1).sum(axis=1)
    circle_mm2 = np.pi * sources.emission[:, 2] ** 2
    # Of 24 corners: 12 sin(15 degrees) r^2 over pi r^2 is .9886.
    np.testing.assert_allclose(area_mm2 / circle_mm2, 0.9886, atol=1e-3)


def test_the_skin_looks_inward(tmp_path: Path) -> None:
    """Light comes from inside: faces and normals are turned, and so they stay when it moves."""
    mesh = finger(edge_mm=2.0)
    moved = 0.1 * np.ones_like(mesh.seen.points_mm)
    pose = dataclasses.replace(AT_REST, displacement_mm=moved)
    write_scene(tmp_path, mesh, OPTICS, pose, np.zeros(3))
    with np.load(tmp_path / ARRAYS) as held:
        assert np.array_equal(held["faces"], mesh.seen.faces[:, ::-1])
        assert held["vertex_mm2"].sum() == pytest.approx(_area_mm2(mesh.seen), rel=1e-5)
        assert held["disc_radiance"].shape == (3 * AROUND, 3)


def _area_mm2(skin: Any) -> float:
    a, b, c = (skin.points_mm[skin.faces[:, k]].astype(float) for k in range(3))
    return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def test_what_mitsuba_cannot_photograph_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Another lens by its name; where it is not installed, with how to install it."""
    wide = dataclasses.replace(
        OPTICS, camera=dataclasses.replace(OPTICS.camera, lens=_no_pinhole())
    )
    with pytest.raises(DesignError, match="lens"):
        check_mitsuba(wide)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(DeviceError, match="not installed") as raised:
        check_mitsuba(OPTICS)
    assert "[mitsuba]" in raised.value.hint


def _no_pinhole() -> LensModel:
    return next(lens for lens in LensModel if lens is not LensModel.PINHOLE)


def test_a_process_that_fails_says_why(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With what it said last, and what to do."""
    monkeypatch.setattr(photographer, "MODULE", "no.such.module")
    with pytest.raises(DeviceError, match=r"stopped with 1: .*no"):
        photographer._run([], tmp_path, silent)


def test_a_process_is_ended_when_somebody_stops(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not left to compute for nobody."""
    begun: list[subprocess.Popen[Any]] = []
    plain = subprocess.Popen

    def kept(*given: Any, **options: Any) -> subprocess.Popen[Any]:
        begun.append(plain(["sleep", "60"], **options))
        return begun[-1]

    def stop(fraction: float, note: str = "") -> None:
        raise Cancelled("stopped")

    monkeypatch.setattr(subprocess, "Popen", kept)
    with pytest.raises(Cancelled):
        photographer._run([], tmp_path, stop)
    assert begun[0].returncode == -9


def test_the_light_is_part_of_the_twin(tmp_path: Path, stand: Stand) -> None:
    """The card says which; by the other light it is another twin."""
    plan = dataclasses.replace(PLAN, light=Light.MITSUBA)
    found = made(tmp_path, plan)
    card = json.loads((found.folder / "card.json").read_bytes())
    assert "Mitsuba" in card["light"] and card["plan"]["light"] == "mitsuba"
    with pytest.raises(DesignError, match="another twin"):
        made(tmp_path)


def test_mitsuba_has_its_own_number_of_photons() -> None:
    """It traces on the processor whatever the device is."""
    assert TwinPlan(light=Light.MITSUBA).photons("cuda") == MITSUBA_PHOTONS * 1_000_000
    assert TwinPlan().photons("cpu") == CPU_PHOTONS * 1_000_000


@pytest.mark.slow
@pytest.mark.usefixtures("taichi_device")
def test_a_matte_skin_shines_as_the_product_says() -> None:
    """Two tracers, one matte coating: mean radiance of the upper skin within 2 %."""
    from sim.optics.transport.paths import Photons
    from sim.optics.transport.radiance import trace_radiance

    pytest.importorskip("mitsuba")
    try:
        check_mitsuba(OPTICS)
    except DeviceError as error:
        pytest.skip(error.message)
    mesh, leds = finger(edge_mm=1.0), place_leds(OPTICS.ring, ())
    seen = seen_by_mitsuba(mesh, OPTICS, AT_REST, silent)
    assert seen.image is not None and seen.image.shape == (24, 32, 3)
    transport = OPTICS.transport
    assert transport is not None
    photons = Photons(count=AT_REST.photons, seed=5)
    found = trace_radiance(mesh, leds, OPTICS.camera, transport, photons)
    product = found.radiance * (len(leds.rgb) / found.photons)
    high = mesh.seen.points_mm[:, 2] > 5.0
    ratio = seen.radiance[high].mean(axis=0) / product[high].mean(axis=0)
    np.testing.assert_allclose(ratio, 1.0, atol=0.02)
