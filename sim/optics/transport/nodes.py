"""Nodes on the skin at which traced light is gathered: a coarser triangulation of it.

Vertices are grouped into about as many even patches as nodes are wanted, by the shortest way along
the skin's edges (so walls that lie close in space but not along the skin never mix), and each
centre moves to the middle of its patch a few times (Lloyd). A face of the skin whose corners lie in
three patches joins their three centres: the coarse triangulation. A vertex then lies among the
triangles about its own patch's centre, in the one nearest to it.
Source: Valette and Chassery, Approximated centroidal Voronoi diagrams for uniform polygonal mesh
coarsening, 2004 (patches and their dual; here with distances along edges).

Leaves out: the strip outside the outermost centres, which takes the light of the nearest triangle.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from geometry.surface.surface import face_areas, vertex_areas_mm2
from workbench.core.result.results import Skin

ROUNDS = 5
"""Times that the centres move."""
LEAST_AREA = 0.01
"""Of the median area, below which what a node gathers says nothing of its light [1]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Nodes:
    """N nodes and how light is divided among them."""

    points_mm: np.ndarray
    """Places on the skin [mm], shape (N, 3), float64."""
    frame: np.ndarray
    """Rows t, b, n: n is the unit normal into the sensor, shape (N, 3, 3), float32."""
    faces: np.ndarray
    """Triangles between nodes, shape (T, 3), int32."""
    nodes: np.ndarray
    """Three nodes of each vertex of the skin, shape (V, 3), int32."""
    weights: np.ndarray
    """Their weights, which sum to 1, shape (V, 3), float32."""
    face_nodes: np.ndarray
    """Three nodes of each face of the skin, shape (F, 3), int32."""
    face_weights: np.ndarray
    """Weights of these nodes at each corner, shape (F, 3 corners, 3 nodes), float32; between the
    corners they are linear, and negative ones count as 0."""
    area_mm2: np.ndarray
    """Area whose light each node gathers [mm2], shape (N,), float64."""


def coarse_nodes(skin: Skin, count: int) -> Nodes:
    """About `count` nodes; the skin's own vertices where it has no more than that.

    Args:
        skin: The skin that light falls on.
        count: Nodes asked for.
    """
    vertices = len(skin.points_mm)
    if vertices <= count:
        centres, patch = np.arange(vertices), np.arange(vertices)
        faces = np.asarray(skin.faces, dtype=np.int32)
    else:
        centres, patch = _patches(skin, count)
        faces = _dual(patch[skin.faces])
    points = skin.points_mm[centres]
    fans = _fans(faces, len(centres))
    nodes, weights = _nearest_triangle(points, faces, fans[patch], patch, skin.points_mm)
    corners = skin.points_mm[skin.faces]
    middles = corners.mean(axis=1)
    own = patch[skin.faces[:, 0]]
    face_nodes, _ = _nearest_triangle(points, faces, fans[own], own, middles)
    face_weights = np.stack([_affine(points[face_nodes], corners[:, k]) for k in range(3)], axis=1)
    normals = -skin.normals[centres]
    return Nodes(
        points_mm=points,
        frame=_frames(normals).astype(np.float32),
        faces=faces,
        nodes=nodes.astype(np.int32),
        weights=weights.astype(np.float32),
        face_nodes=face_nodes.astype(np.int32),
        face_weights=face_weights.astype(np.float32),
        area_mm2=_areas(skin, face_nodes, face_weights, len(centres)),
    )


def neighbours(nodes: Nodes) -> Any:
    """Sparse matrix (N, N) that replaces a value at nodes by the mean of it and its neighbours'.

    Nodes with hardly any area, as at the rim of a sucker, count in no mean, their own included: a
    photon that grazes such a node would shine as bright as an LED.
    """
    from scipy.sparse import coo_matrix, diags, identity

    count = len(nodes.points_mm)
    ends = nodes.faces.ravel(), np.roll(nodes.faces, -1, axis=1).ravel()
    links = coo_matrix((np.ones(nodes.faces.size), ends), (count, count)).tocsr()
    links = ((links + links.T) > 0).astype(np.float64) + identity(count)
    gathers = nodes.area_mm2 > 0.0
    usual = np.median(nodes.area_mm2[gathers]) if gathers.any() else 0.0
    sound = gathers & (nodes.area_mm2 >= LEAST_AREA * usual)
    links = links @ diags(sound.astype(np.float64))
    return diags(1.0 / np.maximum(np.asarray(links.sum(axis=1)).ravel(), 1.0)) @ links


def _patches(skin: Skin, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertex at the centre of each patch, shape (N,), and the patch of each vertex, shape (V,)."""
    from scipy.sparse.csgraph import dijkstra

    graph = _edges(skin)
    share = vertex_areas_mm2(skin.points_mm, skin.faces)
    random = np.random.default_rng(0)
    # Drawn by area along a line through all vertices: even, whatever the density of the mesh.
    order = random.permutation(len(share))
    ticks = (np.arange(count) + 0.5) / count * share.sum()
    centres = np.unique(
        order[np.searchsorted(np.cumsum(share[order]), ticks).clip(max=len(share) - 1)]
    )
    for turn in range(ROUNDS + 1):
        centres = _reach_all(graph, centres)
        _, _, source = dijkstra(
            graph, directed=False, indices=centres, min_only=True, return_predecessors=True
        )
        patch = np.searchsorted(centres, source)
        if turn < ROUNDS:
            centres = _middles(skin.points_mm, share, patch, len(centres))
    return centres, patch


def _reach_all(graph: Any, centres: np.ndarray) -> np.ndarray:
    """The centres, and one more in each piece of the skin that holds none."""
    from scipy.sparse.csgraph import connected_components

    piece = connected_components(graph, directed=False)[1]
    empty = np.setdiff1d(piece, piece[centres])
    first = [int(np.argmax(piece == number)) for number in empty]
    return np.unique(np.concatenate([centres, np.array(first, dtype=centres.dtype)]))


def _middles(points: np.ndarray, share: np.ndarray, patch: np.ndarray, count: int) -> np.ndarray:
    """The vertex of each patch nearest to its centre of area, sorted."""
    total = np.maximum(np.bincount(patch, share, count), 1e-300)
    middle = np.column_stack(
        [np.bincount(patch, share * points[:, k], count) / total for k in range(3)]
    )
    distance = np.linalg.norm(points - middle[patch], axis=1)
    order = np.lexsort((distance, patch))
    return np.sort(order[np.unique(patch[order], return_index=True)[1]])


def _edges(skin: Skin) -> Any:
    from scipy.sparse import coo_matrix

    start, stop = skin.faces.ravel(), np.roll(skin.faces, -1, axis=1).ravel()
    length = np.linalg.norm(skin.points_mm[start] - skin.points_mm[stop], axis=1)
    count = len(skin.points_mm)
    both = np.concatenate([start, stop]), np.concatenate([stop, start])
    links: Any = coo_matrix((np.tile(np.maximum(length, 1e-9), 2), both), (count, count)).tocsr()
    # An edge of two faces was added twice over; its length is the mean of what was added.
    times: Any = coo_matrix((np.ones(2 * len(start)), both), (count, count)).tocsr()
    return links.multiply(times.power(-1.0)).tocsr()


def _dual(patches: np.ndarray) -> np.ndarray:
    """Triangles of patches that meet in a face, each once, in the face's sense, shape (T, 3)."""
    a, b, c = patches.T
    meeting = patches[(a != b) & (b != c) & (c != a)]
    turn = np.argmin(meeting, axis=1)
    turned = np.take_along_axis(meeting, (turn[:, None] + np.arange(3)) % 3, axis=1)
    return np.unique(turned, axis=0).astype(np.int32)


def _fans(faces: np.ndarray, count: int) -> np.ndarray:
    """Triangles about each node, shape (N, K), filled up by repeating; -1 where there is none."""
    owner = faces.ravel()
    order = np.argsort(owner, kind="stable")
    sizes = np.bincount(owner, minlength=count)
    starts = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    slot = np.arange(max(int(sizes.max(initial=1)), 1)) % np.maximum(sizes, 1)[:, None]
    found = order[np.minimum(starts[:, None] + slot, max(len(order) - 1, 0))] // 3
    return np.where(sizes[:, None] > 0, found, -1)


def _nearest_triangle(
    points: np.ndarray, faces: np.ndarray, fan: np.ndarray, own: np.ndarray, places: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of the nearest triangle of each place's fan and weights there, both (Q, 3)."""
    nodes = np.repeat(own[:, None], 3, axis=1)
    weights = np.tile([1.0, 0.0, 0.0], (len(places), 1))
    best = np.full(len(places), np.inf)
    for column in range(fan.shape[1]):
        with_face = np.flatnonzero(fan[:, column] >= 0)
        corners = faces[fan[with_face, column]]
        triangle = points[corners]
        share = np.maximum(_affine(triangle, places[with_face]), 0.0)
        share /= share.sum(axis=1, keepdims=True)
        gap = places[with_face] - np.einsum("qk,qkd->qd", share, triangle)
        distance = np.einsum("qd,qd->q", gap, gap)
        nearer = distance < best[with_face]
        chosen = with_face[nearer]
        best[chosen], nodes[chosen], weights[chosen] = (
            distance[nearer],
            corners[nearer],
            share[nearer],
        )
    return nodes, weights


def _affine(triangle: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Barycentric coordinates of the feet of places on their triangles' planes, shape (Q, 3)."""
    edge_1, edge_2 = triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]
    normal = np.cross(edge_1, edge_2)
    size = np.einsum("qd,qd->q", normal, normal)
    offset = places - triangle[:, 0]
    with np.errstate(invalid="ignore", divide="ignore"):
        second = np.einsum("qd,qd->q", np.cross(offset, edge_2), normal) / size
        third = np.einsum("qd,qd->q", np.cross(edge_1, offset), normal) / size
    flat = size <= 0.0
    second[flat], third[flat] = 0.0, 0.0
    return np.column_stack([1.0 - second - third, second, third])


def _frames(normals: np.ndarray) -> np.ndarray:
    """Rows t, b, n for unit normals n, shape (N, 3, 3). t follows no axis of the membrane."""
    helper = np.where(np.abs(normals[:, :1]) > 0.9, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]])
    first = np.cross(helper, normals)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(normals, first), normals], axis=1)


def _areas(skin: Skin, face_nodes: np.ndarray, face_weights: np.ndarray, count: int) -> np.ndarray:
    """Area that each node gathers from: the integral of its weight over the skin."""
    # Three points of Gauss integrate the linear weights; clipped ones nearly.
    places = np.array([[4.0, 1.0, 1.0], [1.0, 4.0, 1.0], [1.0, 1.0, 4.0]]) / 6.0
    area = face_areas(skin.points_mm, skin.faces) / 3.0
    total = np.zeros(count)
    for place in places:
        share = np.maximum(np.einsum("k,fkn->fn", place, face_weights), 0.0)
        share /= share.sum(axis=1, keepdims=True)
        total += np.bincount(face_nodes.ravel(), (area[:, None] * share).ravel(), count)
    return total
