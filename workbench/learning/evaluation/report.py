"""The report of an evaluation: one self-contained page, and the same numbers as JSON."""

from __future__ import annotations

import html
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from sim.forces.network.spec import Target
from workbench.core.base.version import VERSION
from workbench.learning.dataset.cases import Split
from workbench.learning.evaluation.evaluate import FieldResult, Named, tables
from workbench.learning.evaluation.field_charts import field_charts, spread_charts
from workbench.learning.evaluation.html_tables import (
    FIELD_WORDS,
    LIMITS,
    axes_table,
    grid,
    indenter_table,
    stiffness_html,
    summary_table,
    totals_table,
)
from workbench.learning.evaluation.leaks import dataset_keys
from workbench.learning.evaluation.scoring import Way, compared
from workbench.learning.evaluation.sheets import Sheet, Spread
from workbench.learning.evaluation.sources import Source, young_MPa
from workbench.learning.evaluation.speed import efficiency_html
from workbench.learning.evaluation.stiffness import StiffnessResult, stiffness_table
from workbench.report.html_page import figure, page
from workbench.report.image_files import png_bytes

SHEET_PX = 720
DEFINITIONS = """<p>Error: mean of |found &minus; finite elements| over all points of the skin, all
three axes and all samples, as in the paper; points at rest are included, so each number stands
beside what <i>zero</i> (no force, no displacement anywhere) and the raw contact solver score. Peak:
the largest length at a point of any sample, which belongs to this mesh. Largest pressure and
largest force through a disc do not: their bias is the mean of found over true, less 1. Every
prediction is in single precision.</p>"""
TEST_WORDS = """<p><i>test</i>: seen objects at places that training left out. On an
axisymmetric finger such a place may be a trained one turned about the axis, so <i>test</i> is
easier than it looks. <i>unseen</i>: objects that no training showed.</p>"""
STIFFNESS_WORDS = """<p>Under prescribed displacements the force is in proportion to E (same
Poisson ratio and friction, one modulus), so <i>untuned, times the ratio of E</i> needs no training.
Tuning must be judged beside it. The paper tunes the decoder at half and twice the stiffness; its
force error there, 1.16e-6 N, is below its untuned one of 8.6e-6 N: 1.16e-5 N is probably
meant.</p>"""
PAPER_WORDS = """<p>The paper reports 2.77e-4 mm and 8.6e-6 N a particle on its test set and no
peaks. <i>Paper over our peak</i> takes the peaks of this data; its force is first carried from its
0.4 mm mesh to the area of a point here, as nodal forces grow with it. The sizes of its objects are
not known: an estimate, no more.</p>"""


@dataclass(frozen=True, kw_only=True, slots=True)
class Evaluation:
    """Everything that a report shows."""

    name: str
    """Of the data."""
    source: Source
    weights: Sequence[Named]
    results: Mapping[Target, FieldResult]
    spread: Spread
    sheets: Sequence[Sheet] = ()
    stiffness: Sequence[StiffnessResult] = ()
    speed: Mapping[str, Any] = field(default_factory=dict[str, Any])
    made: str = field(default_factory=lambda: time.strftime("%Y-%m-%d %H:%M"))


def scores_table(found: Evaluation) -> dict[str, Any]:
    """All numbers, plain."""
    manifest = found.source.manifest
    return {
        "program": VERSION,
        "made": found.made,
        "data": {
            "name": found.name,
            "key": found.source.key,
            "young_MPa": young_MPa(found.source),
            "hex_mm": manifest["recipe"]["hex_mm"],
            "vertices": len(found.source.skin.points_mm),
            "area_of_point_mm2": float(found.source.skin.areas_mm2.mean()),
        },
        "weights": [{"file": n.name, "card": dict(n.weights.card)} for n in found.weights],
        "fields": {target.value: tables(one) for target, one in found.results.items()},
        "stiffness": [stiffness_table(one) for one in found.stiffness],
        "efficiency": dict(found.speed),
    }


def report_page(found: Evaluation) -> str:
    """The page."""
    title = f"Learned fields on {found.name}"
    recipe = found.source.manifest["recipe"]
    intro = (
        f"{found.made}. {html.escape(str(recipe['design'].get('name', '')))}, "
        f"E {young_MPa(found.source):g} MPa, hexahedra of {recipe['hex_mm']:g} mm, "
        f"{len(found.source.skin.points_mm):,} points."
    )
    areas = found.source.skin.areas_mm2
    sections = [
        f"<h1>{html.escape(title)}</h1><p>{intro}</p>",
        *(f"<p><b>{html.escape(line)}</b></p>" for line in verdicts(found.results)),
        "<h2>Summary</h2>" + DEFINITIONS + summary_table(found.results.values(), areas)
        + TEST_WORDS + PAPER_WORDS + _notes(found.results),
        *(_field_section(one) for one in found.results.values()),
        "<h2>The data</h2>" + spread_charts(found.spread),
        "<h2>Predicted, finite elements, difference</h2>" + _sheets(found.sheets),
        "<h2>Another stiffness</h2>" + STIFFNESS_WORDS + _stiffness(found),
        "<h2>Efficiency</h2>" + _speed(found.speed),
        "<h2>To make it again</h2>" + _provenance(found),
    ]  # fmt: skip
    return page(title, "\n".join(sections))


def verdicts(results: Mapping[Target, FieldResult]) -> list[str]:
    """How the fields stand to what is asked of them, in words."""
    lines = []
    for target, found in results.items():
        members = found.of(Split.UNSEEN)
        if not members:
            lines.append(f"No unseen object was scored for {FIELD_WORDS[target]}.")
            continue
        one = compared(members)
        parts = [
            f"{one.error_ratio(Way.LEARNED, way):.3f} of the {name}'s"
            + (_asked(one.error_ratio(Way.LEARNED, way), LIMITS[way], target))
            for way, name in ((Way.MPM, "contact solver"), (Way.ZERO, "zero predictor"))
        ]
        lines.append(
            f"On unseen objects the error of the learned {FIELD_WORDS[target]} is "
            f"{' and '.join(parts)}."
        )
    return lines


def _asked(found: float, limit: float, target: Target) -> str:
    if target is not Target.FORCE:
        return ""
    return f" (asked: at most {limit:g}; {'reached' if found <= limit else 'not reached'})"


def _notes(results: Mapping[Target, FieldResult]) -> str:
    notes = dict.fromkeys(note for one in results.values() for note in one.notes)
    return "".join(f"<p>{html.escape(note)}.</p>" for note in notes)


def _field_section(found: FieldResult) -> str:
    parts = [
        f"<h2>{FIELD_WORDS[found.target].capitalize()}, {html.escape(found.weights)}</h2>",
        "<h3>Axes of the sensor</h3>" + axes_table(found),
    ]
    if found.target is Target.FORCE:
        parts.append(
            "<h3>Total force along the axes of the press</h3><p>Mean absolute error of the sum "
            "over all points, against finite elements; full scale is the largest total.</p>"
            + totals_table(found)
        )
    parts.append("<h3>Objects</h3>" + indenter_table(found))
    parts.append(f"<div class='images' style='margin-top:1em'>{''.join(field_charts(found))}</div>")
    return "".join(parts)


def _sheets(sheets: Sequence[Sheet]) -> str:
    if not sheets:
        return "<p>No sample to draw.</p>"
    shown = [
        f"<p>{html.escape(sheet.caption)}</p>"
        if sheet.image is None
        else figure(png_bytes(sheet.image), sheet.caption, width=SHEET_PX)
        for sheet in sheets
    ]
    return f"<div class='images'>{''.join(shown)}</div>"


def _stiffness(found: Evaluation) -> str:
    if not found.stiffness:
        return "<p>No data set of another stiffness was given (--stiffness).</p>"
    exact = "".join(
        f"<p>{FIELD_WORDS[one.target].capitalize()} by finite elements at {one.young_MPa:g} MPa "
        f"against that at {young_MPa(found.source):g} MPa"
        f"{' times the ratio' if one.target is Target.FORCE else ''}: "
        f"{100.0 * one.truth_off:.2g} % apart on the {one.common} samples that both sets hold.</p>"
        for one in found.stiffness
        if one.common
    )
    table = stiffness_html(found.stiffness, found.results.values(), young_MPa(found.source))
    return table + exact


def _speed(table: Mapping[str, Any]) -> str:
    if not table:
        return "<p>Not measured.</p>"
    words = (
        "<p>Ours: the published network in the type that the browser uses, copies included. Load "
        "is the number of processes that wanted to run: above the number of cores, a rate is too "
        "low.</p>"
    )
    return words + efficiency_html(table)


def _provenance(found: Evaluation) -> str:
    rows = [("workbench", VERSION), ("key of the data", found.source.key)]
    for named in found.weights:
        card = named.weights.card
        rows += [
            (f"{named.name}: trained on", ", ".join(dataset_keys(card))),
            (f"{named.name}: E", f"{card.get('young_MPa', 'unknown')} MPa"),
            (f"{named.name}: training", _listed(card.get("training", {}))),
        ]
    return grid(("", ""), rows)


def _listed(table: Mapping[str, Any]) -> str:
    """Names and values in a line."""
    values = {name: f"{v:.4g}" if isinstance(v, float) else v for name, v in table.items()}
    return ", ".join(f"{name} {value}" for name, value in values.items() if value != "")
