"""Sum-factorised B-spline sums against dense weight tables."""

import numpy as np

from sim.contact.grid.stencil import (
    gather_gradient,
    gradient_table,
    point_offsets,
    point_weights,
    scatter_gradient,
    weight_table,
)


def test_gather_equals_the_dense_table() -> None:
    """Eight gradients of 27 random values equal the table's, to rounding."""
    nodal = np.random.default_rng(0).normal(size=27)
    dense = np.einsum("pnc,n->pc", gradient_table(), nodal)
    np.testing.assert_allclose(np.array(gather_gradient(list(nodal))), dense, atol=1e-14)


def test_scatter_is_the_transpose_of_gather() -> None:
    """27 sums of 8 random vectors equal the transposed table's, to rounding."""
    flux = np.random.default_rng(1).normal(size=(8, 3))
    dense = np.einsum("pnc,pc->n", gradient_table(), flux)
    np.testing.assert_allclose(scatter_gradient([list(row) for row in flux]), dense, atol=1e-14)


def test_weights_reproduce_a_linear_field() -> None:
    """sum w = 1 and sum w x = x: quadratic B-splines are linearly complete."""
    axis = np.arange(-1.0, 2.0)
    nodes = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(27, 3)
    local = np.random.default_rng(2).uniform(-0.5, 0.5, (40, 3))
    weights = point_weights(local)
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-14)
    np.testing.assert_allclose(weights @ nodes, local, atol=1e-14)
    np.testing.assert_allclose(weight_table() @ nodes, point_offsets(), atol=1e-14)
