"""Exact skins in numpy, without a CAD kernel: what contact and optics are validated on."""

from __future__ import annotations

import numpy as np

from workbench.core.result.results import MembraneMesh, Skin


def finger_skin(radius_mm: float, cylinder_mm: float, edge_mm: float) -> Skin:
    """Open-based cylinder with a hemispherical tip, exact normals, edges about `edge_mm`."""
    around = max(12, round(2 * np.pi * radius_mm / edge_mm))
    straight = max(1, round(cylinder_mm / edge_mm))
    curved = max(3, round(np.pi / 2 * radius_mm / edge_mm))
    elevation = np.concatenate([np.zeros(straight), np.linspace(0, np.pi / 2, curved + 1)[:-1]])
    height = np.concatenate(
        [np.linspace(0, cylinder_mm, straight + 1)[:-1], np.full(curved, cylinder_mm)]
    )
    azimuth = np.arange(around) * (2 * np.pi / around)
    normals = np.stack(
        [
            np.cos(elevation)[:, None] * np.cos(azimuth),
            np.cos(elevation)[:, None] * np.sin(azimuth),
            np.broadcast_to(np.sin(elevation)[:, None], (len(elevation), around)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    normals = np.vstack([normals, [0.0, 0.0, 1.0]])
    lift = np.append(np.repeat(height, around), cylinder_mm)
    points = radius_mm * normals + lift[:, None] * np.array([0.0, 0.0, 1.0])
    return Skin(points_mm=points, faces=_revolved_faces(len(elevation), around), normals=normals)


def _revolved_faces(rings: int, around: int) -> np.ndarray:
    start = np.arange(rings - 1)[:, None] * around
    here, after = np.arange(around), (np.arange(around) + 1) % around
    lower = np.stack([start + here, start + after, start + around + after], axis=-1)
    upper = np.stack([start + here, start + around + after, start + around + here], axis=-1)
    last = (rings - 1) * around
    tip = np.stack([last + here, last + after, np.full(around, rings * around)], axis=-1)
    return np.concatenate([lower.reshape(-1, 3), upper.reshape(-1, 3), tip]).astype(np.int32)


def skins_only(*, outer: Skin, inner: Skin, cavity: Skin) -> MembraneMesh:
    """A membrane without hexahedra: neither light nor material points look at them."""
    return MembraneMesh(hexes=None, outer=outer, inner=inner, cavity=cavity)
