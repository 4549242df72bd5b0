"""What the frames of one design are composed over: the background, and the ink on the skin.

Composition, as in the paper: image = background + (foreground deformed - foreground undeformed).
For the physical models both foregrounds are absolute and the background is the undeformed one. The
paper's fields are shown over a background lit by straight lines. A photograph may take the place of
the rendered background; its own markers are then part of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.optics.raster.markers import Dots
from sim.optics.raster.skin_view import SkinView
from workbench.core.result.results import Skin


@dataclass(frozen=True, kw_only=True, slots=True)
class Backdrop:
    """N pixels, V vertices, F faces in the order of the tree, M dots."""

    undeformed: np.ndarray
    """Foreground radiance of the undeformed vertices, shape (V, 3), float32."""
    background: np.ndarray
    """Linear background with its ink, shape (N, 3), float32."""
    remainder: np.ndarray
    """What a deformed foreground is added to, shape (N, 3), float32."""
    inked_background: int
    """Whether ink dims the remainder too; not that of a photograph."""
    background_rgb: np.ndarray
    """The background in grey levels, shape (N, 3), uint8."""
    exposure: np.ndarray
    """Display light per radiance of each colour, shape (3,), float32."""
    lens_share: np.ndarray
    """Share of its light that the lens keeps at each pixel, shape (N,), float32."""
    curve: np.ndarray
    """Grey levels of the image sensor at even steps of display light, uint8."""
    ink: np.ndarray
    """Covered share of each pixel of the background, shape (N,), float32."""
    marker: np.ndarray
    """Nearest dot of each pixel, shape (N,), int32."""
    ink_gain: float
    """Radiance of ink over that of the bare skin [1]."""
    dot_radius_mm: float
    dots_mm: np.ndarray
    """Reference places of the dots [mm], shape (M, 3), float32."""
    dot_start: np.ndarray
    """Where each face's dots begin in `dot_of`, shape (F + 1,), int32."""
    dot_of: np.ndarray
    """The dots that can be nearest to a point of the face, int32."""
    camera_mm: np.ndarray
    """Optical centre [mm], shape (3,), float32."""
    axis: np.ndarray
    """Unit optical axis, shape (3,), float32."""
    focal_px: float
    angular: int
    """Whether a pixel of the lens spans an angle rather than a length at a depth."""


def at_pixels(view: SkinView, values: np.ndarray) -> np.ndarray:
    """Vertex values (V, C) at what each pixel sees of the undeformed skin, dimmed by the walls.

    Shape (N, C), float32; 0 where a pixel sees none.
    """
    seen = np.flatnonzero(np.diff(view.layer_start) > 0)
    layer = view.layer_start[seen]
    corners = view.faces[view.layer_face[layer]]
    shown = np.einsum("pk,pkc->pc", view.layer_weights[layer], values[corners])
    found = np.zeros((len(view.direction), values.shape[1]), dtype=np.float32)
    found[seen] = shown * view.transmittance[seen, None]
    return found


def dots_of_faces(dots: Dots, skin: Skin, view: SkinView) -> tuple[np.ndarray, np.ndarray]:
    """For each face of the view the dots that can be nearest to its points: starts and numbers.

    A dot farther from the middle than the nearest one plus the face's size is never nearest.
    """
    count = len(view.faces)
    if not len(dots.centres_mm):
        return np.zeros(count + 1, dtype=np.int32), np.zeros(0, dtype=np.int32)
    from scipy.spatial import KDTree

    inked = np.flatnonzero(dots.inked[view.face_number])
    corners = skin.points_mm[view.faces[inked]]
    middle = corners.mean(axis=1)
    size = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
    tree = KDTree(dots.centres_mm)
    reach = tree.query(middle)[0] + 2.0 * size
    lists = tree.query_ball_point(middle, reach, return_sorted=True)
    counts = np.zeros(count, dtype=np.int64)
    counts[inked] = [len(found) for found in lists]
    start = np.append(0, np.cumsum(counts)).astype(np.int32)
    numbers = [number for found in lists for number in found]
    return start, np.array(numbers, dtype=np.int32)
