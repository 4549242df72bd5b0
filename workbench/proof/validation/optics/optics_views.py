"""What pixels see against ray casting and definitions: drawing, projection, depth maps, dents."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

from workbench.core.base.errors import WorkbenchError
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LightModel
from workbench.core.result.results import MembraneMesh
from workbench.proof.row import Row, bounded, compared, failed, stated
from workbench.proof.validation.optics.light_scenes import camera_of, mesh_of

if TYPE_CHECKING:
    from sim.optics.proof.view_checks import DrawingCheck

RECAST_LIMIT_MM = 2e-3
"""Single-precision rays agree to a few micrometres at 40 mm."""
DRAWN_MEDIAN_MM, DRAWN_RARE_MM = 1e-3, 0.02
NEWTON_MEDIAN_PX, NEWTON_HIGH_PX = 0.01, 0.1
"""The ray map is bilinear between pixels; the prototype's steps left 0.003 px."""
LEAST_CORRELATION = 0.8
CONTRAST_LIMIT = 0.1
"""What the project set itself for textures below the grid."""
SMALL = Camera(width_px=320, height_px=240)


def rows(mesh: MembraneMesh) -> list[Row]:
    """All of them; `mesh` is the finger of the optics room."""
    return [
        *_drawing(),
        *_projection(),
        *_depth_maps(mesh),
        *(row for model in LightModel for row in _dent(model, mesh)),
        *_sensitivity(),
        *_detail(),
    ]


def _drawing() -> list[Row]:
    """Drawing what moved against casting the whole deformed skin."""
    from sim.optics.proof.view_checks import drawing_error
    from sim.optics.raster.dents import FINGER_DENTS, PAW_DENTS, TRUNK_DENTS, dented

    def check(body: str) -> DrawingCheck:
        dent = {"finger": FINGER_DENTS, "trunk": TRUNK_DENTS, "paw": PAW_DENTS}[body][0]
        mesh = mesh_of(body)
        return drawing_error(mesh, camera_of(body), dented(mesh.seen, dent))

    found = []
    for body in ("finger", "trunk", "paw"):
        drawn = functools.cache(functools.partial(check, body))
        what = f"{body}, 320x240, sphere dent, against casting"
        found += [
            bounded(
                "raster",
                f"{what}: median",
                lambda drawn=drawn: drawn().median_mm,
                unit="mm",
                limit=DRAWN_MEDIAN_MM,
            ),
            bounded(
                "raster",
                f"{what}: 99.9th percentile",
                lambda drawn=drawn: drawn().rare_mm,
                unit="mm",
                limit=DRAWN_RARE_MM,
            ),
            stated(
                "raster",
                f"{body}: changed pixels where only one of both sees skin",
                lambda drawn=drawn: drawn().disagree_1,
                unit="1",
            ),
            stated(
                "raster",
                f"{body}: folded pixels, whose rays are cast in each frame",
                lambda drawn=drawn: drawn().folded_1,
                unit="1",
            ),
        ]
    return found


def _projection() -> list[Row]:
    from sim.optics.proof.view_checks import newton_error_px

    found = []
    for body in ("finger", "trunk", "paw"):
        what = f"{body}: places that a finer image sees, through the wall"
        try:
            median, high, null = newton_error_px(mesh_of(body), camera_of(body))
        except WorkbenchError as error:
            found.append(failed("newton_projection", what, unit="px", why=error.message))
            continue
        found += [
            bounded(
                "newton_projection",
                f"{what}, median; null: without refraction",
                median,
                unit="px",
                limit=NEWTON_MEDIAN_PX,
                null=null,
            ),
            bounded(
                "newton_projection",
                f"{what}, 99th percentile",
                high,
                unit="px",
                limit=NEWTON_HIGH_PX,
            ),
        ]
    return found


def _depth_maps(mesh: MembraneMesh) -> list[Row]:
    from sim.optics.proof import view_checks as checks

    found = [
        bounded(
            "frame_depth",
            "a frame draws only what moved: against a full cast of the deformed skin",
            checks.recast_error_mm,
            unit="mm",
            limit=RECAST_LIMIT_MM,
        )
    ]
    what = "the paper's depth map at index 1, contact box, against exact"
    try:
        paper = checks.published_depth_error(mesh, SMALL)
    except WorkbenchError as error:
        return [*found, failed("published_depth", what, unit="mm", why=error.message)]
    null = "null: the undeformed skin"
    return [
        *found,
        stated(
            "published_depth",
            f"{what}: median; {null}",
            paper.median_mm,
            unit="mm",
            null=paper.null_median_mm,
        ),
        stated(
            "published_depth",
            f"{what}: 99th percentile; {null}",
            paper.rare_mm,
            unit="mm",
            null=paper.null_rare_mm,
        ),
        stated("published_depth", f"{what}: pixels without one", paper.missing_1, unit="1"),
        stated("published_depth", "its time over that of drawing", paper.slower_1, unit="1"),
    ]


def _dent(model: LightModel, mesh: MembraneMesh) -> list[Row]:
    """What a dent changes in the image, and that nothing else changes."""
    from sim.optics.proof import view_checks as checks

    try:
        frames = checks.dented(model, mesh)
        scores = checks.dent_scores(frames)
        moved = checks.standard_dent(mesh.seen)
        still = checks.still_pixels(mesh, checks.optics_of(model), moved)
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
        bounded(
            "exact_background",
            f"{model.value}: largest difference where nothing moved; null: where something did",
            float(checks.still_difference_grey(frames, still)),
            unit="grey",
            limit=0.0,
            null=float(checks.still_difference_grey(frames, ~still)),
        ),
    ]


def _sensitivity() -> list[Row]:
    from sim.optics.proof.map_checks import sensitivity_check

    check = functools.cache(sensitivity_check)
    what = "0.1 mm dents of a 6 mm ball at 10 places of the finger, direct model"
    return [
        bounded(
            "map_sensitivity",
            f"{what}: correlation of map and images",
            lambda: check().correlation,
            unit="1",
            limit=LEAST_CORRELATION,
            sense="min",
        ),
        stated(
            "map_sensitivity",
            f"{what}: change in images over that of the map",
            lambda: check().ratio,
            unit="1",
        ),
    ]


def _detail() -> list[Row]:
    """Contrast of fine waves in the image over that of a skin meshed 10 times per period."""
    from sim.optics.proof import detail_checks

    measures = {
        "waves of 0.5 mm, which contact cannot resolve": detail_checks.wave_contrast,
        "waves of 1.5 mm, which the skin carries in part": detail_checks.carried_contrast,
    }
    found = []
    for case, measure in measures.items():
        try:
            with_detail, without = measure()
        except WorkbenchError as error:
            found.append(failed("surface_detail", case, unit="1", why=error.message))
            continue
        found.append(
            compared(
                "surface_detail",
                case,
                with_detail,
                1.0,
                unit="1",
                limit=CONTRAST_LIMIT,
                relative=False,
                null=without,
            )
        )
    return found
