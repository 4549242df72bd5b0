"""Where a press wants finer cells, and where their new nodes go."""

from __future__ import annotations

from typing import Any

import numpy as np

from geometry.surface.surface import face_normals
from sim.contact.motion.approach import Approach
from sim.contact.region.refinement import path_samples
from sim.fem.division import Wanted
from sim.fem.obstacle import RigidPose, curvature, distance
from workbench.core.result.results import Skin

SMOOTH = 0.9
"""Cosine of the angle between the normals at both ends below which an edge stays straight."""
SHARE = 0.28
"""Longest edge of a cell under a contact, over the radius that contact has."""
SHALLOWEST_MM = 0.2
"""Overlap from which on contacts are to be met so finely."""
REACH = (3.0, 2.0)
"""Distance from the object within which whole cells, and pieces, are halved, in edges."""
LOOK_EVERY_MM = 0.1 * (1.0 + 1e-3)
"""Way of the object between two looks: increments of 0.1 mm, known to rounding."""
MOST_LOOKS = 1000
"""Looks of one frame, which no frame reaches."""
FLAT_PER_MM = 1e-2
"""Least curvature of an object [1/mm]: a plane's contact is as wide as it is."""
PIECES = 8
MOST_ADDED = 8_000
"""Cells that one round of halvings may add: wide contacts of sharp objects stay coarser."""
WHOLE = 1.0 - 1e-9
"""Weight of smooth vertices of the skin in a node that lies on it."""


def finer_under(approach: Approach, skin_mm: np.ndarray, coarse_mm: float) -> Wanted:
    """Cells that the object comes near and that are large beside its contact.

    A ball of radius rho pressed in by d touches a circle of radius sqrt(rho d): cells should be no
    longer than `SHARE` of that, with the object's own curvature at each place and the overlap d of
    each pose along the path. The skin gives way by half of the overlap at the rim of a contact, so
    the object is looked at half as deep.

    Args:
        approach: The object and its path.
        skin_mm: The undeformed skin, shape (V, 3).
        coarse_mm: Edge of a cell that was not halved.
    """
    poses = []
    # First touch presses nothing, and how a path is cut into frames must not count.
    for progress in path_samples(approach, every_mm=LOOK_EVERY_MM, most=MOST_LOOKS)[1:]:
        origin, rotation = approach.pose(float(progress))
        overlap_mm = -float(approach.collider.distance((skin_mm - origin) @ rotation)[0].min())
        raised = origin + 0.5 * max(overlap_mm, 0.0) * approach.normal
        poses.append(
            (max(overlap_mm, SHALLOWEST_MM), RigidPose(origin_mm=raised, rotation=rotation))
        )

    def wanted(level: int, middles_mm: np.ndarray) -> np.ndarray:
        edge_mm = coarse_mm / 2.0**level
        found = np.zeros(len(middles_mm), dtype=bool)
        for overlap_mm, pose in poses:
            rows = np.flatnonzero(~found)
            gap_mm, _ = distance(approach.collider, pose, middles_mm[rows])
            rows = rows[gap_mm < REACH[min(level, 1)] * edge_mm]
            if level > 0:
                bent = np.abs(curvature(approach.collider, pose, middles_mm[rows]))
                per_mm = np.maximum(bent.max(axis=(1, 2), initial=0.0), FLAT_PER_MM)
                rows = rows[edge_mm > SHARE * np.sqrt(overlap_mm / per_mm)]
            found[rows] = True
        return found if PIECES * found.sum() <= MOST_ADDED else np.zeros_like(found)

    return wanted


class SmoothSkin:
    """New nodes on the skin that the old ones were put on, instead of on its facets.

    Edges are cubics whose ends lie in the tangent planes there; the middle of a face is that of the
    Coons patch of its edges. An edge that meets a crease of the skin, or leaves it, stays straight.
    """

    def __init__(self, skin: Skin, vertices: np.ndarray) -> None:
        """Take the normals of nodes.

        Args:
            skin: The outer skin.
            vertices: Its vertex at each node, -1 for none, shape (N,).
        """
        flat = face_normals(skin.points_mm, skin.faces)
        along = np.einsum("fi,fci->fc", flat, skin.normals[skin.faces])
        sharp = np.zeros(len(skin.points_mm), dtype=bool)
        sharp[skin.faces[along < SMOOTH]] = True
        self._smooth = vertices >= 0
        self._smooth[self._smooth] = ~sharp[vertices[self._smooth]]
        self._normals = np.zeros((len(vertices), 3))
        self._normals[self._smooth] = skin.normals[vertices[self._smooth]]

    def middles(self, corners: np.ndarray, points_mm: np.ndarray, shares: Any) -> np.ndarray:
        """Middles (Q, 3), as `division.Placed` asks for them."""
        smooth = shares @ self._smooth.astype(np.float64) > WHOLE
        normals = shares @ self._normals
        normals[~smooth] = 0.0
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        places_mm = points_mm[corners]
        bulges_mm = np.zeros((len(corners), 3))
        for first in range(corners.shape[1] if corners.shape[1] > 2 else 1):
            ends = corners[:, [first, (first + 1) % corners.shape[1]]]
            bulges_mm += _bulge_mm(points_mm[ends], normals[ends], smooth[ends].all(axis=1))
        # Of a Coons patch: half of the edges' middles less a quarter of the corners.
        return places_mm.mean(axis=1) + (bulges_mm if corners.shape[1] == 2 else 0.5 * bulges_mm)


def _bulge_mm(ends_mm: np.ndarray, normals: np.ndarray, smooth: np.ndarray) -> np.ndarray:
    """How far the middles of edges (Q, 2, 3) lie from their chords, shape (Q, 3)."""
    chord = ends_mm[:, 1] - ends_mm[:, 0]
    rise = np.einsum("qi,qei->qe", chord, normals)
    found = (rise[:, 1:] * normals[:, 1] - rise[:, :1] * normals[:, 0]) / 8.0
    found[~smooth] = 0.0
    return found
