"""The part's elements as other programs number them: faces, mid-edge nodes, node lines.

Sources: CalculiX CrunchiX 2.20 User's Manual and the Abaqus Elements Guide, which agree for C3D8,
C3D8I, C3D20R and C3D6. Mid-edge nodes stand on straight edges: all programs then have one body.
"""

from __future__ import annotations

import enum
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from sim.fem.pieces import EDGES

FACE_CORNERS = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 4, 5), (1, 2, 5, 6), (2, 3, 6, 7), (0, 3, 4, 7))
"""Corners of the faces S1 to S6 of a hexahedron, as sets."""
MOST_ON_LINE = 16
"""Entries that a line of a deck may have."""


class Element(enum.StrEnum):
    """Hexahedra of a deck."""

    C3D8 = "C3D8"
    """Eight nodes, full integration: too stiff where the elastomer is nearly incompressible."""
    C3D8I = "C3D8I"
    """Eight nodes with incompatible modes: like ours in small presses. In deep ones on fine meshes
    CalculiX gives up: at 0.9 mm under a ball of 6 mm, elements of 0.45 mm."""
    C3D20R = "C3D20R"
    """Twenty nodes, reduced integration: at 0.9 mm as good as ours at 0.45 mm."""


@dataclass(frozen=True, kw_only=True, slots=True)
class DeckMesh:
    """Nodes and elements of the part; the first nodes are its own, in its order."""

    points_mm: np.ndarray
    """Nodes at rest, shape (N', 3)."""
    cells: np.ndarray
    """Node numbers from 0, shape (M, 8) or (M, 20)."""
    ends: np.ndarray
    """The two own nodes between which each further node stands, shape (N' - N, 2)."""

    def at_all(self, values: np.ndarray) -> np.ndarray:
        """Values of own nodes (N, C) with the means of both ends at the others, (N', C)."""
        return np.concatenate([values, values[self.ends].mean(axis=1)])

    def gathered(self, forces: np.ndarray) -> np.ndarray:
        """Forces of all nodes (N', 3) on own nodes (N, 3), half of a further node's on each end."""
        count = len(forces) - len(self.ends)
        found = np.array(forces[:count])
        for end in self.ends.T:
            np.add.at(found, end, 0.5 * forces[count:])
        return found

    def members(self, chosen: np.ndarray) -> np.ndarray:
        """Own nodes that are chosen (N,), and further nodes both of whose ends are, (N',)."""
        return np.concatenate([chosen, chosen[self.ends].all(axis=1)])


def deck_mesh(points_mm: np.ndarray, cells: np.ndarray, element: Element) -> DeckMesh:
    """The part's nodes (N, 3) and hexahedra (M, 8), with mid-edge nodes where the kind has them."""
    if element is not Element.C3D20R:
        return DeckMesh(points_mm=points_mm, cells=cells, ends=np.zeros((0, 2), dtype=np.int64))
    edges = np.sort(cells[:, EDGES], axis=2)
    ends, place = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
    further = len(points_mm) + place.reshape(len(cells), len(EDGES))
    return DeckMesh(
        points_mm=np.concatenate([points_mm, points_mm[ends].mean(axis=1)]),
        cells=np.hstack([cells, further]),
        ends=ends,
    )


def face_numbers(cells: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Element, from 0, and face S1 to S6, as 1 to 6, of outer faces (Q, 4) of hexahedra."""
    corners = np.sort(cells[:, np.array(FACE_CORNERS)], axis=2).reshape(-1, 4)
    place = {tuple(row): number for number, row in enumerate(corners.tolist())}
    found = np.array([place[tuple(row)] for row in np.sort(faces, axis=1).tolist()], dtype=np.int64)
    return found // 6, found % 6 + 1


def node_lines(points_mm: np.ndarray, first: int) -> list[str]:
    """Lines of nodes (N, 3), counted from `first`."""
    return [
        f"{first + row}, {x:.10g}, {y:.10g}, {z:.10g}"
        for row, (x, y, z) in enumerate(points_mm.tolist())
    ]


def element_lines(cells: np.ndarray, rows: Iterable[int], *, first: int, shift: int) -> list[str]:
    """Lines of elements, some of the rows of (M, C), counted from `first`; nodes from `shift`."""
    lines = []
    for row in rows:
        numbers = [first + row, *(cells[row] + shift).tolist()]
        words = [str(number) for number in numbers]
        # A line that goes on ends with a comma.
        lines.append(", ".join(words[:MOST_ON_LINE]) + ("," if len(words) > MOST_ON_LINE else ""))
        if len(words) > MOST_ON_LINE:
            lines.append(", ".join(words[MOST_ON_LINE:]))
    return lines
