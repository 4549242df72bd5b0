"""Signed distance of rigid shapes in closed form, and their dimensions, in plain NumPy.

Body frame as in `workbench.core.press.press`: origin at the shape's centre, +Z away from the skin.
A cylinder is as long as it is wide. The cone has a right apex angle: its base diameter is
`size_mm` and its sharp height half of that, apex toward -Z. Edges, rim and apex are rounded by
`edge_radius_mm`: a smaller sharp shape, offset outwards.

`evaluate` is the twin of `shape_distance_functions.signed_distance`.
"""

from __future__ import annotations

import numpy as np

from sim.contact.grid.stencil import line_slopes, line_weights
from workbench.core.objects.kind import Shape
from workbench.core.press.indenter import Indenter

ROOT_HALF = 0.5**0.5
TINY_MM = 1e-9
SEAT = 7
"""Of `size` in the kernels: height of the place [mm] that they count from, of analytic shapes."""


def analytic_size(indenter: Indenter) -> np.ndarray:
    """The `size` numbers of an analytic shape [mm], shape (8,), float64; zeros of a sampled one.

    Raises:
        DesignError: If a body is too small for its edge radius.
    """
    numbers = indenter.record.numbers
    if numbers is None:
        return np.zeros(8)
    return numbers(indenter.size_mm, indenter.edge_radius_mm)


def evaluate(
    position: np.ndarray,
    shape: Shape,
    size: np.ndarray,
    samples: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Signed distances [mm] and gradients at positions in the body frame.

    Args:
        position: Positions [mm], shape (N, 3).
        shape: Which shape.
        size: Its numbers: `analytic_size`, or origin and 1 / spacing of a grid.
        samples: B-spline coefficients of a grid, shape (A, B, C).

    Returns:
        Distances, shape (N,), and gradients, shape (N, 3).
    """
    if shape is Shape.SPHERE:
        radius = np.linalg.norm(position, axis=1)
        return radius - size[0], position / np.maximum(radius, TINY_MM)[:, None]
    if shape is Shape.CUBE:
        return _box(position, size)
    if shape is Shape.GRID:
        assert samples is not None
        return _sampled(position, size, samples)
    return _revolved(position, shape, size)


def _revolved(
    position: np.ndarray, shape: Shape, size: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    axes = [2, 0, 1] if shape is Shape.CYLINDER_Y else [0, 1, 2]
    first, second, axial = position[:, axes].T
    rho = np.hypot(first, second)
    profile = _cone_profile if shape is Shape.CONE else _box_profile
    distance, by_rho, by_z = profile(rho, axial, size)
    scale = by_rho / np.maximum(rho, TINY_MM)
    gradient = np.empty_like(position)
    gradient[:, axes] = np.stack([first * scale, second * scale, by_z], axis=1)
    return distance - size[2], gradient


def _box_profile(
    rho: np.ndarray, z: np.ndarray, size: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    over_rho, over_z = rho - size[0], np.abs(z) - size[1]
    up = np.where(z < 0, -1.0, 1.0)
    corner = (over_rho > 0) & (over_z > 0)
    length = np.maximum(np.hypot(over_rho, over_z), TINY_MM)
    radial = over_rho > over_z
    distance = np.where(corner, length, np.maximum(over_rho, over_z))
    by_rho = np.where(corner, over_rho / length, np.where(radial, 1.0, 0.0))
    by_z = up * np.where(corner, over_z / length, np.where(radial, 0.0, 1.0))
    return distance, by_rho, by_z


def _cone_profile(
    rho: np.ndarray, z: np.ndarray, size: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rim, top, apex = size[0], size[1], size[3]
    slant, over = ROOT_HALF * (rho - (z - apex)), z - top
    along = np.clip(0.5 * (rho + z - apex), 0.0, rim)
    side = np.stack([rho - along, z - apex - along])
    cap = np.stack([np.maximum(rho - rim, 0.0), over])
    nearest = np.where(np.linalg.norm(side, axis=0) < np.linalg.norm(cap, axis=0), side, cap)
    length = np.linalg.norm(nearest, axis=0)
    inside = (slant <= 0) & (over <= 0)
    face = inside | (length <= TINY_MM)
    capped = inside & (over > slant)
    distance = np.where(face, np.where(capped, over, slant), length)
    by_rho = np.where(
        face, np.where(capped, 0.0, ROOT_HALF), nearest[0] / np.maximum(length, TINY_MM)
    )
    by_z = np.where(
        face, np.where(capped, 1.0, -ROOT_HALF), nearest[1] / np.maximum(length, TINY_MM)
    )
    return distance, by_rho, by_z


def _box(position: np.ndarray, size: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    over = np.abs(position) - size[0]
    outside = np.maximum(over, 0.0)
    length = np.linalg.norm(outside, axis=1)
    side = np.where(position < 0, -1.0, 1.0)
    within = length <= TINY_MM
    face = np.eye(3)[np.argmax(over, axis=1)]
    distance = np.where(within, over.max(axis=1), length)
    corner = outside / np.maximum(length, TINY_MM)[:, None]
    return distance - size[2], side * np.where(within[:, None], face, corner)


def _sampled(
    position: np.ndarray, size: np.ndarray, samples: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    raw = (position - size[:3]) * size[3]
    inside = np.clip(raw, 1.5, np.array(samples.shape) - 2.5)
    nearest = np.floor(inside + 0.5)
    weights, slopes = line_weights(inside - nearest), line_slopes(inside - nearest)
    index = nearest.astype(int)[:, :, None] + np.arange(-1, 2)
    block = samples[
        index[:, 0, :, None, None], index[:, 1, None, :, None], index[:, 2, None, None, :]
    ]
    # One axis after the other, each by its weights and by its slopes: a third of the products of
    # contracting all three for the distance and for every slope anew.
    along_z, steep_z = (_contract(block, lines[:, 2]) for lines in (weights, slopes))
    along_y, steep_y = (_contract(along_z, lines[:, 1]) for lines in (weights, slopes))
    distance = _contract(along_y, weights[:, 0])
    gradient = size[3] * np.stack(
        [
            _contract(along_y, slopes[:, 0]),
            _contract(steep_y, weights[:, 0]),
            _contract(_contract(steep_z, weights[:, 1]), weights[:, 0]),
        ],
        axis=1,
    )
    far = np.linalg.norm(raw - inside, axis=1) / size[3]
    return np.where(far > 1e-4, np.maximum(far, distance - far), distance), gradient


def _contract(block: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Sum over the last axis of a block (n, ..., 3) with weights (n, 3)."""
    parts = line.reshape(len(line), *[1] * (block.ndim - 2), 3)
    return (
        block[..., 0] * parts[..., 0]
        + block[..., 1] * parts[..., 1]
        + block[..., 2] * parts[..., 2]
    )
