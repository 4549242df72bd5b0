"""Bodies of revolution with known normals: what the optics are validated on.

A finger is a cylinder with a hemispherical tip; its three skins are concentric. The hexahedra are
empty because light never looks at them.
"""

from __future__ import annotations

import numpy as np

from workbench.core.results import MembraneMesh, Skin, VolumeMesh


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


def finger(
    *,
    radius_mm: float = 15.0,
    elastomer_mm: float = 2.0,
    support_mm: float = 1.0,
    cylinder_mm: float = 27.0,
    edge_mm: float = 0.8,
) -> MembraneMesh:
    """The finger of the paper's GelTip: outer radius 15 mm, wall 2 mm, on a 1 mm support."""
    empty = VolumeMesh(
        points_mm=np.zeros((0, 3)),
        cells=np.zeros((0, 8), dtype=np.int32),
        labels=np.zeros(0, dtype=np.uint8),
        quality=np.zeros(0, dtype=np.float32),
        layers=0,
        volume_mm3=0.0,
    )
    bonded = radius_mm - elastomer_mm
    return MembraneMesh(
        hexes=empty,
        outer=finger_skin(radius_mm, cylinder_mm, edge_mm),
        inner=finger_skin(bonded, cylinder_mm, edge_mm),
        cavity=finger_skin(bonded - support_mm, cylinder_mm, edge_mm),
    )


def dent(
    skin: Skin, *, at_mm: tuple[float, float, float], depth_mm: float, radius_mm: float
) -> np.ndarray:
    """Smooth inward displacement [mm], shape (V, 3), float32, zero beyond 3 `radius_mm`.

    u = -depth n exp(-d^2 / (2 (radius / 2)^2)), with d the distance to `at_mm`.
    """
    distance = np.linalg.norm(skin.points_mm - np.asarray(at_mm), axis=1)
    nearest = int(np.argmin(distance))
    height = depth_mm * np.exp(-2.0 * (distance / radius_mm) ** 2)
    height[distance > 3.0 * radius_mm] = 0.0
    return (-height[:, None] * skin.normals[nearest]).astype(np.float32)
