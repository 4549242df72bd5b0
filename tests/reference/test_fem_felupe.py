"""Our hexahedra against those of felupe, an independent finite-element library.

Its nearly incompressible body is the same three-field formulation, pressure and volume ratio
constant in each cell. It is GPL: tests compare with it, nothing of ours imports it.
"""

from __future__ import annotations

import numpy as np
import pytest

from sim.fem.elements import evaluate, make_elements
from sim.fem.sparse_system import make_system
from sim.fem.studies.blocks import irregular_block

felupe = pytest.importorskip("felupe")

SHEAR_MPa, BULK_MPa = 0.05, 0.48333


@pytest.mark.parametrize("strain", [1e-3, 0.1])
def test_forces_and_stiffness_equal_felupe(strain: float) -> None:
    """The same nodal forces and the same stiffness, to 1e-12 of the largest."""
    points_mm, cells = irregular_block(cells=4)
    motion_mm = np.random.default_rng(2).normal(0.0, 0.25 * strain, points_mm.shape)
    elements = make_elements(points_mm, cells, shear_MPa=SHEAR_MPa, bulk_MPa=BULK_MPa)
    ours = evaluate(elements, motion_mm, tangent=True)
    assert ours.tangent_N_mm is not None
    system = make_system(len(points_mm), cells, np.zeros(len(points_mm), dtype=bool))
    force_N = system.gather(cells, ours.force_N).ravel()
    stiffness = system.matrix((system.slots(cells), ours.tangent_N_mm)).toarray()

    region = felupe.RegionHexahedron(felupe.Mesh(points_mm, cells, "hexahedron"))
    field = felupe.FieldContainer([felupe.Field(region, dim=3)])
    field[0].values[:] = motion_mm
    body = felupe.SolidBodyNearlyIncompressible(felupe.NeoHooke(mu=SHEAR_MPa), field, bulk=BULK_MPa)
    theirs_N = body.assemble.vector(field).toarray().ravel()
    theirs = body.assemble.matrix(field).toarray()

    # Differences of 1e-3 in F have lost three of sixteen digits.
    assert np.abs(force_N - theirs_N).max() < 1e-12 * np.abs(theirs_N).max()
    assert np.abs(stiffness - theirs).max() < 1e-12 * np.abs(theirs).max()
