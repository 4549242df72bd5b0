"""Photographs of a built sensor as its design was drawn would show them.

The truth is what the renderer shows of the same dent in the drawn design: a comparison of the
product with itself. `validate reading` reads relit photographs of twins.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from sim.optics.proof.specimen import dent, finger
from sim.optics.raster.display import shown
from sim.optics.studio.render import Studio
from sim.reading.untouched import Untouched, open_untouched
from tests.synthetic_light import lit
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedMount, LedRing, LightModel
from workbench.core.design.optics import Optics
from workbench.core.result.light import NormalTable
from workbench.core.result.results import MembraneMesh
from workbench.reading.relight import Relight
from workbench.reading.same_places import SamePlaces

pytestmark = pytest.mark.usefixtures("taichi_device")

DRAWN = Camera(width_px=320, height_px=240)
BUILT = dataclasses.replace(DRAWN, position_mm=(0.4, -0.3, 0.5), fov_x_deg=DRAWN.fov_x_deg + 2.0)
RING = LedRing(count=3, radius_mm=12.5, mount=LedMount.SHELL, cone_deg=150.0)
Powers = tuple[float, float, float]
"""Of the lamps of each colour."""


def photographed(studio: Studio, moved: np.ndarray | None) -> np.ndarray:
    """A photograph of displaced skin, (V, 3), in whole grey levels."""
    count = studio.imager.raster.vertices
    shape = np.zeros((count, 3), dtype=np.float32) if moved is None else moved
    light = np.clip(studio.linear(shape[None])[0] * studio.exposure, 0.0, 1.0)
    return np.round(255.0 * shown(light, DRAWN.sensor)).astype(np.uint8)


@pytest.fixture(scope="module")
def mesh() -> MembraneMesh:
    return finger(edge_mm=0.8)


def opened(mesh: MembraneMesh, camera: Camera, turn_deg: float, powers: Powers) -> Untouched:
    """A sensor at rest, each colour of whose light falls from a side of its own, all turned."""
    light, table = lit(mesh, LightModel("hybrid"), RING)
    assert table is not None
    level = table.values.mean(axis=(2, 3), keepdims=True)
    tilt = np.linspace(-1.0, 1.0, table.values.shape[2])
    sides = np.radians(turn_deg + np.array([0.0, 120.0, 240.0]))
    along = tilt[:, None, None] * np.cos(sides) + tilt[None, :, None] * np.sin(sides)
    fall = 1.4 - 0.6 * (tilt[:, None] ** 2 + tilt[None] ** 2)[:, :, None] + 0.5 * along
    table = NormalTable(values=(level * fall * powers).astype(np.float32))
    studio = Studio(mesh, light, Optics(camera=camera, ring=RING), table=table)
    return open_untouched(studio, camera, photographed(studio, None))


@pytest.fixture(scope="module")
def drawn(mesh: MembraneMesh) -> Untouched:
    return opened(mesh, DRAWN, 0.0, (1.0, 1.0, 1.0))


@pytest.fixture(scope="module")
def built(mesh: MembraneMesh) -> Untouched:
    return opened(mesh, BUILT, 40.0, (1.2, 0.9, 1.1))


@pytest.fixture(scope="module")
def moved(mesh: MembraneMesh) -> np.ndarray:
    """A round dent in the finger's side, half a millimetre deep."""
    return dent(mesh.seen, at_mm=(13.0, 7.5, 22.0), depth_mm=0.5, radius_mm=3.0)


def test_places_are_those_that_both_cameras_see(built: Untouched, drawn: Untouched) -> None:
    """There and back is the same pixel; a camera sees the places of its own pixels at home."""
    there, back = SamePlaces.of(drawn, built), SamePlaces.of(built, drawn)
    row, column = np.mgrid[:240, :320].astype(np.float32)
    home = np.stack([column, row], axis=2)
    again = there.brought(back.brought(home))
    whole = there.brought(back.seen.astype(np.float32)) == 1.0
    inner = there.seen & whole
    assert inner.sum() > 0.5 * drawn.sees.sum()
    off_px = np.linalg.norm(again - home, axis=2)[inner]
    assert np.median(off_px) < 0.1
    # The cameras are apart: their own pixels see other places.
    assert np.median(np.linalg.norm(there.there_px - home, axis=2)[inner]) > 1.0
    own = SamePlaces.of(drawn, drawn)
    assert np.median(np.linalg.norm(own.there_px - home, axis=2)[own.seen]) < 0.1


def test_a_dent_looks_as_it_was_drawn(
    built: Untouched, drawn: Untouched, moved: np.ndarray
) -> None:
    """The change from rest is a third as far off as that of the photograph as it is, or less."""
    wanted = photographed(drawn.studio, moved).astype(float) - drawn.idle
    photo = photographed(built.studio, moved)
    relight = Relight(built, drawn)
    found = relight.photo(photo).astype(float) - drawn.idle
    looked_at = relight.places.seen & (np.abs(wanted).max(axis=2) > 3.0)
    assert looked_at.sum() > 100

    def off(change: np.ndarray) -> float:
        return float(np.sqrt(((change - wanted)[looked_at] ** 2).mean()))

    as_it_is = off(photo.astype(float) - built.idle)
    assert off(found) < 0.35 * as_it_is
    # Moved to its place alone it is far off too: light has to be told as well.
    placed = relight.places.brought(photo.astype(float) - built.idle)
    assert off(found) < 0.6 * off(placed)


def test_an_untouched_sensor_shows_the_image_at_rest(built: Untouched, drawn: Untouched) -> None:
    """Within a grey level."""
    found = Relight(built, drawn).photo(built.idle.astype(np.uint8))
    assert np.abs(found - drawn.idle).max() < 1.0


def test_a_sensor_built_as_drawn_shows_what_it_shows(drawn: Untouched, moved: np.ndarray) -> None:
    """Relit to itself, a photograph changes by a fraction of how far it is from rest."""
    photo = photographed(drawn.studio, moved).astype(float)
    found = Relight(drawn, drawn).photo(photo.astype(np.uint8))
    changed = np.abs(photo - drawn.idle).max(axis=2) > 3.0
    off, size = (np.abs(each - photo)[changed].mean() for each in (found, drawn.idle))
    assert off < 0.25 * size


def test_saturated_colours_say_nothing(
    built: Untouched, drawn: Untouched, moved: np.ndarray
) -> None:
    """One colour clipped all over the dent: the others still tell more than the photograph does."""
    wanted = photographed(drawn.studio, moved).astype(float) - drawn.idle
    photo = photographed(built.studio, moved)
    clipped = photo.copy()
    clipped[:, :, 1] = 255
    relight = Relight(built, drawn)
    found, null = relight.photo(clipped) - drawn.idle, np.zeros_like(wanted)
    looked_at = relight.places.seen & (np.abs(wanted).max(axis=2) > 3.0)

    def off(change: np.ndarray) -> float:
        return float(np.sqrt(((change - wanted)[looked_at] ** 2).mean()))

    assert off(found) < off(null)
    assert np.abs(found[~looked_at]).max() < 20.0
