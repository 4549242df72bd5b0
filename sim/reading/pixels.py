"""What pixels say about the tilts of the triangles that they see, summed over each triangle.

A pixel sees a mean of the light of three vertices, and each vertex's light follows from its tilt: a
residual of one colour has six derivatives. Sums of their products over the pixels of a triangle are
all that a least-squares step needs of the image.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True, slots=True)
class Evidence:
    """Of f triangles, whose corners have the tilts t."""

    products: np.ndarray
    """Sums of J^T W J, shape (f, 6, 6); rows and columns are corner by corner, p before q."""
    pulls: np.ndarray
    """Sums of J^T W r, shape (f, 6)."""


def gathered(
    triangles: np.ndarray,
    count: int,
    jacobian: np.ndarray,
    residual: np.ndarray,
    weight: np.ndarray,
) -> Evidence:
    """Sum over triangles.

    Args:
        triangles: That each of P pixels sees, shape (P,).
        count: f.
        jacobian: Of what a pixel shows by the tilts, shape (P, 3 colours, 6).
        residual: Photo less prediction, shape (P, 3).
        weight: One over variance, shape (P, 3).
    """
    order = np.argsort(triangles, kind="stable")
    seen, starts = np.unique(triangles[order], return_index=True)
    slopes = jacobian[order]
    weighted = slopes * weight[order][:, :, None]
    products = np.zeros((count, 6, 6))
    pulls = np.zeros((count, 6))
    if len(seen):
        each = np.matmul(weighted.transpose(0, 2, 1), slopes)
        products[seen] = np.add.reduceat(each, starts, axis=0)
        pull = np.einsum("pci,pc->pi", weighted, residual[order])
        pulls[seen] = np.add.reduceat(pull, starts, axis=0)
    return Evidence(products=products, pulls=pulls)


def on_tilts(faces: np.ndarray, count: int, evidence: Evidence):
    """The same about all tilts: a sparse matrix (2 n, 2 n) and a vector (2 n,).

    Args:
        faces: Triangles by vertices, shape (f, 3).
        count: n.
        evidence: Of the triangles.
    """
    from scipy.sparse import coo_matrix

    rows = (2 * faces[:, :, None] + np.arange(2)).reshape(-1, 6)
    ends = np.repeat(rows, 6, axis=1).ravel(), np.tile(rows, (1, 6)).ravel()
    size = 2 * count
    matrix = coo_matrix((evidence.products.ravel(), ends), (size, size)).tocsr()
    return matrix, np.bincount(rows.ravel(), evidence.pulls.ravel(), minlength=size)
