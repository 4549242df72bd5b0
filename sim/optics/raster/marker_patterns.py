"""Where the markers of a pattern lie on the skin.

`grid` and `rings` start at the tip, the highest place. A grid is flat in the plane that touches the
tip and is wrapped along the shortest ways from there (the logarithmic map): along each of them
lengths are kept. Circles of the skin far from the tip are shorter than in that plane, so columns
draw together there; a dot nearer than `LEAST_SHARE` of the spacing to one nearer to the tip is left
out. `rings` keeps the spacing along the skin and along each circle everywhere. A `picture` lies
level above the tip, its middle over it, right along +X and up along +Y; each dark blob becomes a
dot where its centroid, straight down, meets the skin, so dots on steep skin lie further apart.
Source: Sharp, Soliman, Crane, "The Vector Heat Method", ACM TOG 38 (2019), in potpourri3d.
"""

from __future__ import annotations

import numpy as np

from sim.optics.light.geodesic import SkinWays, submesh
from sim.optics.light.section_curve import level_curves
from sim.optics.raster.photo_file import read_rgb
from workbench.core.base.errors import DesignError
from workbench.core.design.optics import MarkerPattern, Markers
from workbench.core.design.photo import Photo
from workbench.core.result.results import Skin

ON_EDGE = 1e-9
"""A dot on the edge of two triangles belongs to both, whichever way rounding goes; what is found
twice is then told apart by distance."""
LEAST_SHARE = 0.7
"""Of the spacing between two dots of a grid [1]."""
LEVEL_MM = 1e-3
"""Vertices this near to the highest are one flat tip [mm]."""
DARK = 0.5
"""Display value below which a picture is dark [1]."""
FEWEST_DARK_PX = 4
"""Pixels of the smallest blob that is no speck [1]."""
MOST_BLOBS = 5000
"""More are noise, not a pattern [1]."""


def pattern_places(skin: Skin, markers: Markers) -> np.ndarray:
    """Dot centres on the skin [mm], shape (M, 3), of the patterns but `even`.

    Raises:
        DesignError: If the picture is missing or has no dark blob that meets the skin, or the
            skin is too poor for the pattern.
    """
    if markers.pattern is MarkerPattern.GRID:
        return grid_places(skin, markers.spacing_mm)
    if markers.pattern is MarkerPattern.RINGS:
        return ring_places(skin, markers.spacing_mm)
    if markers.picture is None:
        raise DesignError(
            "the markers follow a picture, but there is none",
            hint="give a picture of dark dots, or choose pattern = 'even'",
            at="optics.markers.picture",
        )
    return picture_places(skin, markers.picture, markers.picture_mm)


def tip_vertex(skin: Skin) -> int:
    """The highest vertex; on a level top the one in its middle."""
    top = np.flatnonzero(skin.points_mm[:, 2] > skin.points_mm[:, 2].max() - LEVEL_MM)
    middle = skin.points_mm[top].mean(axis=0)
    return int(top[np.argmin(np.linalg.norm(skin.points_mm[top] - middle, axis=1))])


def grid_places(skin: Skin, spacing_mm: float) -> np.ndarray:
    """Rows along X and columns along Y about the tip, shape (M, 3) [mm], from the tip outward."""
    flat, points, faces = _unrolled(skin)
    corners = flat[faces] / spacing_mm
    found: list[np.ndarray] = []
    nodes: list[tuple[int, int]] = []
    low, high = np.ceil(corners.min(axis=1)), np.floor(corners.max(axis=1))
    for face in np.flatnonzero((low <= high).all(axis=1)):
        a, b, c = corners[face]
        edges = np.column_stack([b - a, c - a])
        # Triangles that the map turns over or crushes lie where ways from both sides meet.
        if np.linalg.det(edges) <= 0.0:
            continue
        for column in range(int(low[face, 0]), int(high[face, 0]) + 1):
            for row in range(int(low[face, 1]), int(high[face, 1]) + 1):
                second, third = np.linalg.solve(edges, np.array([column, row]) - a)
                if min(second, third, 1.0 - second - third) >= -ON_EDGE:
                    weights = np.array([1.0 - second - third, second, third])
                    found.append(weights @ points[faces[face]])
                    nodes.append((column, row))
    order = sorted(range(len(nodes)), key=lambda k: (np.hypot(*nodes[k]), nodes[k]))
    return _apart(np.array([found[k] for k in order]), LEAST_SHARE * spacing_mm)


def ring_places(skin: Skin, spacing_mm: float) -> np.ndarray:
    """The tip, and dots on the circles about it, shape (M, 3) [mm]."""
    tip = tip_vertex(skin)
    distance = SkinWays(skin).distance_mm(tip)
    farthest = float(distance[np.isfinite(distance)].max())
    found = [skin.points_mm[tip][None]]
    for number in range(1, int(farthest / spacing_mm) + 1):
        for curve in level_curves(skin, distance, number * spacing_mm):
            found.append(_along(curve, skin.points_mm[tip], spacing_mm))
    return np.concatenate(found)


def picture_places(skin: Skin, picture: Photo, width_mm: float) -> np.ndarray:
    """Where the centroids of a picture's dark blobs meet the skin from above, shape (M, 3) [mm].

    Raises:
        DesignError: If there is no dark blob, too many, or none above the skin.
    """
    import cv2

    from geometry.surface.rays import RayCaster

    at = "optics.markers.picture"
    dark = (read_rgb(picture, at=at).mean(axis=2) < DARK).astype(np.uint8)
    _, _, stats, centroids = cv2.connectedComponentsWithStats(dark, connectivity=8)
    blobs = centroids[1:][stats[1:, cv2.CC_STAT_AREA] >= FEWEST_DARK_PX]
    if not 0 < len(blobs) <= MOST_BLOBS:
        raise DesignError(
            f"{picture.name} has {len(blobs)} dark blobs; a pattern has 1 to {MOST_BLOBS}",
            hint=f"draw black dots of {FEWEST_DARK_PX} pixels or more on white",
            at=at,
        )
    height, width = dark.shape
    tip = skin.points_mm[tip_vertex(skin)]
    scale = width_mm / width
    start = np.empty((len(blobs), 3))
    start[:, 0] = tip[0] + (blobs[:, 0] + 0.5 - width / 2.0) * scale
    start[:, 1] = tip[1] - (blobs[:, 1] + 0.5 - height / 2.0) * scale
    start[:, 2] = tip[2] + 1.0
    down = np.broadcast_to([0.0, 0.0, -1.0], start.shape)
    distance, face, _ = RayCaster(skin.points_mm, skin.faces).hits(start, down)
    met = face >= 0
    if not met.any():
        raise DesignError(
            f"none of the {len(blobs)} dark blobs of {picture.name} lies above the skin",
            hint=f"make picture_mm smaller than {width_mm:g} mm",
            at="optics.markers.picture_mm",
        )
    return start[met] + distance[met, None] * down[met]


def _unrolled(skin: Skin) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The tip's part of the skin in the plane that touches it: (N, 2) [mm], (N, 3), (F, 3)."""
    from potpourri3d import MeshVectorHeatSolver

    tip = tip_vertex(skin)
    vertices = np.flatnonzero(np.isfinite(SkinWays(skin).distance_mm(tip)))
    points, faces = submesh(skin, vertices)
    try:
        solver = MeshVectorHeatSolver(points, faces)
        row = int(np.searchsorted(vertices, tip))
        found = np.asarray(solver.compute_log_map(row))
        frame = np.array([axis[row] for axis in solver.get_tangent_frames()[:2]])
    except (RuntimeError, ValueError) as error:
        raise DesignError(
            f"a grid of markers cannot be laid on this skin: {error}",
            hint="choose pattern = 'even'",
            at="optics.markers.pattern",
        ) from error
    # From the solver's own axes at the tip to those nearest to the sensor's X and Y.
    return found @ frame[:, :2], points, faces


def _apart(points: np.ndarray, least_mm: float) -> np.ndarray:
    """Those points that are at least so far from all kept before them."""
    from scipy.spatial import KDTree

    if not len(points):
        return points.reshape(0, 3)
    tree, kept = KDTree(points), np.ones(len(points), dtype=bool)
    for number, point in enumerate(points):
        if kept[number]:
            near = np.array(tree.query_ball_point(point, least_mm))
            kept[near[near > number]] = False
    return points[kept]


def _along(curve: np.ndarray, tip: np.ndarray, spacing_mm: float) -> np.ndarray:
    """Dots evenly on a curve, a spacing apart to the nearest whole number of them, (N, 3)."""
    closed = np.array_equal(curve[0], curve[-1])
    if closed:
        side = curve[:-1] - tip
        first = int(np.argmin(np.abs(np.arctan2(side[:, 1], side[:, 0]))))
        curve = np.concatenate([curve[first:-1], curve[: first + 1]])
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))])
    count = max(1, round(length[-1] / spacing_mm))
    at = (np.arange(count) + (0.0 if closed else 0.5)) * length[-1] / count
    return np.column_stack([np.interp(at, length, curve[:, axis]) for axis in range(3)])
