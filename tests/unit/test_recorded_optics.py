"""Figures that Mitsuba recorded: they belong to today's scenes, and a wrong product fails them."""

from __future__ import annotations

import dataclasses
import importlib.util
from typing import Any

import numpy as np
import pytest

from workbench.core.base.errors import StoreError
from workbench.core.design.optics import Optics
from workbench.proof.validation.optics import mitsuba_again, mitsuba_record, recorded_rows
from workbench.proof.validation.optics.mitsuba_record import FILE, recorded
from workbench.proof.validation.optics.recorded_images import photon_halves
from workbench.proof.validation.optics.recorded_rows import PLACES_LIMIT, TOTAL_LIMIT, likeness
from workbench.proof.validation.optics.recorded_scenes import HEIGHT_PX, SCENES, WIDTH_PX, cells

PAD = len(SCENES) - 1
"""The scene that is traced quickest."""


def test_the_record_is_of_todays_scenes() -> None:
    """Digest and moments fit; each square's standard error is far below what is asked."""
    assert FILE.stat().st_size < 300_000
    for number in range(len(SCENES)):
        found = recorded(number)
        assert found.mean.shape == found.error.shape == (6, 8, 3)
        assert likeness(found.mean, found).chance < PLACES_LIMIT["photons"] / 2.0
        assert (found.whole.sum(axis=(0, 1)) > found.mean.sum(axis=(0, 1))).all()


def test_another_scene_is_not_compared(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ring moved by 0.01 mm: the row fails and says that the record is to be made anew."""
    ring = dataclasses.replace(SCENES[PAD].ring, radius_mm=6.01)
    changed = (*SCENES[:PAD], dataclasses.replace(SCENES[PAD], ring=ring))
    for module in (mitsuba_record, recorded_rows):
        monkeypatch.setattr(module, "SCENES", changed)
    recorded.cache_clear()
    with pytest.raises(StoreError, match="another scene as pad, LEDs under the plate: record it"):
        recorded(PAD)
    (row,) = recorded_rows._scene_rows(PAD)
    assert not row.ok and row.name == "mitsuba_recorded" and "record it anew" in row.case


def test_another_body_is_not_compared(monkeypatch: pytest.MonkeyPatch) -> None:
    """An area that is off by a thousandth is another mesh."""
    real = mitsuba_record.moments
    monkeypatch.setattr(mitsuba_record, "moments", lambda scene: 1.001 * real(scene))
    recorded.cache_clear()
    with pytest.raises(StoreError, match="another body of pad"):
        recorded(PAD)


def test_squares_are_means_of_pixels() -> None:
    """An image whose pixels say their square gives these numbers back."""
    row, column = np.mgrid[:HEIGHT_PX, :WIDTH_PX] // 8
    image = np.repeat((10.0 * row + column)[:, :, None], 3, axis=2)
    assert np.array_equal(cells(image)[:, :, 0], 10.0 * np.arange(6)[:, None] + np.arange(8))


def _dropped_refraction(optics: Optics) -> Optics:
    return dataclasses.replace(optics, refractive_index=1.0)


def _lens_falls_off(optics: Optics) -> Optics:
    sensor = dataclasses.replace(optics.camera.sensor, vignetting=1.0)
    return dataclasses.replace(optics, camera=dataclasses.replace(optics.camera, sensor=sensor))


def _wide_lobe(optics: Optics) -> Optics:
    wide = dataclasses.replace(optics.coating, roughness=1.3 * optics.coating.roughness)
    return dataclasses.replace(optics, coating=wide)


def _less_base(optics: Optics) -> Optics:
    less = dataclasses.replace(optics.coating, albedo=0.0)
    return dataclasses.replace(optics, coating=less)


@pytest.mark.slow
@pytest.mark.parametrize(
    "wrong", [None, _dropped_refraction, _lens_falls_off, _wide_lobe, _less_base]
)
def test_a_wrong_product_fails(taichi_device: str, wrong: Any) -> None:
    """Ours passes; without refraction, with cos^4 too much, a lobe 30 % too wide it fails."""
    scene, record = SCENES[PAD], recorded(PAD)
    optics = wrong(scene.optics) if wrong else scene.optics
    found = likeness(cells(photon_halves(scene, optics, 2_000_000)).mean(axis=0), record)
    right = wrong is None
    assert (found.places <= PLACES_LIMIT["photons"]) == right
    assert (abs(found.total - 1.0) <= TOTAL_LIMIT["photons"]) == right


@pytest.mark.slow
def test_mitsuba_shows_the_record_again() -> None:
    """Where it is installed."""
    if importlib.util.find_spec("mitsuba") is None:
        pytest.skip("Mitsuba is not installed")
    found = mitsuba_again.again(PAD)
    record = recorded(PAD)
    assert mitsuba_again.strain(found["mean"], error=found["error"], record=record) < 1.5
