"""Geometry: bodies, meshes and moulds of the default finger against closed forms."""

from __future__ import annotations

import functools

from workbench.core.base.monitor import silent
from workbench.core.design.design import MouldOptions
from workbench.core.result.fabrication import MouldSet
from workbench.core.result.results import Label
from workbench.pipeline.stages.mould import MouldInputs, mould
from workbench.proof.row import Row, bounded, compared
from workbench.proof.specimens import finger_hexes, finger_mesh, finger_points, finger_solid
from workbench.proof.validation.geometry import meshes as mesh_rows
from workbench.proof.validation.geometry import moulds as mould_rows
from workbench.proof.validation.geometry import sweep

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
    from geometry.volume import checks

    @functools.cache
    def moulds() -> MouldSet:
        return mould(MouldInputs(solid=finger_solid(), options=MouldOptions()), monitor=silent)

    wall_mm3 = checks.capped_cylinder_mm3(RADIUS_MM, CYLINDER_MM)
    wall_mm3 -= checks.capped_cylinder_mm3(RADIUS_MM - WALL_MM, CYLINDER_MM)
    skin_mm2 = checks.capped_cylinder_mm2(RADIUS_MM, CYLINDER_MM)

    def area_mm2() -> float:
        return checks.region_area_mm2(finger_solid().membrane, Label.OUTER)

    def off_surface_mm() -> float:
        return checks.skin_radius_error_mm(
            finger_mesh().outer, radius_mm=RADIUS_MM, cylinder_mm=CYLINDER_MM
        )

    finger = [
        compared(
            "cad_volume", CASE, lambda: finger_solid().volume_mm3, wall_mm3, unit="mm3", limit=1e-6
        ),
        compared("outer_area", CASE, area_mm2, skin_mm2, unit="mm2", limit=SURFACE_LIMIT),
        compared(
            "surface_volume",
            CASE,
            lambda: checks.surface_volume_ratio(finger_solid()),
            1.0,
            unit="1",
            limit=SURFACE_LIMIT,
        ),
        bounded(
            "watertight",
            CASE,
            lambda: float(checks.watertight(finger_solid())),
            unit="1",
            limit=1,
            sense="min",
        ),
        compared(
            "hex_volume",
            f"{CASE}, 0.4 mm",
            lambda: checks.hex_volume_ratio(finger_hexes(), finger_solid()),
            1.0,
            unit="1",
            limit=MESH_LIMIT,
        ),
        bounded(
            "hex_scaled_jacobian",
            f"{CASE}, 0.4 mm",
            lambda: checks.hex_least_quality(finger_hexes()),
            unit="1",
            limit=0.1,
            sense="min",
        ),
        bounded("skin_on_surface", f"{CASE}, 0.4 mm", off_surface_mm, unit="mm", limit=0.02),
        compared(
            "lattice_volume",
            f"{CASE}, 0.5 mm",
            lambda: checks.lattice_volume_ratio(finger_points(), finger_solid().membrane),
            1.0,
            unit="1",
            limit=LATTICE_LIMIT,
        ),
        bounded(
            "mould_overlap",
            CASE,
            lambda: checks.mould_overlap_mm3(moulds()),
            unit="mm3",
            limit=OVERLAP_LIMIT_MM3,
        ),
        bounded(
            "mould_watertight",
            CASE,
            lambda: float(all(part.watertight for part in moulds().parts)),
            unit="1",
            limit=1,
            sense="min",
        ),
        bounded(
            "mould_thinnest_wall",
            CASE,
            lambda: moulds().thinnest_wall_mm,
            unit="mm",
            limit=NOZZLE_WALL_MM,
            sense="min",
        ),
    ]
    return [*finger, *mesh_rows.rows(), *mould_rows.rows(), *sweep.rows()]
