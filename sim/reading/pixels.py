"""What pixels say about the tilts of the triangles that they see, summed over each triangle.

A pixel sees a mean of the light of three vertices, and each vertex's light follows from its tilt: a
residual of one colour has six derivatives. Sums of their products over the pixels of a triangle are
all that a least-squares step needs of the image.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.reading import pixel_kernels


@dataclass(frozen=True, kw_only=True, slots=True)
class Slopes:
    """How what P blocks of pixels show changes with the tilts of n vertices of f triangles."""

    faces: np.ndarray
    """Triangles by vertices, shape (f, 3)."""
    triangles: np.ndarray
    """That each block sees, shape (P,); -1 of others."""
    corner_weights: np.ndarray
    """Of the triangle's corners there, shape (P, 3)."""
    grey: np.ndarray
    """Grey levels by radiance, shape (P, 3 colours)."""
    light: np.ndarray
    """Radiance of the vertices by their tilts, shape (n, 3 colours, 2)."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Evidence:
    """Of f triangles, whose corners have the tilts t."""

    products: np.ndarray
    """Sums of J^T W J, shape (f, 6, 6); rows and columns are corner by corner, p before q."""
    pulls: np.ndarray
    """Sums of J^T W r, shape (f, 6)."""


def gathered(slopes: Slopes, residual: np.ndarray, weight: np.ndarray) -> Evidence:
    """Sum over triangles, on the compute device, which must be open.

    Args:
        slopes: Of the blocks.
        residual: Photo less prediction, shape (P, 3).
        weight: One over variance, shape (P, 3).
    """
    count = len(slopes.faces)
    known = np.flatnonzero(slopes.triangles >= 0)
    triangles = slopes.triangles[known]
    blocks = known[np.argsort(triangles, kind="stable")]
    starts = np.zeros(count + 1, dtype=np.int32)
    np.cumsum(np.bincount(triangles, minlength=count), out=starts[1:])
    found = Evidence(products=np.zeros((count, 6, 6)), pulls=np.zeros((count, 6)))
    gather: Any = pixel_kernels.gather
    if len(blocks):
        gather(
            starts,
            blocks.astype(np.int32),
            np.ascontiguousarray(slopes.faces, dtype=np.int32),
            slopes.light,
            np.ascontiguousarray(slopes.corner_weights),
            np.stack([slopes.grey, residual, weight]),
            found.products,
            found.pulls,
        )
    return found


def gathered_plainly(slopes: Slopes, residual: np.ndarray, weight: np.ndarray) -> Evidence:
    """The twin of `gathered`: block by block."""
    count = len(slopes.faces)
    products, pulls = np.zeros((count, 6, 6)), np.zeros((count, 6))
    for block in np.flatnonzero(slopes.triangles >= 0):
        face = slopes.triangles[block]
        light = slopes.light[slopes.faces[face]] * slopes.corner_weights[block][:, None, None]
        jacobian = (light * slopes.grey[block][:, None]).transpose(1, 0, 2).reshape(3, 6)
        weighted = weight[block][:, None] * jacobian
        products[face] += jacobian.T @ weighted
        pulls[face] += weighted.T @ residual[block]
    return Evidence(products=products, pulls=pulls)


def jacobian(slopes: Slopes):
    """Grey levels of blocks and colours by all tilts, sparse (3 P, 2 n); 0 of unknown blocks."""
    from scipy.sparse import csr_matrix

    known = (slopes.triangles >= 0)[:, None, None, None]
    corners = slopes.faces[np.maximum(slopes.triangles, 0)]
    values = slopes.light[corners].transpose(0, 2, 1, 3) * slopes.grey[:, :, None, None]
    values = np.where(known, values * slopes.corner_weights[:, None, :, None], 0.0)
    columns = np.repeat((2 * corners[:, :, None] + np.arange(2))[:, None], 3, axis=1)
    starts = np.arange(0, values.size + 1, 6)
    shape = (3 * len(corners), 2 * len(slopes.light))
    return csr_matrix((values.ravel(), columns.ravel(), starts), shape)


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
