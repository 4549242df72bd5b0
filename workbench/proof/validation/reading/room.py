"""Readings: of renders by the same light, of photons, and of twins that nobody measured.

All rows rest on records, as a reading of one design takes minutes. Each is a comparison of the
product with itself, some more so than others: a render is read by the light that made it; photons
share the tracer; a twin shares the laws of contact and light, but none of its parameters; a twin by
Gent's law and Mitsuba does not share these either.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from workbench.core.base.errors import StoreError
from workbench.proof.row import Row, bounded, failed, stated
from workbench.proof.validation.reading import relit_figures, renders, twin_figures
from workbench.system.record import Record
from workbench.twin.twin_plan import Light

RENDER_LIMITS_MM = {"pad": 0.02, "geltip": 0.02, "trunk": 0.03, "paw": 0.03}
NOISE_LIMIT_MM, PHOTON_LIMIT_MM, TWIN_LIMIT_MM = 0.03, 0.05, 0.08
NORMAL_LIMIT_DEG = 3.0
RELIT_LIMIT_MM, RELIT_CONTACT, RELIT_FORCE = 0.04, 0.85, 0.1
ENOUGH_MILLIONS = 64
"""Photons of an image from which their noise is below one grey level, and something is asked."""
WORDS = {
    "renders": "rendered by the reader's own light, in whole grey levels",
    "noise": f"the same with {renders.NOISE_GREY:g} grey level of noise in each photograph",
    "photons": "photographed by {millions} million photons",
    "lamps": "of a sensor built by hand, whose lamps and coating are off and nobody calibrated",
    "built": "of the same sensor, whose camera is off too",
}


def rows() -> list[Row]:
    """All rows of the room."""
    return [*render_rows(), *twin_rows(), *relit_rows()]


def render_rows(kept: Record = renders.RECORD) -> list[Row]:
    """Rows of the analytic dents."""
    try:
        found = kept.figures()
    except StoreError as error:
        return [failed("reading_renders", "dents", unit="mm", why=error.message)]
    made = []
    for design, ways in found["designs"].items():
        for way, scores in ways.items():
            made += _render_rows(design, way, scores, (found["photons_millions"], kept))
    return made


def twin_rows(kept: Record = twin_figures.RECORD) -> list[Row]:
    """Rows of the twins."""
    try:
        found = kept.figures()["designs"]
    except StoreError as error:
        return [failed("reading_twin_calibrated", "presses", unit="mm", why=error.message)]
    return [row for design, figures in found.items() for row in _twin_rows(design, figures, kept)]


def relit_rows(kept: Record = relit_figures.RECORD) -> list[Row]:
    """Rows of the learned reader on calibrated twins whose photographs are relit."""
    try:
        found = kept.figures()["designs"]
    except StoreError as error:
        return [failed("reading_twin_relit", "presses", unit="mm", why=error.message)]
    return [row for design, figures in found.items() for row in _relit_rows(design, figures, kept)]


def _relit_rows(design: str, figures: dict[str, Any], kept: Record) -> Iterator[Row]:
    plan, scores = figures["plan"], figures[relit_figures.RELIT]
    plain, name = figures[relit_figures.AS_IT_IS], "reading_twin_relit"
    made = (
        f"{design}: {plan['presses']} presses by {plan['contact']} and "
        f"{plan['photons_millions']} million photons, {plan['width_px']} px, calibrated by "
        f"{plan['calibration']} photographs of a ball, relit as drawn and read by the reader "
        "learned for that"
    )
    as_it_is = f"as they are {plain['depth_mm']:.3f} mm"
    yield _depth_row(name, f"{made} ({as_it_is})", scores, (RELIT_LIMIT_MM, kept))
    yield _normal_row(f"{name}_normals", made, scores, (None, kept))
    yield _share_row(f"{name}_sigma", made, scores, kept)
    yield bounded(
        f"{name}_force",
        f"{made}: median difference of the force over the true one; null: no force",
        scores[relit_figures.MEDIAN],
        unit="1",
        limit=RELIT_FORCE,
        null=1.0,
        record=kept,
    )
    yield bounded(
        f"{name}_contact",
        f"{made}: contact area, intersection over union; null: no contact",
        scores["contact_iou"],
        unit="1",
        limit=RELIT_CONTACT,
        sense="min",
        null=0.0,
        record=kept,
    )


def _render_rows(
    design: str, way: str, scores: dict[str, Any], of: tuple[int, Record]
) -> Iterator[Row]:
    millions, kept = of
    words = WORDS[way].format(millions=millions)
    case = f"{design}: {scores['count']:.0f} dents, {words}"
    limits = {
        "renders": RENDER_LIMITS_MM.get(design),
        "noise": NOISE_LIMIT_MM,
        "photons": PHOTON_LIMIT_MM if millions >= ENOUGH_MILLIONS else None,
    }
    yield _depth_row(f"reading_{way}", case, scores, (limits.get(way), kept))
    asked = NORMAL_LIMIT_DEG if way == "renders" else None
    yield _normal_row(f"reading_{way}_normals", case, scores, (asked, kept))
    yield _share_row(f"reading_{way}_sigma", case, scores, kept)


def _twin_rows(design: str, figures: dict[str, Any], kept: Record) -> Iterator[Row]:
    plan = figures["plan"]
    product_s_own = plan.get("light", Light.PHOTONS) == Light.PHOTONS
    made = (
        f"{design}: {plan['presses']} presses by {plan['contact']} and "
        f"{plan['photons_millions']} million photons{'' if product_s_own else ' of Mitsuba'}, "
        f"{plan['width_px']} px"
    )
    fitted = {
        twin_figures.UNPLACED: "at places that nobody knows",
        twin_figures.CALIBRATION: "at places that a stage knows",
    }
    ways = (twin_figures.UNCALIBRATED, twin_figures.LEARNED, *fitted)
    for what in (way for way in ways if way in figures):
        scores, name = figures[what], f"reading_twin_{what}"
        asked = what == twin_figures.CALIBRATION and product_s_own
        case = made
        if what in fitted:
            case += f", {plan['calibration']} photographs of a ball {fitted[what]}, "
            case += f"refined {plan['refine']}"
        yield _depth_row(name, case, scores, (TWIN_LIMIT_MM if asked else None, kept))
        limit = NORMAL_LIMIT_DEG if asked else None
        yield _normal_row(f"{name}_normals", case, scores, (limit, kept))
        yield _share_row(f"{name}_sigma", case, scores, kept)
        if scores["force_error"] is not None:
            yield stated(
                f"{name}_force",
                f"{case}: difference of the force over the true one; null: no force",
                scores["force_error"],
                unit="1",
                null=1.0,
                record=kept,
            )
        yield stated(
            f"{name}_contact",
            f"{case}: contact area, intersection over union; null: no contact",
            scores["contact_iou"],
            unit="1",
            null=0.0,
            record=kept,
        )


def _depth_row(
    name: str, case: str, scores: dict[str, Any], asked: tuple[float | None, Record]
) -> Row:
    limit, kept = asked
    case = f"{case}: mean error of depth; null: nothing moved; ceiling: known normals integrated"
    both = {
        "unit": "mm",
        "null": scores["depth_null_mm"],
        "ceiling": scores["depth_ceiling_mm"],
        "record": kept,
    }
    if limit is None:
        return stated(name, case, scores["depth_mm"], **both)
    return bounded(name, case, scores["depth_mm"], limit=limit, **both)


def _normal_row(
    name: str, case: str, scores: dict[str, Any], asked: tuple[float | None, Record]
) -> Row:
    limit, kept = asked
    case = f"{case}: median angle of normals; null: those at rest"
    both = {"unit": "degrees", "null": scores["normal_null_deg"], "record": kept}
    if limit is None:
        return stated(name, case, scores["normal_deg"], **both)
    return bounded(name, case, scores["normal_deg"], limit=limit, **both)


def _share_row(name: str, case: str, scores: dict[str, Any], kept: Record) -> Row:
    return stated(
        name,
        f"{case}: share of the errors of depth within one standard deviation",
        scores["within_sigma"],
        unit="1",
        reference=0.68,
        record=kept,
    )
