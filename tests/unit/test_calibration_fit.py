"""Powers, depths, residual and polynomial of a calibration on data whose truth is known."""

from __future__ import annotations

import numpy as np
import pytest

from sim.optics.raster.display import shown
from sim.optics.studio.unit_residual import (
    STEEPEST,
    UnitResidual,
    places,
    read_unit,
    slopes,
    unit_bytes,
)
from workbench.calibration.light_basis import LightBasis, PressSamples, sampled
from workbench.calibration.polynomial import fit_polynomial, terms
from workbench.calibration.powers import Targets, fit_powers, worth_keeping
from workbench.calibration.residual import REACH, Slopes, fit_residual
from workbench.calibration.seen.contact_circle import contact_shift
from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import silent
from workbench.core.design.camera import Camera, ImageSensor
from workbench.core.design.lighting import Lamp
from workbench.core.design.unit import unit

PIXELS, LIGHTS, PRESSES = 400, 6, 8
DEPTHS = np.array([0.4, 0.8, 1.2, 1.6])


def problem(sensor: ImageSensor) -> tuple[LightBasis, Targets, np.ndarray, np.ndarray]:
    """Lights, photographs in grey levels without rounding, true powers (3, L) and depths."""
    random = np.random.default_rng(3)
    rest = random.uniform(0.5, 1.5, (PIXELS, LIGHTS))
    ambient = random.uniform(0.8, 1.2, PIXELS)
    # Change grows with depth, and not in proportion: that is what tells the depth.
    shape = random.normal(0.0, 0.5, (PRESSES, 2, PIXELS, LIGHTS))
    bend = DEPTHS[:, None, None]
    change = [bend * one + bend**2 * other for one, other in shape]
    powers = random.uniform(0.0, 0.1, (3, LIGHTS))
    powers[0, 3:] = powers[1, :2] = powers[2, 2:4] = 0.0
    glow = np.array([0.10, 0.05, 0.08])
    depths = random.uniform(0.5, 1.5, PRESSES)
    basis = LightBasis(
        lights=tuple(Lamp() for _ in range(LIGHTS)),
        rest_pixel=np.arange(PIXELS),
        rest=rest.astype(np.float32),
        ambient=ambient.astype(np.float32),
        presses=tuple(
            PressSamples(pixel=np.arange(PIXELS), depths_mm=DEPTHS, change=each.astype(np.float32))
            for each in change
        ),
    )
    light = rest @ powers.T + ambient[:, None] * glow
    idle = 255.0 * shown(light, sensor)
    photos = [
        (255.0 * shown(light + samples.at(depth) @ powers.T, sensor), idle)
        for samples, depth in zip(basis.presses, depths, strict=True)
    ]
    return basis, Targets(idle=idle, presses=photos), np.vstack([powers.T, glow]).T, depths


@pytest.mark.parametrize("sensor", [ImageSensor(), ImageSensor(gamma=1.0)], ids=["sRGB", "linear"])
def test_powers_colours_ambient_and_depths_are_found(sensor: ImageSensor) -> None:
    """What made the photographs comes back, with each depth an unknown of its own."""
    basis, targets, true, depths = problem(sensor)
    found = fit_powers(basis, targets, sensor, silent)
    # Alternating ends within 1 % of the strongest; nothing here is rounded.
    assert found.lights == pytest.approx(true[:, :LIGHTS], abs=0.01 * true.max())
    assert found.ambient == pytest.approx(true[:, LIGHTS], abs=0.01 * true.max())
    assert found.depths_mm == pytest.approx(depths, abs=0.03)
    assert found.error_grey < 0.1 * found.null_grey


def test_lights_that_give_nothing_are_left_out() -> None:
    """A light of power 0 in all colours goes, the others stay in their order."""
    basis, targets, _, _ = problem(ImageSensor(gamma=1.0))
    found = fit_powers(basis, targets, ImageSensor(gamma=1.0), silent)
    found.lights[:, 4] = 0.0
    kept = worth_keeping(basis, found)
    assert kept.tolist() == [0, 1, 2, 3, 5]
    assert basis.only(kept).rest.shape == (PIXELS, 5)


def test_a_press_of_known_depth_has_one_level() -> None:
    """Its depth is not touched."""
    basis, targets, _, _ = problem(ImageSensor(gamma=1.0))
    first = basis.presses[0]
    known = PressSamples(pixel=first.pixel, depths_mm=DEPTHS[1:2], change=first.change[1:2])
    changed = LightBasis(
        lights=basis.lights,
        rest_pixel=basis.rest_pixel,
        rest=basis.rest,
        ambient=basis.ambient,
        presses=(known, *basis.presses[1:]),
    )
    found = fit_powers(changed, targets, ImageSensor(gamma=1.0), silent)
    assert found.depths_mm[0] == DEPTHS[1]


def seen(count: int, middle: float, seed: int) -> Slopes:
    """Slopes and places of a press about a place."""
    random = np.random.default_rng(seed)
    return Slopes(
        slope=random.uniform(-0.8, 0.8, (count, 2)),
        place=middle + random.uniform(-0.15, 0.15, (count, 2)),
        pixel=np.arange(count),
    )


def bent(at: Slopes) -> np.ndarray:
    """A residual no polynomial of second order has, (P, 3) grey levels."""
    wave = np.sin(4.0 * at.slope[:, 0]) * np.exp(-(at.slope[:, 1] ** 2))
    return 20.0 * wave[:, None] * np.array([1.0, -0.5, 0.2])


def test_the_residual_predicts_near_and_vanishes_far() -> None:
    """A tenth of it is left at slopes and places like those seen; far away it adds nothing."""
    presses = [seen(900, middle, number) for number, middle in enumerate((-0.2, 0.0, 0.2))]
    usable = [np.ones(900, dtype=bool)] * 3
    centres, weights = fit_residual(presses, [bent(each) for each in presses], usable)
    idle = np.full((4, 4, 3), 9, np.uint8)
    import cv2

    data = unit_bytes(cv2.imencode(".png", idle)[1].tobytes(), centres, weights, REACH)
    kept = read_unit(unit("unit.npz", data))
    near, far = seen(500, 0.1, 9), seen(500, 6.0, 9)
    error = kept.change(near.slope, near.place) - bent(near)
    assert np.sqrt((error**2).mean()) < 0.1 * np.sqrt((bent(near) ** 2).mean())
    assert np.abs(kept.change(far.slope, far.place)).max() < 0.01
    assert not kept.change(np.zeros((3, 2)), near.place[:3]).any(), "skin at rest stays as it is"


def test_the_polynomial_is_exact_for_its_own_terms() -> None:
    """36 numbers of each colour come back."""
    presses = [seen(400, middle, number) for number, middle in enumerate((-0.3, 0.1, 0.3))]
    true = np.random.default_rng(1).normal(size=(36, 3))
    found = fit_polynomial(presses, [terms(each) @ true for each in presses])
    assert terms(presses[0]) @ found == pytest.approx(terms(presses[0]) @ true, abs=1e-8)


def test_slopes_are_those_of_a_plane_along_the_images_axes() -> None:
    """z = .3 x - .2 y looked at from below along z; a plane at rest has none."""
    normal = np.array([0.3, -0.2, -1.0]) / np.linalg.norm([0.3, -0.2, -1.0])
    rest = np.array([0.0, 0.0, -1.0])
    got = slopes(normal[None], rest[None], Camera())
    assert np.abs(got[0]) == pytest.approx([0.3, 0.2])
    assert not slopes(rest[None], rest[None], Camera()).any()
    upside = slopes(np.array([[1.0, 0.0, 0.0]]), rest[None], Camera())
    assert np.abs(upside).max() <= STEEPEST
    corner = places(np.array([0, 639, 640 * 479]), 640, 480)
    assert np.linalg.norm(corner, axis=1) == pytest.approx(1.0, abs=2e-3)


def test_a_damaged_unit_is_refused() -> None:
    """By its name, with what to do."""
    whole = unit_bytes(b"", np.zeros((2, 4)), np.zeros((2, 3)), REACH)
    for data in (b"", b"no archive", whole[: len(whole) // 2]):
        with pytest.raises(DesignError, match=r"mine\.npz") as caught:
            read_unit(unit("mine.npz", data))
        assert caught.value.at == "optics.unit"
    with pytest.raises(DesignError, match="is not what a calibration writes"):
        unit("idle.png", b"")


def test_samples_cover_a_box_evenly() -> None:
    """Some 2,500 of a large one, all of a small one."""
    assert 2000 < len(sampled(slice(0, 480), slice(0, 640), 640)) < 3200
    small = sampled(slice(3, 6), slice(2, 4), 10)
    assert small.tolist() == [32, 33, 42, 43, 52, 53]


def test_an_empty_residual_changes_nothing() -> None:
    """A unit may hold the image at rest alone."""
    import cv2

    idle = cv2.imencode(".png", np.zeros((4, 4, 3), np.uint8))[1].tobytes()
    kept: UnitResidual = read_unit(
        unit("u.npz", unit_bytes(idle, np.zeros((0, 4)), np.zeros((0, 3)), REACH))
    )
    assert not kept.change(np.ones((5, 2)), np.ones((5, 2))).any()


@pytest.mark.parametrize("true", [(1.3, -0.8), (0.0, 2.5), (-3.2, 0.4)])
def test_a_contact_is_moved_to_where_it_was_photographed(true: tuple[float, float]) -> None:
    """A dent in three colours, drawn anew elsewhere, with noise: to a tenth of a pixel."""

    def dent(column: float, row: float) -> np.ndarray:
        y, x = np.mgrid[:60, :70].astype(float)
        bump = np.exp(-((x - column) ** 2 + (y - row) ** 2) / 120.0)
        return bump[..., None] * np.stack([x - column, y - row, column - x + y - row], axis=-1)

    noise = np.random.default_rng(4).normal(0.0, 0.2, (60, 70, 3))
    taken = dent(34.0 + true[0], 31.0 + true[1]) + noise
    found = contact_shift(dent(34.0, 31.0), taken, np.ones(taken.shape, dtype=bool))
    assert found == pytest.approx(true, abs=0.1)


def test_an_even_image_tells_no_shift() -> None:
    """Without slopes there is nothing to move."""
    flat = np.ones((20, 20, 3))
    assert not contact_shift(0.0 * flat, flat, flat > 0.0).any()


def test_a_residual_that_no_other_place_knows_is_left_out() -> None:
    """Each press is off in its own way: learned by heart, it would be wrong everywhere else."""
    presses = [seen(900, middle, number) for number, middle in enumerate((-0.2, 0.0, 0.2))]
    usable = [np.ones(900, dtype=bool)] * 3
    off = [way * bent(each) for way, each in zip((1.0, -1.0, 1.0), presses, strict=True)]
    centres, weights = fit_residual(presses, off, usable)
    assert centres.shape == (0, 4) and weights.shape == (0, 3)
    alike, _ = fit_residual(presses, [bent(each) for each in presses], usable)
    assert len(alike) > 100
