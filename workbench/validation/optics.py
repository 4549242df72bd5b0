"""Optics: lenses, refraction, light fields and images against closed forms and definitions."""

from __future__ import annotations

from workbench.core.camera import LensModel
from workbench.core.errors import WorkbenchError
from workbench.core.lighting import LedRing, LightModel
from workbench.core.results import MembraneMesh
from workbench.rows import Row, bounded, failed

RADIUS_MM, CYLINDER_MM = 15.0, 27.0
ROUND_TRIP_LIMIT_PX = 1e-3
CLOSED_FORM_LIMIT = 1e-6
SINGLE_PRECISION = 1e-4
"""Fields are stored in float32; squared distances lose a few digits of it."""
DEPTH_LIMIT_MM = 0.02
"""Sag of a 0.5 mm facet on a radius of 15 mm is 0.002 mm; grazing rays stretch it."""
TANGENCY_LIMIT_DEG = 0.01
RECAST_LIMIT_MM = 2e-3
"""Single-precision rays agree to a few micrometres at 40 mm."""


def rows() -> list[Row]:
    """All rows of the room."""
    from sim.optics import checks
    from sim.optics.specimen import finger

    mesh, ring = finger(edge_mm=0.5), LedRing()

    def depth_mm() -> float:
        return checks.depth_error_mm(mesh, radius_mm=RADIUS_MM, cylinder_mm=CYLINDER_MM)

    found = [
        bounded(
            "projection",
            lens.value,
            lambda lens=lens: checks.round_trip_px(lens),
            unit="px",
            limit=ROUND_TRIP_LIMIT_PX,
        )
        for lens in LensModel
    ]
    found += [
        bounded(
            "field_of_view",
            lens.value,
            lambda lens=lens: checks.edge_angle_error_deg(lens),
            unit="deg",
            limit=1e-6,
        )
        for lens in LensModel
    ]
    found += [
        bounded("snell", "0-89 degrees", checks.snell_error, unit="1", limit=CLOSED_FORM_LIMIT),
        bounded("fresnel", "0-89 degrees", checks.fresnel_error, unit="1", limit=CLOSED_FORM_LIMIT),
        bounded(
            "plane_tangency",
            "plane_target field against the tangent plane",
            lambda: checks.tangency_error_deg(mesh, ring),
            unit="deg",
            limit=TANGENCY_LIMIT_DEG,
        ),
        bounded(
            "irradiance",
            "direct field against I cos^m / r^2",
            lambda: checks.irradiance_error(mesh, ring),
            unit="1",
            limit=SINGLE_PRECISION,
        ),
        bounded("depth_z", "cylinder and sphere", depth_mm, unit="mm", limit=DEPTH_LIMIT_MM),
        bounded(
            "frame_depth",
            "a frame casts only what moved: against a full cast of the deformed skin",
            checks.recast_error_mm,
            unit="mm",
            limit=RECAST_LIMIT_MM,
        ),
        bounded("optical_axis", "centred finger", checks.axis_error_px, unit="px", limit=0.5),
    ]
    for model in LightModel:
        found += _dent(model, mesh)
    return found


def _dent(model: LightModel, mesh: MembraneMesh) -> list[Row]:
    """What a dent changes in the image."""
    from sim.optics import checks

    try:
        frames = checks.dented(model, mesh)
        scores = checks.dent_scores(frames)
    except WorkbenchError as error:
        return [failed("dent_change", model.value, unit="grey", why=error.message)]
    return [
        bounded(
            "dent_change",
            f"{model.value}; null: background only, SSIM {scores['null_ssim_1']:.3f}, "
            f"{scores['null_psnr_dB']:.1f} dB",
            scores["change_grey"],
            unit="grey",
            limit=1.0,
            sense="min",
            null=0.0,
        ),
    ]
