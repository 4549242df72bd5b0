"""How thick the elastomer is below the skin."""

from __future__ import annotations

import numpy as np

from workbench.core.result.results import MembraneMesh, Skin


def wall_mm(mesh: MembraneMesh) -> np.ndarray:
    """Thickness of the elastomer below each outer vertex along its normal [mm], shape (V,).

    Where the inward normal misses the inner skin (at the rim) the nearest distance stands in.
    """
    from scipy.spatial import KDTree

    from geometry.surface.rays import RayCaster

    skin: Skin = mesh.outer
    caster = RayCaster(mesh.inner.points_mm, mesh.inner.faces)
    distance = caster.hits(skin.points_mm, -skin.normals)[0]
    nearest = KDTree(mesh.inner.points_mm).query(skin.points_mm)[0]
    return np.where(distance < 3.0 * nearest, distance, nearest)
