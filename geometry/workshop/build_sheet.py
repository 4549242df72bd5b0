"""The build sheet (one self-contained HTML page) and the parts list (CSV)."""

from __future__ import annotations

import csv
import html
import io
from collections.abc import Iterable, Sequence

from geometry.mould.print_checks import tolerated
from workbench.core.result.fabrication import (
    FabricationCheck,
    HousingSet,
    MouldSet,
    PrintItem,
    Recipe,
    Severity,
    SheetHead,
    SupplyItem,
)

STYLE = """
body{font:15px/1.5 system-ui,sans-serif;max-width:900px;margin:2em auto;padding:0 1em}
h1{font-size:1.5em}h2{font-size:1.1em;margin-top:1.6em}
table{border-collapse:collapse;font-size:.92em}
td,th{padding:3px 14px 3px 0;text-align:left;border-bottom:1px solid #e3e6ea;vertical-align:top}
.warning{background:#fff4d6}.bad{background:#ffe0e0}li{margin:.35em 0}
.chip{display:inline-block;width:1em;height:1em;border:1px solid #888;vertical-align:-2px}
img{max-width:100%}
@media print{body{margin:0}}
"""
DRAWING = "exploded.png"
TOLERATED = "within tolerance"
MARKS = {Severity.GOOD: "good", Severity.WARNING: "look", Severity.BAD: "BAD"}


def build_sheet_html(
    moulds: MouldSet,
    housing: HousingSet,
    recipe: Recipe,
    missing: Sequence[str],
    *,
    head: SheetHead,
) -> str:
    """The whole sheet; it shows `exploded.png` where that lies beside it.

    Args:
        missing: Why parts have no STEP file.
    """
    notices = [moulds.notice, housing.notice, recipe.notice, *missing]
    sections = [
        f"<h1>Build sheet of {html.escape(head.name)}</h1>",
        _table((), _head(head, recipe)),
        f'<img src="{DRAWING}" alt="mould and sensor, drawn apart" onerror="this.remove()">',
        "".join(f"<p>{html.escape(text)}.</p>" for text in notices if text),
        "<h2>Silicone</h2>" + _table((), _silicone(recipe)),
        "<h2>Steps</h2><ol>"
        + "".join(f"<li>{html.escape(s)}</li>" for s in recipe.steps)
        + "</ol>",
        "<h2>Motions that open the mould</h2>" + _table(MOTION_HEAD, _motion_rows(moulds)),
        "<h2>Checks</h2>" + _checks((*moulds.checks, *housing.checks, *recipe.checks)),
        "<h2>Supplies</h2>" + _table(SUPPLY_HEAD, map(_supply_row, recipe.supplies)),
        "<h2>Prints</h2>" + _table(PRINT_HEAD, map(_print_row, recipe.prints)),
        "<h2>LEDs</h2>" + _leds(recipe),
    ]
    return (
        '<!doctype html><html lang="en"><meta charset="utf-8"><title>'
        f"Build sheet of {html.escape(head.name)}</title>"
        f"<style>{STYLE}</style><body>{''.join(sections)}</body></html>"
    )


def bom_csv(recipe: Recipe) -> str:
    """Silicone, supplies, prints and LEDs, one row each: kind, name, amount, unit, details."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("kind", "name", "amount", "unit", "details"))
    for share, mass in (("part A", recipe.part_a_g), ("part B", recipe.part_b_g)):
        writer.writerow(("silicone", f"{recipe.silicone} {share}", f"{mass:.2f}", "g", ""))
    writer.writerow(("coating", "silicone paint", f"{recipe.coating_mm2:.0f}", "mm2", ""))
    for item in recipe.supplies:
        writer.writerow((item.kind, item.name, f"{item.amount:.4g}", item.unit, item.details))
    for item in recipe.prints:
        size = " x ".join(f"{s:.1f}" for s in item.size_mm)
        details = f"{item.group}, {item.process}, {size} mm"
        writer.writerow(("print", item.name, f"{item.volume_mm3 / 1000:.2f}", "ml", details))
    for led in recipe.leds:
        place = " ".join(f"{x:.3f}" for x in led.position_mm)
        axis = " ".join(f"{x:.4f}" for x in led.axis)
        details = f"{led.colour} at {place} mm, axis {axis}"
        writer.writerow(("LED", f"LED {led.number}", 1, "piece", details))
    return text.getvalue()


SUPPLY_HEAD = ("what", "amount", "for")
MOTION_HEAD = ("step", "part", "along x, y, z", "distance")
PRINT_HEAD = ("part", "for", "how", "volume", "size")


def _motion_rows(moulds: MouldSet) -> list[tuple[str, ...]]:
    """As `recipe.json` has them; closing is the reverse."""
    return [
        (
            str(motion.step),
            motion.part,
            ", ".join(f"{round(share, 3) + 0.0:.3f}" for share in motion.direction),
            f"{motion.distance_mm:.1f} mm",
        )
        for motion in moulds.motions
    ]


def _print_row(item: PrintItem) -> tuple[str, ...]:
    size = " x ".join(f"{s:.1f}" for s in item.size_mm)
    return item.name, item.group, item.process, f"{item.volume_mm3 / 1000:.2f} ml", f"{size} mm"


def _supply_row(item: SupplyItem) -> tuple[str, ...]:
    return item.name, f"{item.amount:.4g} {item.unit}", item.details


def _head(head: SheetHead, recipe: Recipe) -> list[tuple[str, str]]:
    size = " x ".join(f"{x:.1f}" for x in recipe.size_mm)
    return [
        ("design", head.name),
        ("family", head.family),
        ("silicone", recipe.silicone),
        ("shrinkage", f"{head.shrink_percent:g} %, which the cavity is larger by"),
        ("draft of the core", f"{head.draft_deg:g} degree"),
        ("overall size", f"{size} mm"),
    ]


def _silicone(recipe: Recipe) -> list[tuple[str, str]]:
    return [
        ("silicone", recipe.silicone),
        ("cavity", f"{recipe.cast_ml:.2f} ml"),
        ("to mix", f"{recipe.pour_ml:.2f} ml at {recipe.density_g_cm3:g} g/cm3"),
        ("part A", f"{recipe.part_a_g:.2f} g"),
        ("part B", f"{recipe.part_b_g:.2f} g"),
        ("coating", f"{recipe.coating_mm2:.0f} mm2 of sensing surface"),
        ("source", recipe.source),
    ]


def _checks(checks: Iterable[FabricationCheck]) -> str:
    rows = []
    for check in checks:
        # Adding 0 turns a rounded -0.0 into 0.0.
        place = ", ".join(f"{round(x, 1) + 0.0:.1f}" for x in check.place_mm)
        good = check.severity is Severity.GOOD
        leans = good and tolerated(check.value, check.limit, sense=check.sense)
        mark = TOLERATED if leans else MARKS[check.severity]
        cells = (mark, check.message, place)
        inside = "".join(f"<td>{html.escape(cell)}</td>" for cell in cells)
        rows.append(f'<tr class="{check.severity}">{inside}</tr>')
    head = "<tr><th></th><th>check</th><th>at x, y, z [mm]</th></tr>"
    return f"<table>{head}{''.join(rows)}</table>"


def _leds(recipe: Recipe) -> str:
    rows = []
    for led in recipe.leds:
        colour = html.escape(led.colour)
        numbers = "".join(f"<td>{x:.3f}</td>" for x in (*led.position_mm, *led.axis))
        chip = f'<span class="chip" style="background:{colour}"></span>'
        rows.append(f"<tr><td>{led.number}</td><td>{chip} {colour}</td>{numbers}</tr>")
    names = ("LED", "colour", "x [mm]", "y [mm]", "z [mm]", "axis x", "axis y", "axis z")
    head = "".join(f"<th>{name}</th>" for name in names)
    return f"<table><tr>{head}</tr>{''.join(rows)}</table>"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    first = "".join(f"<th>{html.escape(name)}</th>" for name in head)
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table>{f'<tr>{first}</tr>' if head else ''}{body}</table>"
