"""Geometry: bodies, meshes and moulds of the default finger against closed forms."""

from __future__ import annotations

from workbench.core.design import Meshing, MouldOptions
from workbench.core.monitor import silent
from workbench.core.results import Label
from workbench.rows import Row, bounded, compared
from workbench.stages import build, lattice, mesh, mould

CASE = "finger R 15, wall 2, cylinder 27 mm"
RADIUS_MM, CYLINDER_MM, WALL_MM = 15.0, 27.0, 2.0
SURFACE_LIMIT = 0.005
"""A chord of the 0.02 mm tessellation lies inside the arc: at most 0.3 % of the wall's volume."""
MESH_LIMIT = 0.002
LATTICE_LIMIT = 0.002
OVERLAP_LIMIT_MM3 = 1e-3
NOZZLE_WALL_MM = 0.8


def rows() -> list[Row]:
    """All rows of the room."""
    from designs.family import resolve_shape
    from geometry import checks
    from workbench.core.design import Layers

    solid = build("finger", resolve_shape("finger", {}), Layers(), monitor=silent)
    meshes = mesh(solid, Meshing(), monitor=silent)
    points = lattice(solid, 0.5, monitor=silent)
    moulds = mould(solid, MouldOptions(), monitor=silent)
    wall_mm3 = checks.capped_cylinder_mm3(RADIUS_MM, CYLINDER_MM)
    wall_mm3 -= checks.capped_cylinder_mm3(RADIUS_MM - WALL_MM, CYLINDER_MM)
    skin_mm2 = checks.capped_cylinder_mm2(RADIUS_MM, CYLINDER_MM)
    area_mm2 = checks.region_area_mm2(solid.membrane, Label.OUTER)
    radius_mm = checks.skin_radius_error_mm(
        meshes.outer, radius_mm=RADIUS_MM, cylinder_mm=CYLINDER_MM
    )
    closed = [float(part.watertight) for part in moulds.parts]
    return [
        compared("cad_volume", CASE, solid.volume_mm3, wall_mm3, unit="mm3", limit=1e-6),
        compared("outer_area", CASE, area_mm2, skin_mm2, unit="mm2", limit=SURFACE_LIMIT),
        compared(
            "surface_volume",
            CASE,
            checks.surface_volume_ratio(solid),
            1.0,
            unit="1",
            limit=SURFACE_LIMIT,
        ),
        bounded(
            "watertight", CASE, float(checks.watertight(solid)), unit="1", limit=1, sense="min"
        ),
        compared(
            "hex_volume",
            f"{CASE}, 0.4 mm",
            checks.hex_volume_ratio(meshes.hexes, solid),
            1.0,
            unit="1",
            limit=MESH_LIMIT,
        ),
        bounded(
            "hex_scaled_jacobian",
            f"{CASE}, 0.4 mm",
            checks.hex_least_quality(meshes.hexes),
            unit="1",
            limit=0.1,
            sense="min",
        ),
        bounded("skin_on_surface", f"{CASE}, 0.4 mm", radius_mm, unit="mm", limit=0.02),
        compared(
            "lattice_volume",
            f"{CASE}, 0.5 mm",
            checks.lattice_volume_ratio(points, solid.membrane),
            1.0,
            unit="1",
            limit=LATTICE_LIMIT,
        ),
        bounded(
            "mould_overlap",
            CASE,
            checks.mould_overlap_mm3(moulds),
            unit="mm3",
            limit=OVERLAP_LIMIT_MM3,
        ),
        bounded("mould_watertight", CASE, min(closed), unit="1", limit=1, sense="min"),
        bounded(
            "mould_thinnest_wall",
            CASE,
            moulds.thinnest_wall_mm,
            unit="mm",
            limit=NOZZLE_WALL_MM,
            sense="min",
        ),
    ]
