"""Peaks of a contact against integrals in closed form, on meshes of any size."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest

from geometry.surface.primitives import sphere
from geometry.surface.surface import vertex_areas_mm2, vertex_normals
from sim.forces.peaks import DISC_MM, largest_disc_N, peaks, pressure_MPa
from workbench.core.result.results import Skin

HALF_MM = 5.0
RADIUS_MM = 2.0
"""Of Hertz's patch."""
MOST_MPa = 0.2


def skin_of(points: np.ndarray, faces: np.ndarray) -> Skin:
    return Skin(points_mm=points, faces=faces, normals=vertex_normals(points, faces))


def flat(spacing_mm: float, *, shaken: float = 0.0) -> Skin:
    """A square at z = 0, its vertices moved aside by up to a share of their spacing."""
    side = np.linspace(-HALF_MM, HALF_MM, round(2.0 * HALF_MM / spacing_mm) + 1)
    x, y = np.meshgrid(side, side, indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    away = np.random.default_rng(3).uniform(-1.0, 1.0, (x.size, 2))
    points[:, :2] += shaken * spacing_mm * away
    number = np.arange(x.size).reshape(x.shape)
    a, b = number[:-1, :-1].ravel(), number[1:, :-1].ravel()
    c, d = number[1:, 1:].ravel(), number[:-1, 1:].ravel()
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32)
    return skin_of(points, faces)


def pressed_by(skin: Skin, pressure: np.ndarray) -> np.ndarray:
    """Nodal forces of a pressure at the vertices (V,), against the normal."""
    area_mm2 = vertex_areas_mm2(skin.points_mm, skin.faces)
    return -(pressure * area_mm2)[:, None] * skin.normals


def hertz_MPa(skin: Skin) -> np.ndarray:
    away = (skin.points_mm[:, :2] ** 2).sum(axis=1)
    return MOST_MPa * np.sqrt(np.maximum(1.0 - away / RADIUS_MM**2, 0.0))


def hertz_N(disc_mm: float) -> float:
    """2 pi p a^2 / 3 (1 - (1 - r^2 / a^2)^(3/2)) within r = d / 2 of the middle."""
    inside = 1.0 - (1.0 - (0.5 * disc_mm / RADIUS_MM) ** 2) ** 1.5
    return 2.0 / 3.0 * math.pi * MOST_MPa * RADIUS_MM**2 * inside


@pytest.mark.parametrize("spacing_mm", [0.9, 0.45, 0.2, 0.1])
@pytest.mark.parametrize("shaken", [0.0, 0.25])
@pytest.mark.parametrize("disc_mm", [1.0, 2.0])
def test_a_uniform_pressure_acts_on_the_area_of_the_disc(
    spacing_mm: float, shaken: float, disc_mm: float
) -> None:
    """p pi d^2 / 4; the best of many centres is up to 1.5 % above it."""
    skin = flat(spacing_mm, shaken=shaken)
    found_N = largest_disc_N(skin, pressed_by(skin, np.full(len(skin.points_mm), MOST_MPa)),
                             disc_mm=disc_mm)  # fmt: skip
    assert found_N == pytest.approx(MOST_MPa * math.pi * disc_mm**2 / 4.0, rel=0.015)


@pytest.mark.parametrize(("spacing_mm", "off"), [(0.45, 0.02), (0.2, 0.01), (0.1, 0.01)])
@pytest.mark.parametrize("disc_mm", [1.0, 2.0])
def test_hertz_s_pressure_is_integrated_over_the_disc(
    spacing_mm: float, off: float, disc_mm: float
) -> None:
    """The closed form; chords of the pressure lie below its arc by h^2."""
    skin = flat(spacing_mm, shaken=0.25)
    found_N = largest_disc_N(skin, pressed_by(skin, hertz_MPa(skin)), disc_mm=disc_mm)
    assert found_N == pytest.approx(hertz_N(disc_mm), rel=off)


def test_a_coarse_and_a_fine_mesh_read_the_same() -> None:
    """Disc and pressure of 0.9 and 0.1 mm to 6 %, where vertices differ by a factor of 81."""
    coarse, fine = flat(0.9), flat(0.1)
    forces = [pressed_by(skin, hertz_MPa(skin)) for skin in (coarse, fine)]
    one, other = (
        peaks(skin, force, np.zeros_like(force))
        for skin, force in zip((coarse, fine), forces, strict=True)
    )
    assert one.peak_disc_N == pytest.approx(other.peak_disc_N, rel=0.06)
    # The vertex nearest to the middle of the coarse mesh is 0.64 mm away from it.
    assert one.peak_MPa == pytest.approx(other.peak_MPa, rel=0.06)
    largest = [np.linalg.norm(force, axis=1).max() for force in forces]
    assert largest[0] / largest[1] > 70.0


def test_a_point_load_passes_through_the_disc_whole() -> None:
    """One loaded vertex of a fine mesh: all of its force, sideways share included."""
    skin = flat(0.2)
    force = np.zeros((len(skin.points_mm), 3))
    force[len(force) // 2] = (0.3, 0.0, -0.4)
    assert largest_disc_N(skin, force) == pytest.approx(0.5, rel=1e-9)


def test_opposite_pulls_within_a_disc_cancel() -> None:
    """0.1 N to either side: a disc over both reads nothing, so the largest holds one of them."""
    skin = flat(0.2)
    force = np.zeros((len(skin.points_mm), 3))
    middle = len(force) // 2
    force[middle, 0], force[middle + 2, 0] = 0.1, -0.1
    assert largest_disc_N(skin, force, disc_mm=4.0) < 0.101
    force[middle + 2, 0] = 0.1
    assert largest_disc_N(skin, force) == pytest.approx(0.2, rel=1e-9)


def test_two_contacts_are_not_added_up() -> None:
    """Point loads of 1 and 2 N, 4 mm apart: the disc over the larger."""
    skin = flat(0.2)
    force = np.zeros((len(skin.points_mm), 3))
    for place, size in ((-2.0, 1.0), (2.0, 2.0)):
        away = np.linalg.norm(skin.points_mm - [place, 0.0, 0.0], axis=1)
        force[away.argmin(), 2] = -size
    assert largest_disc_N(skin, force) == pytest.approx(2.0, rel=1e-9)


def test_pressure_on_a_ball_is_what_was_put_there() -> None:
    """0.2 MPa all around, at rest and after the skin was moved as a whole."""
    skin = skin_of(*sphere(6.0))
    force = pressed_by(skin, np.full(len(skin.points_mm), MOST_MPa))
    moved = np.full_like(force, 0.3)
    assert np.allclose(pressure_MPa(skin, force, moved), MOST_MPa, rtol=1e-9)
    assert peaks(skin, force, moved).peak_MPa == pytest.approx(MOST_MPa, rel=1e-9)
    # The cap within 1 mm of its middle has the area of the disc, its forces lean inward by 1 in 72.
    cap_N = MOST_MPa * math.pi * DISC_MM**2 / 4.0
    assert largest_disc_N(skin, force) == pytest.approx(cap_N, rel=0.03)


def test_no_force_has_no_peak() -> None:
    """0 of both, not an error."""
    skin = flat(0.9)
    none = np.zeros((len(skin.points_mm), 3))
    found = peaks(skin, none, none)
    assert found.peak_MPa == found.peak_disc_N == 0.0


def test_it_keeps_up_with_frames() -> None:
    """Below 20 ms for 6,000 vertices of 0.13 mm under a patch of 4 mm, median of five."""
    skin = flat(0.13)
    assert 5_500 < len(skin.points_mm) < 6_500
    force = pressed_by(skin, hertz_MPa(skin))
    largest_disc_N(skin, force)
    seconds = []
    for _ in range(5):
        begun = time.process_time()
        peaks(skin, force, np.zeros_like(force))
        seconds.append(time.process_time() - begun)
    assert sorted(seconds)[2] < 0.02
