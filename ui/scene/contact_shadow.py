"""The shadow that a body throws where it stands: a soft dark rim around its foot.

viser's own shadows on the floor are those of its lamps, and there are none in a fast scene. This
one is a mesh that fades to nothing, made anew only when the foot has another outline.
"""

from __future__ import annotations

import contextlib
from typing import Any

import numpy as np

from workbench.view.glb import Topology, write_glb

REACH_MM = 7.0
"""How far from the foot the shadow ends."""
STEPS = ((-1.0, 0.55), (0.0, 0.5), (0.15, 0.32), (0.4, 0.14), (0.7, 0.04), (1.0, 0.0))
"""How far out, over the reach, the shadow is how dark."""
SOLES_MM = (0.05, 1.0, np.inf)
"""What is this near to the lowest point stands on the floor; of a body that stands on a point or an
edge, the next that has an outline."""


class ContactShadow:
    """Node of the shadow of one body."""

    def __init__(self, api: Any) -> None:
        self.api = api
        self.node: Any = None
        self._outline = np.zeros((0, 2))
        self._series = 0

    def follow(self, points_mm: np.ndarray, height_mm: float) -> None:
        """Throw the shadow of a foot, vertices (N, 3), on a floor at a height."""
        outline = sole_outline(points_mm)
        if not len(outline):
            return
        if self.node is not None and np.array_equal(outline, self._outline):
            self.node.position = (0.0, 0.0, height_mm)
            return
        before, self._series, self._outline = self.node, 1 - self._series, outline
        points, darkness, faces = rim(outline)
        colours = np.zeros((len(points), 4), np.uint8)
        colours[:, 3] = np.rint(255 * darkness)
        topology = Topology.of(faces, len(points))
        glb = write_glb(points, colours, topology, both_sides=False)
        self.node = self.api.add_glb(
            f"/contact_shadow/{self._series}",
            glb,
            position=(0.0, 0.0, height_mm),
            cast_shadow=False,
            receive_shadow=False,
        )
        if before is not None:
            before.remove()

    def show(self, visible: bool) -> None:
        """Show or hide it with the body."""
        if self.node is not None:
            self.node.visible = visible


def sole_outline(points_mm: np.ndarray) -> np.ndarray:
    """Convex outline of the lowest vertices, counter-clockwise, shape (K, 2) [mm]."""
    from scipy.spatial import ConvexHull, QhullError

    points = np.asarray(points_mm, dtype=float)
    height_mm = points[:, 2] - points[:, 2].min()
    for sole_mm in SOLES_MM:
        sole = points[height_mm < sole_mm, :2]
        with contextlib.suppress(QhullError, ValueError):
            return sole[ConvexHull(sole).vertices]
    return np.zeros((0, 2))


def rim(outline_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The shadow of an outline (K, 2): vertices (N, 3) [mm], darkness (N,) in [0, 1], faces (M, 3).

    Every corner moves out along the bisector of its edges, which on the outline of a foot, without
    sharp corners, is nearly a parallel curve.
    """
    count = len(outline_mm)
    edge = np.roll(outline_mm, -1, axis=0) - outline_mm
    outward = np.stack([edge[:, 1], -edge[:, 0]], axis=1)
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    corner = outward + np.roll(outward, 1, axis=0)
    corner /= np.linalg.norm(corner, axis=1, keepdims=True)
    rings = [outline_mm + REACH_MM * share * corner for share, _ in STEPS[1:]]
    # Below the foot nobody looks: its middle is one corner.
    flat = np.vstack([outline_mm.mean(axis=0, keepdims=True), *rings])
    dark = np.r_[STEPS[0][1], np.repeat([dark for _, dark in STEPS[1:]], count)]
    at = np.arange(count)
    after = (at + 1) % count
    faces = [np.stack([np.zeros(count, int), 1 + at, 1 + after], axis=1)]
    for k in range(len(rings) - 1):
        low, high = 1 + k * count, 1 + (k + 1) * count
        faces.append(np.stack([low + at, high + at, high + after], axis=1))
        faces.append(np.stack([low + at, high + after, low + after], axis=1))
    points = np.column_stack([flat, np.zeros(len(flat))])
    return points.astype(np.float32), dark, np.concatenate(faces)
