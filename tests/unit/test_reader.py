"""Photographs made by a design's own renderer, read back: what is left is the reader's own error.

A comparison of the product with itself; `validate reading` has photographs by other light.
"""

from __future__ import annotations

import dataclasses

import cv2
import numpy as np
import pytest

from sim.optics.proof.specimen import dent, finger
from sim.optics.raster.display import shown
from sim.optics.studio.render import Studio
from sim.optics.studio.unit_residual import UnitResidual
from sim.reading.maps import pixel_maps, touched
from sim.reading.reader import LEFT, Reader
from sim.reading.rest_skin import normals_of
from sim.reading.untouched import open_untouched
from tests.synthetic_light import lit
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedMount, LedRing, LightModel
from workbench.core.design.optics import Optics
from workbench.core.design.photo import photo
from workbench.core.result.results import MembraneMesh

pytestmark = pytest.mark.usefixtures("taichi_device")

CAMERA = Camera(width_px=160, height_px=120)
RING = LedRing(count=3, radius_mm=12.5, mount=LedMount.SHELL, cone_deg=150.0)
NOISE_GREY = 1.0


@pytest.fixture(scope="module")
def mesh() -> MembraneMesh:
    return finger(edge_mm=0.8)


@pytest.fixture(scope="module")
def studio(mesh: MembraneMesh) -> Studio:
    light, table = lit(mesh, LightModel("hybrid"), RING)
    return Studio(mesh, light, Optics(camera=CAMERA, ring=RING), table=table)


@pytest.fixture(scope="module")
def reader(studio: Studio) -> Reader:
    return Reader(open_untouched(studio, CAMERA, photographed(studio, None)))


def pressed(mesh: MembraneMesh) -> np.ndarray:
    """A round dent in the finger's side, half a millimetre deep."""
    return dent(mesh.seen, at_mm=(13.0, 7.5, 22.0), depth_mm=0.5, radius_mm=3.0)


def photographed(
    studio: Studio,
    moved: np.ndarray | None,
    noise_grey: float = 0.0,
    powers: tuple[float, float, float] = (1.0, 1.0, 1.0),
) -> np.ndarray:
    """A photograph of displaced skin, (V, 3), in whole grey levels; lamps of other powers."""
    count = studio.imager.raster.vertices
    shape = np.zeros((count, 3), dtype=np.float32) if moved is None else moved
    light = np.clip(studio.linear(shape[None])[0] * studio.exposure * powers, 0.0, 1.0)
    noise = np.random.default_rng(7).normal(size=light.shape) * noise_grey
    return np.clip(np.round(255.0 * shown(light, CAMERA.sensor) + noise), 0, 255)


@pytest.mark.parametrize(("noise_grey", "most_mm"), [(0.0, 0.02), (NOISE_GREY, 0.03)])
def test_a_dent_is_read_to_some_hundredths(
    mesh: MembraneMesh, studio: Studio, reader: Reader, noise_grey: float, most_mm: float
) -> None:
    """Mean absolute error over what moved by .05 mm; saying nothing would be six times as far."""
    moved = pressed(mesh)
    skin = reader.rest.skin
    touch = reader.read(photographed(studio, moved, noise_grey))
    depth_mm = np.einsum("vc,vc->v", moved, skin.inward)
    deep = (depth_mm > 0.05) & np.isfinite(touch.sigma_mm)
    off_mm = np.abs(touch.inward_mm - depth_mm)[deep].mean()
    assert off_mm < most_mm
    assert depth_mm[deep].mean() > 6.0 * most_mm
    assert touch.misfit < 2.0
    assert touched(touch)[np.argmax(depth_mm)]


def test_pixels_show_what_the_vertices_say(
    mesh: MembraneMesh, studio: Studio, reader: Reader
) -> None:
    """Depth where skin is seen, NaN elsewhere; unit normals; contact in the middle of the dent."""
    touch = reader.read(photographed(studio, pressed(mesh)))
    skin = reader.rest.skin
    maps = pixel_maps(reader, touch, normals_of(skin, reader.displaced_mm(touch)))
    sees = np.isfinite(maps.depth_mm)
    assert sees.any()
    assert maps.depth_mm[sees].max() == pytest.approx(touch.inward_mm.max(), rel=0.1)
    np.testing.assert_allclose(np.linalg.norm(maps.normal[sees], axis=1), 1.0, atol=1e-5)
    assert maps.contact[maps.depth_mm == maps.depth_mm[sees].max()].all()
    assert not maps.contact[~sees].any()


def test_a_video_goes_on_from_the_image_before(
    mesh: MembraneMesh, studio: Studio, reader: Reader
) -> None:
    """A tenth deeper, in no more steps and to the same depth."""
    moved = pressed(mesh)
    before = reader.read(photographed(studio, moved))
    photo = photographed(studio, 1.1 * moved)
    anew, on = reader.read(photo), reader.read(photo, before)
    assert on.steps <= anew.steps
    assert on.inward_mm.max() == pytest.approx(anew.inward_mm.max(), abs=0.02)


def test_a_long_video_reads_no_more_skin_than_its_first_image(
    mesh: MembraneMesh, studio: Studio, reader: Reader
) -> None:
    """Of a contact that stays, eight images on; noise moves the rim of what may move a little."""
    photos = [photographed(studio, pressed(mesh), NOISE_GREY) for _ in range(8)]
    first = touch = reader.read(photos[0])
    for each in photos[1:]:
        touch = reader.read(each, touch)
    assert np.count_nonzero(touch.inward_mm) <= 1.1 * np.count_nonzero(first.inward_mm)
    assert touch.inward_mm.max() == pytest.approx(first.inward_mm.max(), abs=0.02)


def test_an_untouched_sensor_reads_as_untouched(studio: Studio, reader: Reader) -> None:
    """With noise and in another exposure of 2 grey levels."""
    touch = reader.read(photographed(studio, None, NOISE_GREY) + 2.0)
    assert touch.inward_mm.max() < 0.02
    assert not touched(touch).any()


def test_noise_that_pixels_share_is_no_contact(
    mesh: MembraneMesh, studio: Studio, reader: Reader
) -> None:
    """1 grey, alike over 2 px: contact lies in the dent, and is less sure than by white noise."""
    moved, clean = pressed(mesh), photographed(studio, pressed(mesh))
    depth_mm = np.einsum("vc,vc->v", moved, reader.rest.skin.inward)
    deep = depth_mm > 0.05
    white = np.random.default_rng(1).normal(size=(120, 160, 3))
    shared = cv2.GaussianBlur(white, (0, 0), 2.0)
    touch, plain = (reader.read(clean + each / each.std()) for each in (shared, white))
    contact = touched(touch)
    assert not contact[depth_mm < 0.01].any()
    assert (contact & deep).sum() > 0.5 * (contact | deep).sum()
    assert np.nanmedian(touch.sigma_mm[deep]) > np.nanmedian(plain.sigma_mm[deep])


def test_a_built_sensor_reads_the_same_and_is_less_sure(
    mesh: MembraneMesh, studio: Studio, reader: Reader
) -> None:
    """Exact, of a unit that adds nothing: the factor, and only on what moved."""
    png = cv2.imencode(".png", photographed(studio, None).astype(np.uint8))[1].tobytes()
    nothing = UnitResidual(
        idle=photo("idle.png", png, at="optics.unit"),
        centres=np.zeros((0, 4), np.float32),
        weights=np.zeros((0, 3), np.float32),
        reach=np.ones(4),
    )
    touched_grey = photographed(studio, pressed(mesh))
    plain = reader.read(touched_grey)
    built = Reader(dataclasses.replace(reader.rest, unit=nothing)).read(touched_grey)
    assert built.inward_mm == pytest.approx(plain.inward_mm, abs=1e-9)
    assert built.sigma_mm == pytest.approx(LEFT * plain.sigma_mm, nan_ok=True)
    assert np.array_equal(touched(built), touched(plain))


def test_lamps_of_other_powers_read_the_same(
    mesh: MembraneMesh, studio: Studio, reader: Reader
) -> None:
    """A tenth more and less: the idle photo tells them, and the deviation grows."""
    powers, moved = (1.1, 0.9, 1.0), pressed(mesh)
    depth_mm = np.einsum("vc,vc->v", moved, reader.rest.skin.inward)
    plain = reader.read(photographed(studio, moved))
    light = reader.rest.light
    idle = photographed(studio, None, powers=powers)
    other = Reader(open_untouched(studio, CAMERA, idle, light=light))
    assert other.rest.light_error == pytest.approx(np.log(powers).std(), rel=0.2)
    assert reader.rest.light_error < 0.005
    found = other.read(photographed(studio, moved, powers=powers))
    deepest = np.argmax(plain.inward_mm)
    assert found.inward_mm[deepest] == pytest.approx(depth_mm[deepest], abs=0.01)
    assert found.sigma_mm[deepest] > 3.0 * plain.sigma_mm[deepest]
    assert touched(found)[deepest]
