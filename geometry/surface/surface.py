"""Queries on triangle meshes given as points (N, 3) and faces (M, 3), in plain numpy.

Normals, closedness, volume, nearest point, and (from their own files) rays and sections.
"""

from __future__ import annotations

import numpy as np

from geometry.surface.rays import RayCaster
from geometry.surface.section import Clip, Plane, half_space_clip, section_outline
from workbench.core.base.check import expect

__all__ = [
    "Clip",
    "Plane",
    "RayCaster",
    "closest_on_triangles",
    "closest_point",
    "face_areas",
    "face_normals",
    "half_space_clip",
    "is_watertight",
    "mesh_volume",
    "on_plane",
    "open_edges",
    "section_outline",
    "vertex_areas_mm2",
    "vertex_normals",
]

FLAT_MM = 1e-6
"""How near to z = 0 a vertex lies on the plane on which bodies stand [mm]."""
CANDIDATE_CHUNK = 1_000_000
"""Point-triangle pairs tested at a time: 200 MB of temporaries."""


def vertex_normals(points_mm: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Unit normals, each face weighted by its angle at the vertex, shape (N, 3).

    Angle weights make the normal independent of how a flat or ruled patch is split.
    Source: Thuermer and Wuethrich, Computing vertex normals from polygonal facets, 1998.
    A vertex without faces gets 0.
    """
    corners = np.asarray(points_mm, dtype=np.float64)[faces]
    edges = np.roll(corners, -1, axis=1) - corners
    normal = np.cross(edges[:, 0], edges[:, 1])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    unit = edges / np.maximum(np.linalg.norm(edges, axis=2, keepdims=True), 1e-300)
    cosine = -np.einsum("fij,fij->fi", unit, np.roll(unit, 1, axis=1))
    angle = np.arccos(np.clip(cosine, -1.0, 1.0))
    weighted = (angle[:, :, None] * normal[:, None, :]).reshape(-1, 3)
    flat = np.asarray(faces).ravel()
    count = len(points_mm)
    total = np.column_stack([np.bincount(flat, weighted[:, k], count) for k in range(3)])
    return total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-300)


def on_plane(points_mm: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Which triangles lie on z = 0, on which bodies stand, shape (M,), bool."""
    return np.abs(points_mm[faces][:, :, 2]).max(axis=1) < FLAT_MM


def face_areas(points_mm: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Area of each triangle [mm2], shape (M,)."""
    corners = np.asarray(points_mm, dtype=np.float64)[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return 0.5 * np.linalg.norm(cross, axis=1)


def vertex_areas_mm2(points_mm: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """A third of the triangles around each vertex [mm2], shape (V,)."""
    thirds = np.repeat(face_areas(points_mm, faces) / 3.0, 3)
    return np.bincount(np.asarray(faces).ravel(), thirds, len(points_mm))


def face_normals(points_mm: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Unit normal of each triangle, shape (M, 3); of one without an area, what rounding makes."""
    corners = np.asarray(points_mm, dtype=np.float64)[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)


def mesh_volume(points_mm: np.ndarray, faces: np.ndarray) -> float:
    """Volume inside a closed mesh [mm3], negative when it is inside out: sum of a.(b x c) / 6."""
    points = np.asarray(points_mm, dtype=np.float64)
    corners = (points - points.mean(axis=0))[faces]
    triple = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    return float(triple.sum() / 6.0)


def open_edges(faces: np.ndarray) -> int:
    """Directed edges without exactly one partner in the opposite direction; 0 when closed."""
    ends = np.asarray(faces, dtype=np.int64)
    if not len(ends):
        return 0
    start, stop = ends.ravel(), np.roll(ends, -1, axis=1).ravel()
    span = int(ends.max()) + 1
    forward, forward_count = np.unique(start * span + stop, return_counts=True)
    backward, backward_count = np.unique(stop * span + start, return_counts=True)
    if np.array_equal(forward, backward) and np.array_equal(forward_count, backward_count):
        return int(forward_count[forward_count > 1].sum())
    unmatched = np.setxor1d(forward, backward)
    return max(1, len(unmatched) // 2)


def is_watertight(faces: np.ndarray) -> bool:
    """Whether every edge joins two faces of opposite direction: closed, oriented, manifold."""
    return len(faces) > 0 and open_edges(faces) == 0


def pieces(faces: np.ndarray) -> np.ndarray:
    """Number of the connected piece that each triangle belongs to, shape (M,), from 0."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    count = int(faces.max()) + 1
    ends = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    links = coo_matrix((np.ones(faces.size, dtype=np.int8), ends), (count, count))
    piece = connected_components(links, directed=False)[1]
    return np.unique(piece[faces[:, 0]], return_inverse=True)[1]


def closest_point(
    points_mm: np.ndarray, faces: np.ndarray, query_mm: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nearest point of the mesh to each query.

    Every face whose bounding sphere reaches nearer than a known point of the mesh is tested, so
    the answer is exact. Faces are searched in classes of similar size, so that a few long
    triangles do not widen the search for all.

    Returns:
        Point [mm], shape (Q, 3); distance [mm], shape (Q,); face, shape (Q,), int64.
    """
    from scipy.spatial import KDTree

    expect(query_mm, "Q 3", name="query")
    query = np.asarray(query_mm, dtype=np.float64)
    corners = np.asarray(points_mm, dtype=np.float64)[faces]
    centre = corners.mean(axis=1)
    radius = np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)
    nearest_face = KDTree(centre).query(query)[1]
    best_point = closest_on_triangles(query, corners[nearest_face])
    best_distance = np.linalg.norm(query - best_point, axis=1)
    best_face = np.asarray(nearest_face, dtype=np.int64)
    size_class = np.floor(np.log2(np.maximum(radius, 1e-9))).astype(int)
    for size in np.unique(size_class):
        members = np.flatnonzero(size_class == size)
        tree = KDTree(centre[members])
        reach = best_distance + radius[members].max()
        found = tree.query_ball_point(query, reach)
        owner = np.repeat(np.arange(len(query)), [len(item) for item in found])
        face = members[np.concatenate([np.asarray(item, dtype=np.int64) for item in found])]
        for begin in range(0, len(owner), CANDIDATE_CHUNK):
            part = slice(begin, begin + CANDIDATE_CHUNK)
            best = best_point, best_distance, best_face
            _keep_nearer(best, query, corners, owner[part], face[part])
    return best_point, best_distance, best_face


def _keep_nearer(
    best: tuple[np.ndarray, np.ndarray, np.ndarray],
    query: np.ndarray,
    corners: np.ndarray,
    owner: np.ndarray,
    face: np.ndarray,
) -> None:
    """Replace the best answers in place where a candidate is nearer."""
    best_point, best_distance, best_face = best
    point = closest_on_triangles(query[owner], corners[face])
    distance = np.linalg.norm(query[owner] - point, axis=1)
    order = np.lexsort((distance, owner))
    first = order[np.unique(owner[order], return_index=True)[1]]
    first = first[distance[first] < best_distance[owner[first]]]
    winner = owner[first]
    best_point[winner], best_distance[winner] = point[first], distance[first]
    best_face[winner] = face[first]


def closest_on_triangles(query: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Nearest point of triangle i to query i, shape (Q, 3).

    The foot of the perpendicular where it falls inside, else the nearest of the three edges.
    """
    first, second, third = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = np.cross(second - first, third - first)
    area_2 = np.maximum(np.einsum("ij,ij->i", normal, normal), 1e-300)
    height = np.einsum("ij,ij->i", query - first, normal) / area_2
    foot = query - height[:, None] * normal
    inside = np.ones(len(query), dtype=bool)
    best = np.zeros_like(query)
    best_distance = np.full(len(query), np.inf)
    for begin, end in ((first, second), (second, third), (third, first)):
        edge = end - begin
        inside &= np.einsum("ij,ij->i", np.cross(edge, foot - begin), normal) >= 0.0
        length_2 = np.maximum(np.einsum("ij,ij->i", edge, edge), 1e-300)
        along = np.clip(np.einsum("ij,ij->i", query - begin, edge) / length_2, 0.0, 1.0)
        point = begin + along[:, None] * edge
        distance = np.linalg.norm(query - point, axis=1)
        nearer = distance < best_distance
        best[nearer], best_distance[nearer] = point[nearer], distance[nearer]
    best[inside] = foot[inside]
    return best
