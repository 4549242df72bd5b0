"""Numbers that show the geometry is right: each function compares with an exact answer.

Ratios are 1 when exact, overlaps 0. The validation table prints them; tests hold them to limits.
"""

from __future__ import annotations

import math

import numpy as np

from geometry.surface.surface import face_areas, is_watertight, mesh_volume
from workbench.core.result.fabrication import MouldSet
from workbench.core.result.results import (
    Label,
    LabelledSurface,
    MaterialPoints,
    Skin,
    Solid,
    VolumeMesh,
)


def capped_cylinder_mm3(radius_mm: float, cylinder_mm: float) -> float:
    """Volume of a cylinder with a hemispherical cap: pi r^2 L + 2/3 pi r^3."""
    return math.pi * radius_mm**2 * (cylinder_mm + 2.0 / 3.0 * radius_mm)


def capped_cylinder_mm2(radius_mm: float, cylinder_mm: float) -> float:
    """Area of its side and cap, without the base: 2 pi r L + 2 pi r^2."""
    return 2.0 * math.pi * radius_mm * (cylinder_mm + radius_mm)


def watertight(solid: Solid) -> bool:
    """Whether membrane, support and base are all closed."""
    return all(is_watertight(s.faces) for s in (solid.membrane, solid.support, solid.base))


def region_area_mm2(surface: LabelledSurface, label: Label) -> float:
    """Area of the faces with a label [mm2]."""
    return float(face_areas(surface.points_mm, surface.faces[surface.has(label)]).sum())


def surface_volume_ratio(solid: Solid) -> float:
    """Volume inside the membrane's triangles over that of the CAD kernel."""
    return mesh_volume(solid.membrane.points_mm, solid.membrane.faces) / solid.volume_mm3


def hex_volume_ratio(hexes: VolumeMesh, solid: Solid) -> float:
    """Volume of all hexahedra over that of the CAD kernel."""
    return hexes.volume_mm3 / solid.volume_mm3


def hex_least_quality(hexes: VolumeMesh) -> float:
    """Smallest scaled Jacobian; at or below 0 a cell is inverted."""
    return float(hexes.quality.min())


def lattice_volume_ratio(points: MaterialPoints, surface: LabelledSurface) -> float:
    """Volume of all material points over that inside the triangles."""
    return points.volume_mm3 / mesh_volume(surface.points_mm, surface.faces)


def skin_radius_error_mm(skin: Skin, *, radius_mm: float, cylinder_mm: float) -> float:
    """Largest distance of a skin's vertices from a cylinder with a hemispherical cap [mm]."""
    centre = skin.points_mm * [0.0, 0.0, 1.0]
    centre[:, 2] = np.minimum(centre[:, 2], cylinder_mm)
    return float(np.abs(np.linalg.norm(skin.points_mm - centre, axis=1) - radius_mm).max())


def mould_overlap_mm3(moulds: MouldSet) -> float:
    """Largest overlap of two parts of a mould, or of a part and the cast [mm3]."""
    return moulds.overlap_mm3
