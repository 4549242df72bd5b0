"""A pad that was built otherwise than drawn, read by the reader that ships for the pad.

Photographs, light and calibration are the program's own: what is shown is that a relit photograph
reads as one of the drawn pad does. Twins stand in `validate reading`.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from sim.optics.proof.specimen import dent
from sim.reading.network.reader_file import ReaderFile
from sim.reading.untouched import Untouched
from workbench.calibration.stored import lit_studio, stored
from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import silent
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.pipeline.store import Store
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.reading.find_reader import find_reader
from workbench.reading.learned_reader import LearnedReader, LearnedReading
from workbench.reading.reader_digest import reader_digest
from workbench.reading.relit_reader import open_relit

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("taichi_device")]

POWERS = (1.15, 0.85, 1.0, 0.9, 1.2, 1.05)
STIFFER = 1.2


def drawn_pad() -> SensorDesign:
    """As it ships, in images of the network's size and light of fewer photons."""
    design = load_design("pad")
    for field, value in (
        ("optics.camera.width_px", 320),
        ("optics.camera.height_px", 240),
        ("optics.baking.photons", 1_000_000),
    ):
        design = design.replace(field, value)
    return design


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Store:
    return Store(tmp_path_factory.mktemp("store"))


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> ReaderFile:
    """Those of the pad that ships, for the one with fewer photons."""
    found = find_reader(load_design("pad"), Project(tmp_path_factory.mktemp("project")), None)
    return dataclasses.replace(found, digest=reader_digest(drawn_pad()))


@pytest.fixture(scope="module")
def built() -> SensorDesign:
    """Other powers, a camera .4 mm and 1.5 degrees of view off, a stiffer gel."""
    drawn = drawn_pad()
    x, y, z = drawn.optics.camera.position_mm
    design = drawn.replace("optics.camera.position_mm", (x + 0.3, y - 0.2, z + 0.2))
    design = design.replace("optics.camera.fov_x_deg", drawn.optics.camera.fov_x_deg + 1.5)
    powers = tuple(np.resize(POWERS, drawn.optics.ring.count).tolist())
    design = design.replace("optics.ring.powers", powers)
    return design.replace("material.young_MPa", STIFFER * drawn.material.young_MPa)


def photographed(seen: Untouched, moved: np.ndarray | None) -> np.ndarray:
    """What its own renderer shows of displaced skin, (V, 3), uint8."""
    from sim.optics.raster.display import shown

    shape = np.zeros((seen.skin.count, 3), np.float32) if moved is None else moved
    light = np.clip(seen.studio.linear(shape[None])[0] * seen.studio.exposure, 0.0, 1.0)
    return np.round(255.0 * shown(light, seen.sensor)).astype(np.uint8)


def test_a_built_pad_reads_as_it_was_drawn(
    store: Store, weights: ReaderFile, built: SensorDesign
) -> None:
    """All of the skin, half a millimetre deep in one place: read plainly there are dents beside it,
    and it is four times as far off or more."""
    mesh = stored(built, PressCase(), "mesh", store, silent)
    studio = lit_studio(built, mesh, store, silent, "light")
    from sim.reading.untouched import open_untouched

    camera = built.optics.camera
    blank = np.full((camera.height_px, camera.width_px, 3), 128, np.uint8)
    bare = open_untouched(studio, camera, blank)
    idle = photographed(bare, None)
    top_mm = float(mesh.seen.points_mm[:, 2].max())
    moved = dent(mesh.seen, at_mm=(1.5, -2.0, top_mm), depth_mm=0.5, radius_mm=3.0)
    photo = photographed(bare, moved)
    pair = (built, drawn_pad())
    opened = open_relit(pair, weights, idle, store, monitor=silent, device="cpu")
    plain = LearnedReader(weights, camera, mesh, idle, "cpu")
    depth_mm = np.einsum("vc,vc->v", moved, -np.asarray(mesh.seen.normals))

    def off_mm(found: LearnedReading) -> float:
        return float(np.abs(found.surface_mm - depth_mm).mean())

    relit = opened.read("a.png", photo)
    assert off_mm(relit) < 0.25 * off_mm(plain.read("a.png", photo))
    assert off_mm(relit) < 0.35 * depth_mm.mean()
    # Its maps lie on the built camera's pixels: the deepest is where the dent's middle is seen.
    seen = np.isfinite(relit.maps.depth_mm)
    assert seen.mean() > 0.5
    row, column = np.unravel_index(np.nanargmax(relit.maps.depth_mm), seen.shape)
    middle = studio.vertex_pixels[int(np.argmax(depth_mm)), :2]
    assert np.hypot(column + 0.5 - middle[0], row + 0.5 - middle[1]) < 12.0
    np.testing.assert_allclose(np.linalg.norm(relit.maps.normal[seen], axis=1), 1.0, atol=1e-3)
    assert relit.maps.contact[row, column]
    # A stiffer gel bears more in the same dent.
    same = dataclasses.replace(opened, stiffer=1.0).read("a.png", photo)
    np.testing.assert_allclose(relit.force_N, STIFFER * same.force_N)
    assert opened.stiffer == pytest.approx(STIFFER)


def test_another_skin_is_refused(store: Store, weights: ReaderFile, built: SensorDesign) -> None:
    """By name, before light is traced: what was learned does not hold for another wall."""
    other = drawn_pad().replace("layers.elastomer_mm", 3.0)
    camera = built.optics.camera
    idle = np.full((camera.height_px, camera.width_px, 3), 90, np.uint8)
    with pytest.raises(DesignError, match="has another body, wall"):
        open_relit((built, other), weights, idle, store, monitor=silent, device="cpu")


def test_photographs_are_looked_at_first(
    store: Store, weights: ReaderFile, built: SensorDesign, tmp_path: Path
) -> None:
    """One of another size is refused by name."""
    camera = built.optics.camera
    idle = np.full((camera.height_px, camera.width_px, 3), 90, np.uint8)
    pair = (built, drawn_pad())
    opened = open_relit(pair, weights, idle, store, monitor=silent, device="cpu")
    with pytest.raises(DesignError, match=r"b\.png has 40 x 30 pixels"):
        opened.read("b.png", np.zeros((30, 40, 3), np.uint8))
