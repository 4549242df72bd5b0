"""Sums over nodes and points against NumPy."""

from __future__ import annotations

import numpy as np
import pytest

from sim.contact.engine import sum_kernels
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
    sum_kernels.surface_sums(forces.ravel(), held, BOUNDS, partial)
    still = (held == HELD_STILL)[:, None]
    expected = np.hstack([forces * ~still, forces * still])
    np.testing.assert_allclose(partial.reshape(2, 6), chunks(expected), rtol=1e-6)
