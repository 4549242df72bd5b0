"""Pressure and force of a read displacement, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from sim.contact.studies.closed_forms import hertz_ball_N, press_ball
from sim.reading.ball import ball_radius_mm
from sim.reading.force import read_force
from sim.reading.layer_law import Layer, influence_mm_per_MPa, pressure_MPa
from workbench.core.design.design import Elastomer

YOUNG_MPA, POISSON = 0.145, 0.45
RADIUS_MM = 3.0


def disc(reach_mm: float, spacing_mm: float) -> np.ndarray:
    """Places of a plane grid within a circle, shape (n, 3)."""
    line = np.arange(-reach_mm, reach_mm + spacing_mm / 2, spacing_mm)
    x, y = np.meshgrid(line, line)
    places = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    return places[np.hypot(x, y).ravel() <= reach_mm]


def hertz(depth_mm: float, away_mm: np.ndarray) -> np.ndarray:
    """Displacement of a half-space under a ball, in the contact and beside it: Johnson, 3.42."""
    a = np.sqrt(RADIUS_MM * depth_mm)
    away_mm = np.maximum(away_mm, 1e-9)
    ratio = np.minimum(a / away_mm, 1.0)
    beside = (2.0 * a**2 - away_mm**2) * np.arcsin(ratio)
    beside += away_mm * a * np.sqrt(1.0 - ratio**2)
    within = depth_mm - away_mm**2 / (2.0 * RADIUS_MM)
    return np.where(away_mm < a, within, beside / (np.pi * RADIUS_MM))


def test_a_thick_layer_needs_the_force_of_hertz() -> None:
    """Within 1 %, and the pressure in the middle within 1 %; 0 beside the contact."""
    layer = Layer(thickness_mm=200.0, young_MPa=YOUNG_MPA, poisson=POISSON)
    depth_mm, spacing_mm = 0.3, 0.12
    places = disc(1.2, spacing_mm)
    away_mm = np.linalg.norm(places, axis=1)
    area_mm2 = np.full(len(places), spacing_mm**2)
    influence = influence_mm_per_MPa(layer, places, area_mm2)
    found = pressure_MPa(influence, hertz(depth_mm, away_mm))
    modulus = YOUNG_MPA / (1.0 - POISSON**2)
    material = Elastomer(young_MPa=YOUNG_MPA, poisson=POISSON)
    force_N = hertz_ball_N(material, radius_mm=RADIUS_MM, depth_mm=depth_mm)
    assert found @ area_mm2 == pytest.approx(force_N, rel=0.01)
    assert found.max() == pytest.approx(
        2.0 * modulus / np.pi * np.sqrt(depth_mm / RADIUS_MM), rel=0.01
    )
    a = np.sqrt(RADIUS_MM * depth_mm)
    assert found[away_mm > a + spacing_mm].sum() < 0.01 * found.sum()


def test_a_thin_layer_is_confined() -> None:
    """Long waves see the modulus of a layer that cannot go sideways, short ones a half-space."""
    layer = Layer(thickness_mm=2.0, young_MPa=YOUNG_MPA, poisson=POISSON)
    confined_MPa = YOUNG_MPA * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON))
    assert layer.compliance(np.array([1e-3]))[0] == pytest.approx(2.0 / confined_MPa, rel=1e-4)
    wave = 40.0
    free = 2.0 * (1.0 - POISSON**2) / (YOUNG_MPA * wave)
    assert layer.compliance(np.array([wave]))[0] == pytest.approx(free, rel=1e-6)


@pytest.mark.parametrize("poisson", [0.3, 0.45, 0.49])
@pytest.mark.parametrize("depth_mm", [0.1, 0.3])
def test_a_layer_needs_the_force_of_exact_elasticity(poisson: float, depth_mm: float) -> None:
    """A ball on 2 mm, within 2 %: the integral equation that contact solvers are judged by."""
    layer = Layer(thickness_mm=2.0, young_MPa=YOUNG_MPA, poisson=poisson)
    exact = press_ball(
        Elastomer(young_MPa=YOUNG_MPA, poisson=poisson),
        radius_mm=RADIUS_MM,
        height_mm=2.0,
        depth_mm=depth_mm,
    )
    spacing_mm = exact.radius_mm / 12.0
    places = disc(exact.radius_mm, spacing_mm)
    away_mm = np.linalg.norm(places, axis=1)
    inward_mm = depth_mm - RADIUS_MM + np.sqrt(RADIUS_MM**2 - away_mm**2)
    area_mm2 = np.full(len(places), np.pi * exact.radius_mm**2 / len(places))
    down = np.tile([0.0, 0.0, -1.0], (len(places), 1))
    found = read_force(layer, places, down, area_mm2, (inward_mm, np.zeros(len(places))))
    assert -found.force_N[2] == pytest.approx(exact.force_N, rel=0.02)
    assert 0.1 * exact.force_N < found.sigma_N < 0.3 * exact.force_N


def test_nothing_touched_needs_no_force() -> None:
    """And no law."""
    layer = Layer(thickness_mm=2.0, young_MPa=YOUNG_MPA, poisson=POISSON)
    nothing = np.zeros((0, 3))
    found = read_force(layer, nothing, nothing, np.zeros(0), (np.zeros(0), np.zeros(0)))
    assert not found.force_N.any()
    assert found.sigma_N == 0.0


def test_a_ball_in_a_plane_has_its_radius() -> None:
    """Of a cap pressed .5 mm in, with a stray vertex; a flat dent has none."""
    places = disc(1.6, 0.2)
    away_mm = np.linalg.norm(places, axis=1)
    inward_mm = np.maximum(0.5 - RADIUS_MM + np.sqrt(RADIUS_MM**2 - away_mm**2), 0.0)
    down = np.tile([0.0, 0.0, -1.0], (len(places), 1))
    assert ball_radius_mm(places, down, inward_mm) == pytest.approx(RADIUS_MM, rel=1e-3)
    inward_mm[np.argmin(away_mm)] += 0.05
    assert ball_radius_mm(places, down, inward_mm) == pytest.approx(RADIUS_MM, rel=0.08)
    assert np.isnan(ball_radius_mm(places, down, np.full(len(places), 0.3)))
