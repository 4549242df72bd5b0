"""Can the cast come out, and is every wall thick enough: measures on triangle meshes."""

from __future__ import annotations

import numpy as np

from geometry.rays import RayCaster

STEP_DEG = 7.5
DRAFT_DEG = 0.5
"""A facet steeper than this against the pull counts as undercut."""
SAMPLES = 2000
START_MM = 1e-3
"""Depth below the surface at which a wall's ray starts [mm]."""
OPPOSED_COSINE = 0.7
"""A wall is between faces that look apart to within 45 degrees; a sharp edge is no wall."""


def best_split_deg(points_mm: np.ndarray, faces: np.ndarray) -> tuple[float, float]:
    """Azimuth of the pull direction [degree, 0 to 180) with the least undercut, and that share.

    Args:
        points_mm: Vertices of the outer face, shape (N, 3).
        faces: Triangles, shape (M, 3).

    Returns:
        Azimuth, and undercut area over the whole area.
    """
    corners = np.asarray(points_mm, dtype=np.float64)[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    double_area = np.linalg.norm(cross, axis=1)
    normal = cross / np.maximum(double_area, 1e-300)[:, None]
    middle = (points_mm.min(axis=0) + points_mm.max(axis=0))[:2] / 2
    place = corners.mean(axis=1)[:, :2] - middle
    azimuths = np.arange(0.0, 180.0, STEP_DEG)
    shares = []
    for azimuth in np.radians(azimuths):
        pull = np.array([np.cos(azimuth), np.sin(azimuth)])
        side = np.where(place @ pull >= 0.0, 1.0, -1.0)
        undercut = side * (normal[:, :2] @ pull) < -np.sin(np.radians(DRAFT_DEG))
        # A facet across the split plane belongs to both halves: its normal tells nothing.
        height = (corners[:, :, :2] - middle) @ pull
        whole = (height > 0.0).all(axis=1) | (height < 0.0).all(axis=1)
        shares.append(float(double_area[undercut & whole].sum() / double_area.sum()))
    # Rounded, so that the first of equally good azimuths wins over one better by noise.
    best = int(np.argmin(np.round(shares, 3)))
    return float(azimuths[best]), shares[best]


def thinnest_wall_mm(points_mm: np.ndarray, faces: np.ndarray) -> float:
    """Thinnest wall of a closed mesh [mm], by rays straight inward from its surface.

    Rays start at evenly spread places on the surface (a low-discrepancy sequence, so the answer
    is the same each time) and count where they end on a face that looks the other way.
    """
    corners = np.asarray(points_mm, dtype=np.float64)[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1)
    normal = cross / np.maximum(area, 1e-300)[:, None]
    cumulative = np.cumsum(area) / area.sum()
    face = np.searchsorted(cumulative, (np.arange(SAMPLES) + 0.5) / SAMPLES)
    # Additive recurrence of the plastic number. Source: Roberts, R2 sequence, 2018.
    spread = (0.5 + np.outer(np.arange(SAMPLES), [0.7548776662, 0.5698402910])) % 1.0
    folded = np.where(spread.sum(axis=1, keepdims=True) > 1.0, 1.0 - spread, spread)
    weights = np.column_stack([1.0 - folded.sum(axis=1), folded])
    inward = -normal[face]
    start = np.einsum("si,sij->sj", weights, corners[face]) + START_MM * inward
    distance, found, _ = RayCaster(points_mm, faces).hits(start, inward)
    opposed = np.einsum("ij,ij->i", normal[found], inward) > OPPOSED_COSINE
    walls = distance[(found >= 0) & opposed]
    return float(walls.min() + START_MM) if len(walls) else float("inf")
