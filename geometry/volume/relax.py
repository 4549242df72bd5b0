"""The worst cells of two sheets made squarer by sliding their nodes along the faces of the wall.

Each corner of a cell between the sheets has the scaled Jacobian J = a . (b x c) of its unit edges
along the sheet (a, b) and through the wall (c). Where J is below a target T, nodes move down the
gradient of the sum of (T - J)^2, by steps whose size is normalised as in Adam (Kingma and Ba,
2015); each step is taken in the tangent plane and then brought back to the surface along the
normal. Where rays met the outer face at a slant, cells are long; there nodes are first spread
evenly, each toward the mean of its neighbours. Only bad cells and some around them move, so a
good grid costs nothing. The best state seen is kept.

Leaves out: nodes on the border, and making spacing more even.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from geometry.volume.curved import CurvedSurface
from geometry.volume.sheets import Sheets
from geometry.volume.skins import curved_region
from workbench.core.result.results import Label, LabelledSurface

ENOUGH = 0.4
"""Sheets whose worst corner is better are left as they are."""
TARGET = 0.6
STEPS = 60
STEP = 0.05
"""Length of a step over the cells' mean edge."""
AROUND = 3
"""Rows of cells around a bad one that move with it."""
LONG = 1.6
"""Edge over the mean edge that makes a cell too long."""
SHORT = 0.4
"""Edge over the mean edge below which it is pushed longer, or squaring would collapse it."""
SPREAD_AROUND, SPREAD_STEPS, SPREAD_SHARE = 6, 30, 0.6
MEMORY, SIZE_MEMORY = 0.8, 0.95
"""Decay per step of the mean gradient and of its mean square."""


def relaxed(sheets: Sheets, membrane: LabelledSurface) -> Sheets:
    """The sheets with their worst corners improved; the same ones where none is bad."""
    if _worst(sheets) >= ENOUGH:
        return sheets
    surfaces = curved_region(membrane, Label.INNER), curved_region(membrane, Label.OUTER)
    straight = _squared(sheets, surfaces)
    if _worst(straight) >= ENOUGH:
        return straight
    spread = _squared(_spread(sheets, surfaces[1]), surfaces)
    return max((sheets, straight, spread), key=_worst)


def _worst(sheets: Sheets) -> float:
    return float(_corners(sheets.inside, sheets.outside, sheets.quads)[0].min())


def _squared(sheets: Sheets, surfaces: tuple[CurvedSurface, CurvedSurface]) -> Sheets:
    """The sheets with their bad cells and those around made squarer."""
    worst = _corners(sheets.inside, sheets.outside, sheets.quads)[0]
    nodes, quads, moving = _patch(sheets, worst < TARGET, AROUND)
    start = sheets.inside[nodes], sheets.outside[nodes]
    inside, outside = sheets.inside.copy(), sheets.outside.copy()
    inside[nodes], outside[nodes] = _descend(start, surfaces, quads, moving)
    return dataclasses.replace(sheets, inside=inside, outside=outside)


def _spread(sheets: Sheets, surface: CurvedSurface) -> Sheets:
    """The sheets with outer nodes about long cells moved toward the mean of their neighbours."""
    corners = sheets.outside[sheets.quads]
    edges = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
    edge_mm = float(edges.mean())
    long = edges.max(axis=1) > LONG * edge_mm
    if not long.any():
        return sheets
    nodes, quads, moving = _patch(sheets, long, SPREAD_AROUND)
    points = sheets.outside[nodes]
    neighbours = np.stack([np.roll(quads, 1, axis=1), np.roll(quads, -1, axis=1)])
    degree = 2.0 * np.bincount(quads.ravel(), minlength=len(nodes))[:, None]
    for _ in range(SPREAD_STEPS):
        total = sum(_gathered(quads, points[beside], len(nodes)) for beside in neighbours)
        move = total / degree - points
        normal = _normals(points, quads)
        move -= np.einsum("ij,ij->i", move, normal)[:, None] * normal
        moved, near = surface.beside(points + SPREAD_SHARE * move, normal, edge_mm)
        slid = near & moving
        points[slid] = moved[slid]
    outside = sheets.outside.copy()
    outside[nodes] = points
    return dataclasses.replace(sheets, outside=outside)


def _patch(
    sheets: Sheets, chosen: np.ndarray, around: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Chosen cells (Q,) bool with rows around them, cut out of the sheets.

    Returns:
        Nodes of the patch, shape (P,); its cells in the patch's own numbers, shape (R, 4); which
        of its nodes may move, shape (P,), bool: not those on its edge, nor on the sheets' border.
    """
    moving = np.zeros(len(sheets.inside), dtype=bool)
    moving[sheets.quads[chosen]] = True
    for _ in range(around):
        moving[sheets.quads[moving[sheets.quads].any(axis=1)]] = True
    members = sheets.quads[moving[sheets.quads].any(axis=1)]
    moving[sheets.ring] = False
    nodes, quads = np.unique(members, return_inverse=True)
    return nodes, quads.reshape(-1, 4), moving[nodes]


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
        worst, *slopes = _corners(here[0], here[1], quads, edge_mm)
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


def _stretch(length_mm: np.ndarray, edge_mm: float) -> np.ndarray:
    """Minus the slope of (S - length / edge)^2 where an edge is shorter than S mean edges."""
    return 2.0 * np.maximum(SHORT - length_mm / edge_mm, 0.0) / edge_mm


def _corners(
    inside: np.ndarray, outside: np.ndarray, quads: np.ndarray, edge_mm: float = 1.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Worst J of each cell, and the gradient of the sum of (T - J)^2 on the inner and outer nodes.

    Edges shorter than `SHORT` mean edges `edge_mm` add a term that lengthens them.
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
        by_a = pull * (b_c - jacobian * a) / a_mm - _stretch(a_mm, edge_mm) * a
        by_b = pull * (np.cross(c, a) - jacobian * b) / b_mm - _stretch(b_mm, edge_mm) * b
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
