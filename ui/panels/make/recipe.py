"""The recipe of a sensor as tables: what to weigh, solder and print, then the steps."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence

from workbench.core.base.units import volume_ml
from workbench.core.result.fabrication import Recipe

CELL = "padding:2px 8px 2px 0;vertical-align:top"
MM2_PER_CM2 = 100.0


def recipe_html(recipe: Recipe) -> str:
    """All of a recipe, with units in every heading."""
    weigh = [
        ("silicone", recipe.silicone),
        ("density", f"{recipe.density_g_cm3:.2f} g/cm³"),
        ("in the cavity", f"{recipe.cast_ml:.1f} ml"),
        ("mix, waste included", f"{recipe.pour_ml:.1f} ml"),
        ("part A", f"{recipe.part_a_g:.1f} g"),
        ("part B", f"{recipe.part_b_g:.1f} g"),
        ("coat", f"{recipe.coating_mm2 / MM2_PER_CM2:.1f} cm²"),
    ]
    leds = [
        (str(led.number), _swatch(led.colour), ", ".join(f"{x:.1f}" for x in led.position_mm))
        for led in recipe.leds
    ]
    prints = [
        (
            html.escape(item.name),
            f"{volume_ml(item.volume_mm3):.1f}",
            " × ".join(f"{x:.0f}" for x in item.size_mm),
            html.escape(item.process),
        )
        for item in recipe.prints
    ]
    steps = "".join(f"<li style='margin:3px 0'>{html.escape(step)}</li>" for step in recipe.steps)
    return (
        "<div style='font-size:12px;margin:8px'>"
        + _table((), ((a, html.escape(b)) for a, b in weigh))
        + f"<p>Numbers of the silicone: {html.escape(recipe.source)}</p>"
        + _table(("LED", "colour", "place x, y, z [mm]"), leds)
        + _table(("print", "volume [ml]", "size [mm]", "how"), prints)
        + f"<ol style='padding-left:18px;margin:8px 0'>{steps}</ol></div>"
    )


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; the cells are HTML."""
    first = "".join(f"<th style='{CELL};text-align:left'>{head}</th>" for head in heads)
    body = "".join(
        "<tr>" + "".join(f"<td style='{CELL}'>{cell}</td>" for cell in row) + "</tr>"
        for row in rows
    )
    return f"<table style='border-collapse:collapse;margin:4px 0'><tr>{first}</tr>{body}</table>"


def _swatch(colour: str) -> str:
    safe = html.escape(colour)
    square = "display:inline-block;width:10px;height:10px;border:1px solid #888"
    return f"<span style='{square};background:{safe}'></span> {safe}"
