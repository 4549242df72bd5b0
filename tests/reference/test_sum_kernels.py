"""Sums over nodes and points against NumPy."""

from __future__ import annotations

import itertools
from types import SimpleNamespace

import numpy as np
import pytest

from sim.contact.engine import sum_kernels
from sim.contact.engine.batch import floats, integers
from sim.contact.engine.sums import Sums
from sim.contact.grid.layout import FREE, HELD_STILL

pytestmark = pytest.mark.usefixtures("taichi_device")

BOUNDS = np.array([0, 3, 3, 5], dtype=np.int32)
"""Two chunks: three rows and two."""


def chunks(values: np.ndarray) -> np.ndarray:
    """Sums of the rows of each chunk."""
    return np.stack([values[:3].sum(axis=0), values[3:].sum(axis=0)])


def test_node_sums_leave_out_the_force_of_fixed_nodes() -> None:
    """Work and inertia of all; force and its square of free nodes, each by three numbers."""
    random = np.random.default_rng(1)
    forces = random.normal(size=(5, 3)).astype(np.float32)
    powers = random.normal(size=(5, 2)).astype(np.float32)
    fixed = np.array([0, 1, 0, 0, 0], dtype=np.int32)
    partial = np.zeros(12)
    sum_kernels.node_sums(forces.ravel(), powers.ravel(), fixed, BOUNDS, partial)
    free = forces.astype(np.float64) * (fixed == 0)[:, None]
    expected = np.column_stack([powers, (free**2).sum(axis=1), free])
    np.testing.assert_allclose(partial.reshape(2, 6), chunks(expected), rtol=1e-6)


def test_surface_sums_part_contact_from_holding() -> None:
    """The first three of a chunk are of points that move freely, the rest of held ones."""
    forces = np.random.default_rng(2).normal(size=(5, 3)).astype(np.float32)
    held = np.array([FREE, HELD_STILL, FREE, HELD_STILL, FREE], dtype=np.int32)
    partial = np.zeros(12)
    sum_kernels.surface_sums(forces.ravel(), held, BOUNDS, 0, partial)
    still = (held == HELD_STILL)[:, None]
    expected = np.hstack([forces * ~still, forces * still])
    np.testing.assert_allclose(partial.reshape(2, 6), chunks(expected), rtol=1e-6)


def test_folded_rows_are_sums_of_their_chunks() -> None:
    """In the order of the rows."""
    rows = np.random.default_rng(3).normal(size=(5, 6))
    sums = np.zeros(12)
    sum_kernels.fold(rows.ravel(), BOUNDS, sums)
    np.testing.assert_allclose(sums.reshape(2, 6), chunks(rows), rtol=1e-12)


def test_sums_of_cases_are_those_of_their_rows() -> None:
    """Of three cases: a large one of many chunks, a small one, and one without surface points."""
    random = np.random.default_rng(4)
    nodes, points = [0, 5000, 5032, 5064], [0, 1100, 1103, 1103]
    forces, pushes = random.normal(size=(5064, 3)), random.normal(size=(1103, 3))
    powers, fixed = random.normal(size=(5064, 2)), random.integers(0, 2, 5064)
    held = random.choice([FREE, HELD_STILL], 1103)
    sums = Sums(
        SimpleNamespace(forces=floats(forces), powers=floats(powers), fixed=integers(fixed)),
        SimpleNamespace(point_forces=floats(pushes), held=integers(held)),
        nodes,
        points,
    )
    of_nodes, of_points = sums.read()
    free, still = forces * (fixed == 0)[:, None], (held == HELD_STILL)[:, None]
    expected = np.column_stack([powers, (free**2).sum(axis=1), free])
    np.testing.assert_allclose(of_nodes, over_cases(expected, nodes), rtol=1e-6, atol=1e-5)
    expected = np.hstack([pushes * ~still, pushes * still])
    np.testing.assert_allclose(of_points, over_cases(expected, points), rtol=1e-6, atol=1e-5)


def over_cases(values: np.ndarray, starts: list[int]) -> np.ndarray:
    """Sums of the rows of each case."""
    return np.stack([values[a:b].sum(axis=0) for a, b in itertools.pairwise(starts)])
