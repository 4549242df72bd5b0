"""Two sources of the forces of one press: totals and disagreement in closed form."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from workbench.core.force_field import ForceField, Source
from workbench.force_sources import disagreement, totals


def field(moved_mm: float, force_N: float, source: Source = Source.FEM) -> ForceField:
    """One frame: a skin of four vertices, one of which moves and carries a force, in -Z and X."""
    displacement = np.zeros((1, 4, 3), np.float32)
    displacement[0, 0, 2] = -moved_mm
    force = np.zeros((1, 4, 3), np.float32)
    force[0, 0] = (0.25 * force_N, 0.0, -force_N)
    return ForceField(
        source=source,
        displacement_mm=displacement,
        contact_force_N=force,
        reaction_N=-force.sum(axis=1).astype(np.float64),
        target_mm=np.zeros(3),
        normal=np.array([0.0, 0.0, 1.0]),
        tangent_u=np.array([1.0, 0.0, 0.0]),
        indenter_pose=np.zeros((1, 7)),
        residual=np.array([1e-7]),
        balance=np.zeros(1),
        converged=np.ones(1, bool),
    )


def test_totals_split_the_reaction() -> None:
    """2 N inward with 0.5 N along X: normal 2, tangential 0.5, peak their hypotenuse."""
    found = totals(Source.FEM, field(1.0, 2.0), 0)
    assert found.normal_N == pytest.approx(2.0)
    assert found.tangential_N == pytest.approx(0.5)
    assert found.peak_N == pytest.approx(np.hypot(2.0, 0.5), rel=1e-6)
    assert found.residual == pytest.approx(1e-7)


def test_disagreement_is_relative_to_the_second() -> None:
    """1.1 against 1.0 mm and 1.8 against 2 N: 0.1 mm of one vertex that moves, -10 %."""
    found = disagreement(field(1.1, 1.8, Source.MPM), field(1.0, 2.0), 0)
    assert found.displacement_mm == pytest.approx(0.1, rel=1e-5)
    assert found.farthest_mm == pytest.approx(1.0)
    assert found.normal_share == pytest.approx(-0.1)


def test_a_skin_at_rest_says_nothing() -> None:
    """Nothing moves and nothing presses: no difference, and no share of nothing."""
    found = disagreement(field(0.0, 0.0), field(0.0, 0.0), 0)
    assert found.displacement_mm == found.farthest_mm == 0.0
    assert np.isnan(found.normal_share)


def test_the_reaction_of_learned_forces_has_no_residual() -> None:
    """NaN stands for what is not solved for."""
    learned = dataclasses.replace(field(1.0, 2.0, Source.LEARNED), residual=np.array([np.nan]))
    assert np.isnan(totals(Source.LEARNED, learned, 0).residual)
