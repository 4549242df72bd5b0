"""A finger and a dent in it with known normals: what the optics are validated on."""

from __future__ import annotations

import numpy as np

from sim.specimens import finger_skin, skins_only
from workbench.core.result.results import MembraneMesh, Skin


def finger(
    *,
    radius_mm: float = 15.0,
    elastomer_mm: float = 2.0,
    support_mm: float = 1.0,
    cylinder_mm: float = 27.0,
    edge_mm: float = 0.8,
) -> MembraneMesh:
    """The finger of the paper's GelTip: outer radius 15 mm, wall 2 mm, on a 1 mm support."""
    bonded = radius_mm - elastomer_mm
    return skins_only(
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
