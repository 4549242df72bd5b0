"""Cuts of closed surfaces by a plane square to an axis: what is left, its outline, its filled cap.

Each triangle is kept, dropped or clipped at the plane, which takes milliseconds in NumPy. The edges
that cross the plane name the corners of the outline, so that its loops close exactly, whatever the
rounding; the loops, holes among them, are triangulated as polygons by manifold3d. Cutting a body
takes tens of milliseconds this way where a boolean of the whole body takes hundreds. An outline
that does not close, of a surface that is not closed, gets no cap.

A pressed membrane is cut as the body at rest whose vertices follow the skins of the press.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

import numpy as np

from workbench.core.result.results import Label, LabelledSurface, MembraneMesh
from workbench.core.result.sensing import Contact

TOUCHING_MM = 1e-7
"""Vertices nearer to the plane than this are taken as kept: none lies on it [mm]."""
NEIGHBOURS = 3
"""Vertices of a pressed skin that a vertex of the body follows."""


class Axis(enum.StrEnum):
    """The axis that the plane is square to."""

    X = "X"
    Y = "Y"
    Z = "Z"

    @property
    def number(self) -> int:
        """0, 1 or 2."""
        return "XYZ".index(self.value)


@dataclass(frozen=True, kw_only=True, slots=True)
class Plane:
    """A cut: what lies above it along the axis goes, or below it where it is flipped."""

    axis: Axis = Axis.Y
    position_mm: float = 0.0
    flip: bool = False

    def depth_mm(self, points_mm: np.ndarray) -> np.ndarray:
        """How deep points (N, 3) lie in what is kept [mm], never zero, shape (N,)."""
        along = np.asarray(points_mm, dtype=np.float64)[:, self.axis.number] - self.position_mm
        depth = along if self.flip else -along
        return np.where(np.abs(depth) < TOUCHING_MM, TOUCHING_MM, depth)

    def moved(self, offset_mm: np.ndarray) -> Plane:
        """The same plane as seen by a part that stands `offset_mm` from its place."""
        there = self.position_mm - float(offset_mm[self.axis.number])
        return Plane(axis=self.axis, position_mm=there, flip=self.flip)


@dataclass(frozen=True, kw_only=True, slots=True)
class Clipped:
    """The kept side of a surface of N vertices; the C corners on the plane follow the vertices."""

    points_mm: np.ndarray
    """Vertices [mm], the N given ones and the corners, shape (N + C, 3)."""
    faces: np.ndarray
    """Triangles, shape (M, 3)."""
    source: np.ndarray
    """Triangle of the whole surface that each is a part of, shape (M,)."""
    ends: np.ndarray
    """Vertices of the edge that each corner lies on, shape (C, 2)."""
    share: np.ndarray
    """How far along its edge each corner lies [1], shape (C,)."""
    segments: np.ndarray
    """Pairs of corners that bound the cut, in the sense of the triangles, shape (S, 2)."""

    def carry(self, values: np.ndarray) -> np.ndarray:
        """Vertex values (N, ...) of the whole surface at all vertices, shape (N + C, ...)."""
        given = np.asarray(values)
        share = self.share.reshape(-1, *(1,) * (given.ndim - 1))
        between = (1.0 - share) * given[self.ends[:, 0]] + share * given[self.ends[:, 1]]
        return np.concatenate([given, between.astype(given.dtype)])

    @property
    def outline_mm(self) -> np.ndarray:
        """The outline of the cut as segments [mm], shape (S, 2, 3)."""
        return self.points_mm[self.segments]


@dataclass(frozen=True, kw_only=True, slots=True)
class Cap:
    """A filled cut."""

    points_mm: np.ndarray
    """Corners [mm], shape (P, 3)."""
    faces: np.ndarray
    """Triangles, shape (Q, 3); none where the outline does not close."""
    area_mm2: float


def clip(points_mm: np.ndarray, faces: np.ndarray, plane: Plane) -> Clipped:
    """Keep one side of a surface with vertices (N, 3) [mm] and triangles (M, 3)."""
    points, faces = np.asarray(points_mm, dtype=np.float64), np.asarray(faces)
    depth = plane.depth_mm(points)
    inside = depth > 0.0
    count = inside[faces].sum(axis=1)
    whole = np.flatnonzero(count == 3)
    crossing = np.flatnonzero((count == 1) | (count == 2))
    # Each crossing triangle is turned until the corner that is alone on its side comes first.
    alone = inside[faces[crossing]] == (count[crossing] == 1)[:, None]
    turn = (alone.argmax(axis=1)[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(faces[crossing], turn, axis=1).T
    edges = np.sort(np.concatenate([np.stack([a, b], 1), np.stack([a, c], 1)]), axis=1)
    keys = edges[:, 0].astype(np.int64) * len(points) + edges[:, 1]
    _, first, corner = np.unique(keys, return_index=True, return_inverse=True)
    ends = edges[first].reshape(-1, 2)
    d0, d1 = depth[ends[:, 0]], depth[ends[:, 1]]
    share = d0 / (d0 - d1)
    on_plane = points[ends[:, 0]] + share[:, None] * (points[ends[:, 1]] - points[ends[:, 0]])
    ab, ac = (corner.reshape(2, -1) + len(points)) if len(crossing) else np.zeros((2, 0), int)
    tip = count[crossing] == 1
    kept_faces = [
        faces[whole],
        np.stack([a, ab, ac], axis=1)[tip],
        np.stack([ab, b, c], axis=1)[~tip],
        np.stack([ab, c, ac], axis=1)[~tip],
    ]
    return Clipped(
        points_mm=np.concatenate([points, on_plane]),
        faces=np.concatenate(kept_faces),
        source=np.concatenate([whole, crossing[tip], crossing[~tip], crossing[~tip]]),
        ends=ends,
        share=share,
        segments=np.where(tip[:, None], np.stack([ab, ac], 1), np.stack([ac, ab], 1)),
    )


def packed(points_mm: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Used vertices (U, 3) [mm], triangles that name them, and their old numbers (U,)."""
    used = np.zeros(len(points_mm), dtype=bool)
    used[faces] = True
    number = np.cumsum(used) - 1
    return np.asarray(points_mm)[used], number[faces], np.flatnonzero(used)


def cap(clipped: Clipped, plane: Plane) -> Cap:
    """The filled cut of a closed surface."""
    loops = [clipped.points_mm[loop] for loop in closed_loops(clipped.segments)]
    nothing = Cap(points_mm=np.zeros((0, 3)), faces=np.zeros((0, 3), np.int64), area_mm2=0.0)
    if not loops:
        return nothing
    import manifold3d

    u, v = (plane.axis.number + 1) % 3, (plane.axis.number + 2) % 3
    flat = [np.ascontiguousarray(loop[:, [u, v]]) for loop in loops]
    area_mm2 = sum(_area_mm2(loop) for loop in flat)
    if area_mm2 < 0.0:
        # Seen from the other side; outlines of holes turn with those around them.
        flat, loops = [loop[::-1].copy() for loop in flat], [loop[::-1] for loop in loops]
    faces = np.asarray(manifold3d.triangulate(flat), dtype=np.int64).reshape(-1, 3)
    return Cap(points_mm=np.concatenate(loops), faces=faces, area_mm2=abs(area_mm2))


def closed_loops(segments: np.ndarray) -> list[np.ndarray]:
    """Segments (S, 2) of corners chained into closed loops of corners; open chains are left out.

    Bodies that touch along an edge share a corner: a way that comes back to a corner it has passed
    is cut off there as a loop of its own.
    """
    after: dict[int, list[int]] = {}
    for start, stop in segments.tolist():
        after.setdefault(start, []).append(stop)
    loops = []
    while after:
        way = [next(iter(after))]
        passed = {way[0]: 0}
        while way[-1] in after:
            corner = after[way[-1]].pop()
            if not after[way[-1]]:
                del after[way[-1]]
            if corner not in passed:
                passed[corner] = len(way)
                way.append(corner)
                continue
            first = passed[corner]
            if len(way) - first > 2:
                loops.append(np.array(way[first:]))
            for left in way[first + 1 :]:
                del passed[left]
            del way[first + 1 :]
    return loops


def _area_mm2(loop: np.ndarray) -> float:
    """Signed area [mm2] of a polygon (P, 2), positive counter-clockwise."""
    x, y = (loop - loop[0]).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


class PressedBody:
    """A membrane whose vertices follow the skins of a press, found by their nearest neighbours."""

    def __init__(self, membrane: LabelledSurface, mesh: MembraneMesh) -> None:
        self.membrane = membrane
        outer = np.unique(membrane.faces[membrane.has(Label.OUTER)])
        fixed = np.unique(membrane.faces[membrane.has(Label.BASE)])
        inner = np.setdiff1d(np.arange(len(membrane.points_mm)), np.union1d(outer, fixed))
        self._outer = outer, *_followed(membrane.points_mm[outer], mesh.outer.points_mm)
        self._inner = inner, *_followed(membrane.points_mm[inner], mesh.inner.points_mm)

    def points_mm(self, contact: Contact, frame: int) -> np.ndarray:
        """Vertices of the membrane in frame `frame`, counted from 0 [mm], shape (N, 3)."""
        points = np.array(self.membrane.points_mm, dtype=np.float64)
        moved = [(self._outer, contact.displacement_mm[frame])]
        if contact.inner_mm.shape[1]:
            moved.append((self._inner, contact.inner_mm[frame]))
        for (vertices, near, weight), way_mm in moved:
            points[vertices] += np.einsum("nk,nkd->nd", weight, np.asarray(way_mm)[near])
        return points


def _followed(points_mm: np.ndarray, skin_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The nearest vertices of a skin and their weights by inverse distance, each (N, 3)."""
    from scipy.spatial import KDTree

    if not len(points_mm):
        return np.zeros((0, NEIGHBOURS), np.int64), np.zeros((0, NEIGHBOURS))
    distance_mm, near = KDTree(skin_mm).query(points_mm, k=NEIGHBOURS)
    weight = 1.0 / np.maximum(distance_mm, 1e-6)
    return np.asarray(near), weight / weight.sum(axis=1, keepdims=True)
