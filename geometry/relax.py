"""The worst cells of two sheets made squarer by sliding their nodes along the faces of the wall.

Each corner of a cell between the sheets has the scaled Jacobian J = a . (b x c) of its unit edges
along the sheet (a, b) and through the wall (c). Where J is below a target T, nodes move down the
gradient of the sum of (T - J)^2, by steps whose size is normalised as in Adam (Kingma and Ba,
2015); each step is taken in the tangent plane and then brought back to the surface along the
normal. Only the bad cells and a few around them move, so a good grid costs nothing. The best state
seen is kept.

Leaves out: nodes on the border, and making spacing more even.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from geometry.curved import CurvedSurface
from geometry.sheets import Sheets
from geometry.skins import curved_region
from workbench.core.results import Label, LabelledSurface

ENOUGH = 0.4
"""Sheets whose worst corner is better are left as they are."""
TARGET = 0.5
STEPS = 25
STEP = 0.05
"""Length of a step over the cells' mean edge."""
AROUND = 3
"""Rows of cells around a bad one that move with it."""
MEMORY, SIZE_MEMORY = 0.8, 0.95
"""Decay per step of the mean gradient and of its mean square."""


def relaxed(sheets: Sheets, membrane: LabelledSurface) -> Sheets:
    """The sheets with their worst corners improved; the same ones where none is bad."""
    worst = _corners(sheets.inside, sheets.outside, sheets.quads)[0]
    if worst.min() >= ENOUGH:
        return sheets
    moving = np.zeros(len(sheets.inside), dtype=bool)
    moving[sheets.quads[worst < TARGET]] = True
    for _ in range(AROUND):
        moving[sheets.quads[moving[sheets.quads].any(axis=1)]] = True
    nodes, quads = np.unique(sheets.quads[moving[sheets.quads].any(axis=1)], return_inverse=True)
    moving[sheets.ring] = False
    surfaces = curved_region(membrane, Label.INNER), curved_region(membrane, Label.OUTER)
    start = sheets.inside[nodes], sheets.outside[nodes]
    found = _descend(start, surfaces, quads.reshape(-1, 4), moving[nodes])
    inside, outside = sheets.inside.copy(), sheets.outside.copy()
    inside[nodes], outside[nodes] = found
    return dataclasses.replace(sheets, inside=inside, outside=outside)


def _descend(
    start: tuple[np.ndarray, np.ndarray],
    surfaces: tuple[CurvedSurface, CurvedSurface],
    quads: np.ndarray,
    moving: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """The best positions of both sheets along the descent, each (N, 3) [mm]."""
    here = [part.copy() for part in start]
    edges = here[1][quads] - here[1][np.roll(quads, -1, axis=1)]
    edge_mm = float(np.linalg.norm(edges, axis=2).mean())
    mean = [np.zeros_like(part) for part in here]
    square = [np.zeros(len(part)) for part in here]
    best, best_quality = start, -np.inf
    for step in range(1, STEPS + 1):
        worst, *slopes = _corners(here[0], here[1], quads)
        if worst.min() > best_quality:
            best, best_quality = (here[0].copy(), here[1].copy()), worst.min()
        if best_quality >= ENOUGH:
            break
        for side, slope in enumerate(slopes):
            normal = _normals(here[side], quads)
            slope -= np.einsum("ij,ij->i", slope, normal)[:, None] * normal
            mean[side] += (1.0 - MEMORY) * (slope - mean[side])
            square[side] += (1.0 - SIZE_MEMORY) * ((slope**2).sum(axis=1) - square[side])
            size = np.sqrt(square[side] / (1.0 - SIZE_MEMORY**step)) + 1e-3
            move = -STEP * edge_mm * mean[side] / (1.0 - MEMORY**step) / size[:, None]
            moved, near = surfaces[side].beside(here[side] + move, normal, edge_mm)
            slid = near & moving
            here[side][slid] = moved[slid]
    return best


def _corners(
    inside: np.ndarray, outside: np.ndarray, quads: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Worst J of each cell, and the gradient of the sum of (T - J)^2 on the inner and outer nodes.

    dJ/da = (b x c - J a) / |a| for the unit vector a of an edge of length |a|, and so on in turn.
    """
    after, before = np.roll(quads, -1, axis=1), np.roll(quads, 1, axis=1)
    worst = np.ones(len(quads))
    slopes = np.zeros_like(inside), np.zeros_like(outside)
    c, c_mm = _unit(outside[quads] - inside[quads])
    for sheet, slope in zip((inside, outside), slopes, strict=True):
        a, a_mm = _unit(sheet[after] - sheet[quads])
        b, b_mm = _unit(sheet[before] - sheet[quads])
        b_c = np.cross(b, c)
        jacobian = np.einsum("qki,qki->qk", a, b_c)[..., None]
        worst = np.minimum(worst, jacobian[..., 0].min(axis=1))
        pull = -2.0 * np.maximum(TARGET - jacobian, 0.0)
        by_a = pull * (b_c - jacobian * a) / a_mm
        by_b = pull * (np.cross(c, a) - jacobian * b) / b_mm
        by_c = pull * (np.cross(a, b) - jacobian * c) / c_mm
        for nodes, share in ((after, by_a), (before, by_b), (quads, -by_a - by_b)):
            slope += _gathered(nodes, share, len(sheet))
        through = _gathered(quads, by_c, len(sheet))
        slopes[1][:] += through
        slopes[0][:] -= through
    return worst, *slopes


def _normals(points_mm: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Unit normals of the nodes of a sheet, each cell weighted by its area."""
    corner = points_mm[quads]
    across = np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])
    each = np.broadcast_to(across[:, None, :], corner.shape)
    return _unit(_gathered(quads, each, len(points_mm)))[0]


def _gathered(nodes: np.ndarray, share: np.ndarray, count: int) -> np.ndarray:
    """Sum of vectors (Q, 4, 3) over the nodes (Q, 4) they belong to, shape (count, 3)."""
    flat = nodes.ravel()
    return np.column_stack([np.bincount(flat, share[..., k].ravel(), count) for k in range(3)])


def _unit(vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    length = np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12)
    return vectors / length, length
