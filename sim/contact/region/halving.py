"""Cells of the lattice halved where the contact is small: places, children, and what fills them.

Level 0 is the lattice of the material points: cell k is centred at k edges. A halved cell gives
way to its eight children, which are cells of the next level; cell j of level 1 and finer is centred
at j + 1/2 of its own edges. The children of cell k are 2 k - 1 and 2 k on each axis, and from level
1 on 2 j and 2 j + 1. What a child holds is what its eighth of the parent held; where the outer skin
passes through, the skin itself says it, piece by piece as a plane.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from geometry.surface.surface import closest_point
from sim.contact.grid.lattice_keys import cells_of, keys_of, look_up
from workbench.core.result.results import Skin

BITS = np.stack(np.meshgrid(*[[0, 1]] * 3, indexing="ij"), axis=-1).reshape(8, 3)
"""Children of a cell, and points of a cell, in their order, shape (8, 3)."""
SAMPLES = 6
"""Samples per axis of a piece that the skin passes through."""

Halved = Sequence[np.ndarray]
"""Cells of each level that are halved, shape (Z, 3) each; none of them need hold material."""


class Spot(NamedTuple):
    """Where places lie in the cells, Q of them."""

    level: np.ndarray
    """Shape (Q,)."""
    cell: np.ndarray
    """Shape (Q, 3)."""
    local: np.ndarray
    """From the cell's centre, in its edges, shape (Q, 3)."""


def centres_mm(cells: np.ndarray, level: int, grid_mm: float) -> np.ndarray:
    """Centres of cells of a level [mm], shape (C, 3)."""
    return (cells + (0.5 if level else 0.0)) * (grid_mm * 0.5**level)


def all_centres_mm(levels: Sequence[np.ndarray], grid_mm: float) -> np.ndarray:
    """Centres of the cells of all levels [mm], one level after the other, shape (C, 3)."""
    return np.concatenate([centres_mm(cells, n, grid_mm) for n, cells in enumerate(levels)])


def first_child(cells: np.ndarray, level: int) -> np.ndarray:
    """The lowest child of cells of a level, on each axis."""
    return 2 * cells if level else 2 * cells - 1


def parents(cells: np.ndarray, level: int) -> np.ndarray:
    """The cells of the level before that cells of a level are children of."""
    return cells // 2 if level > 1 else (cells + 1) // 2


def among(cells: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """Which cells, (..., 3), are among the chosen ones, (Z, 3); shape (...), bool."""
    return np.isin(keys_of(cells), keys_of(chosen))


def locate(place: np.ndarray, halved: Halved) -> Spot:
    """The finest cell around each place (Q, 3), counted in edges of level 0."""
    cell = np.round(place).astype(np.int64)
    level, local = np.zeros(len(place), np.int64), place - cell
    for number, chosen in enumerate(halved):
        inner = np.flatnonzero((level == number) & among(cell, chosen))
        bits = (local[inner] >= 0.0).astype(np.int64)
        cell[inner] = first_child(cell[inner], number) + bits
        local[inner] = 2.0 * local[inner] - (bits - 0.5)
        level[inner] = number + 1
    return Spot(level, cell, local)


def split(
    cells: np.ndarray,
    fractions: np.ndarray,
    touched: Sequence[np.ndarray],
    *,
    halved: Halved,
    grid_mm: float,
    outer: Skin,
) -> tuple[list[np.ndarray], np.ndarray]:
    """Cells of each level in order, and how much all of them hold, shape (C, 8).

    Args:
        cells: Cells of level 0 that hold material, shape (M, 3).
        fractions: How much their points hold, shape (M, 8).
        touched: Cells of each level that are needed even if they hold nothing, shape (T, 3) each.
        halved: Cells of each level that give way to the next.
        grid_mm: Edge of a cell of level 0.
        outer: The skin that may pass through cells that are halved.
    """
    found, filled = [], []
    for level, needed in enumerate(touched):
        finer = np.zeros((0, 3), np.int64), np.zeros((0, 8))
        if level < len(halved):
            gone = among(cells, halved[level])
            edge_mm = grid_mm * 0.5**level
            finer = children_of(
                cells[gone], fractions[gone], level=level, edge_mm=edge_mm, outer=outer
            )
            cells, fractions = cells[~gone], fractions[~gone]
        bare = np.unique(keys_of(needed))
        bare = cells_of(bare[~np.isin(bare, keys_of(cells))])
        everything = np.concatenate([cells, bare])
        order = np.argsort(keys_of(everything), kind="stable")
        found.append(everything[order])
        filled.append(np.concatenate([fractions, np.zeros((len(bare), 8))])[order])
        cells, fractions = finer
    return found, np.concatenate(filled)


def owners_at(levels: Sequence[np.ndarray], spot: Spot) -> tuple[np.ndarray, np.ndarray]:
    """Number of the cell at each place, (Q,), and whether there is one, (Q,), bool."""
    owner, inside = np.zeros(len(spot.level), np.int64), np.zeros(len(spot.level), bool)
    first = 0
    for level, cells in enumerate(levels):
        own = np.flatnonzero(spot.level == level)
        if len(cells) and len(own):
            place, there = look_up(keys_of(cells), keys_of(spot.cell[own]))
            owner[own], inside[own] = first + place, there
        first += len(cells)
    return owner, inside


def children_of(
    cells: np.ndarray, fractions: np.ndarray, *, level: int, edge_mm: float, outer: Skin
) -> tuple[np.ndarray, np.ndarray]:
    """Children of cells that hold any material, and how much, shapes (K, 3) and (K, 8).

    Args:
        cells: Cells of a level, shape (Z, 3).
        fractions: How much their points hold, shape (Z, 8).
        level: Their level.
        edge_mm: Their edge.
        outer: The skin that may pass through them.
    """
    children = (first_child(cells, level)[:, None] + BITS).reshape(-1, 3)
    held = np.repeat(fractions.reshape(-1, 1), 8, axis=1)
    cut = np.flatnonzero((held[:, 0] > 0.0) & (held[:, 0] < 1.0))
    if len(cut):
        held[cut] = _filled(children[cut], held[cut], edge_mm=0.5 * edge_mm, outer=outer)
    some = held.any(axis=1)
    return children[some], held[some]


def _faces_about(skin: Skin, places_mm: np.ndarray, *, margin_mm: float) -> np.ndarray:
    """Faces whose boxes meet the box around places, shape (F, 3): the skin may be large."""
    low = places_mm.min(axis=0) - margin_mm
    high = places_mm.max(axis=0) + margin_mm
    corners = skin.points_mm[skin.faces]
    meets = (corners.max(axis=1) > low) & (corners.min(axis=1) < high)
    return skin.faces[meets.all(axis=1)]


def _filled(children: np.ndarray, held: np.ndarray, *, edge_mm: float, outer: Skin) -> np.ndarray:
    """Shares of the eighths of children, (K, 8), that lie below the outer skin.

    Where the skin passes none of them by, something else cut their parent: they keep its share.
    """
    centres = (children[:, None] + 0.5 + 0.5 * (BITS - 0.5)) * edge_mm
    faces = _faces_about(outer, centres.reshape(-1, 3), margin_mm=edge_mm)
    if not len(faces):
        return held
    foot, distance, face = closest_point(outer.points_mm, faces, centres.reshape(-1, 3))
    corners = outer.points_mm[faces[face]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    height = np.einsum("qc,qc->q", centres.reshape(-1, 3) - foot, normal)
    line = (np.arange(SAMPLES) + 0.5) / SAMPLES - 0.5
    grid = np.stack(np.meshgrid(*[line] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    below = (height[:, None] + normal @ (0.5 * edge_mm * grid).T < 0.0).mean(axis=1)
    near = (distance.reshape(-1, 8) < 0.5 * edge_mm * 3.0**0.5).any(axis=1)
    return np.where(near[:, None], below.reshape(-1, 8), held)
