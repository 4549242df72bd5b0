"""The 27 nodes of a hexahedron in eight pieces.

Where they lie, between which corners, and whether a neighbour has them too.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sim.fem.elements import CORNERS

SIDES = np.array(
    [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
)
"""Corners of the six faces of a hexahedron, counter-clockwise from outside."""
EDGES = np.array(
    [
        *((0, 1), (1, 2), (2, 3), (3, 0)),
        *((4, 5), (5, 6), (6, 7), (7, 4)),
        *((0, 4), (1, 5), (2, 6), (3, 7)),
    ]
)
"""Ends of its twelve edges, in the order of the nodes 9 to 20 of decks."""

PLACES = np.array([(x, y, z) for z in (-1, 0, 1) for y in (-1, 0, 1) for x in (-1, 0, 1)])
"""The 27 nodes of a cell in eight pieces."""


def between_corners(place: np.ndarray) -> np.ndarray:
    """Corners of the cell that a place lies in the middle of; of a face one after the other."""
    found = np.flatnonzero(((place == 0) | (place == CORNERS)).all(axis=1))
    if len(found) == 4:
        return next(side for side in SIDES if set(side) == set(found))
    return found


CORNER_SPOTS = np.array([int(np.flatnonzero((PLACES == c).all(axis=1))[0]) for c in CORNERS])
"""Which of the `PLACES` are the corners."""
CHILD_SPOTS = np.array(
    [
        [
            int(np.flatnonzero((PLACES == (CORNERS[child] + corner) / 2).all(axis=1))[0])
            for corner in CORNERS
        ]
        for child in range(8)
    ]
)
"""Among the `PLACES` of a cell, the corners of each of its pieces."""
MEANS = np.zeros((8, 8, 8))
"""Weights of a cell's corners in each corner (second) of each of its pieces (first)."""
for _child, _corner in np.ndindex(8, 8):
    _members = between_corners((CORNERS[_child] + CORNERS[_corner]) / 2)
    MEANS[_child, _corner, _members] = 1.0 / len(_members)
_BETWEEN = [between_corners(place) for place in PLACES]
MIDDLES = tuple(
    (spots, np.array([_BETWEEN[n] for n in spots]))
    for spots in ([n for n, of in enumerate(_BETWEEN) if len(of) == size] for size in (2, 4, 8))
)
"""Which `PLACES` lie in the middle of edges, of faces, of the cell, and between which corners."""


def middle_nodes(lattice: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Nodes of edges, faces and cells, (Q,), and the corners they lie between, (Q, 2, 4 or 8)."""
    corners = lattice[:, CORNER_SPOTS]
    for spots, between in MIDDLES:
        yield lattice[:, spots].ravel(), corners[:, between].reshape(-1, between.shape[1])


def new_lattice(
    corners: np.ndarray, first: int
) -> tuple[np.ndarray, list[tuple[np.ndarray, np.ndarray]]]:
    """Numbers of the 27 nodes of each divided cell, (D, 27), and what the new ones lie between."""
    lattice = np.zeros((len(corners), len(PLACES)), dtype=np.int64)
    lattice[:, CORNER_SPOTS] = corners
    newly = []
    for spots, groups in middle_nodes(np.arange(lattice.size).reshape(lattice.shape)):
        between = lattice.ravel()[groups]
        keys = np.sort(between, axis=1)
        _, row, number = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        lattice.ravel()[spots] = first + number.ravel()
        newly.append((first + np.arange(len(row)), between[row]))
        first += len(row)
    return lattice, newly


def belong_to(groups: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Which of the edges (Q, 2) or faces (Q, 4) belong to one of some cells (M, 8); (Q,), bool."""
    size = groups.shape[1]
    if size == 8 or not len(corners):
        return np.zeros(len(groups), dtype=bool)
    near = corners[np.isin(corners, groups).sum(axis=1) >= size]
    theirs = near[:, EDGES if size == 2 else SIDES].reshape(-1, size)
    both = np.concatenate([np.sort(theirs, axis=1), np.sort(groups, axis=1)])
    _, number = np.unique(both, axis=0, return_inverse=True)
    number = number.ravel()
    return np.isin(number[len(theirs) :], number[: len(theirs)])
