"""Tables of a comparison as HTML, for the browser's dark panel and for printed reports alike.

Colours of text are those of what surrounds a table; only better and worse have their own, and each
has its arrow too. Everything that a designer typed is escaped.
"""

from __future__ import annotations

import html
from collections.abc import Sequence

from workbench.variants.comparison import Change, Difference, number_text
from workbench.variants.score_card import Card, Cell
from workbench.view.frame_words import MISSING
from workbench.view.metric_rules import Better, Rule

BETTER_COLOUR, WORSE_COLOUR = "#30a46c", "#e5484d"
"""Seen apart on white and on dark; arrows tell the same to those who do not."""
CELL = "padding:2px 6px;border-bottom:1px solid #8884;"
NUMBER = f"{CELL}text-align:right;white-space:nowrap;font-variant-numeric:tabular-nums;"
HEAD = f"{CELL}text-align:left;vertical-align:bottom;"
NAME = "display:inline-block;max-width:8em;overflow:hidden;text-overflow:ellipsis;"
SHORT, WRAPPED = "max-width:5em;", "white-space:normal;"
"""Where a table has a fourth column, which must not lie beyond the edge of its panel."""
TABLE = "<table style='font-size:12px;border-collapse:collapse;margin:4px 0'>"


def scrolled(table: str) -> str:
    """A table that scrolls sideways within its panel."""
    return f"<div style='overflow-x:auto;margin:4px 8px'>{table}</div>"


def name_cell(name: str, width: str = "") -> str:
    """The name of a design as the head of a column; a long one is cut, and whole on hovering."""
    safe = html.escape(name)
    return f"<th style='{NUMBER}'><span style='{NAME}{width}' title='{safe}'>{safe}</span></th>"


def rule_cell(rule: Rule) -> str:
    """Name, unit and better direction of a figure; the reason on hovering."""
    unit = f" <span style='opacity:.65'>{html.escape(rule.unit)}</span>" if rule.unit else ""
    why = html.escape(f"{rule.better.value}: {rule.why}")
    return (
        f"<td style='{CELL}' title='{why}'>{rule.better.arrow} {html.escape(rule.label)}{unit}</td>"
    )


def card_table(card: Card) -> str:
    """The score card: figures by designs, the best of each line marked."""
    if not card.names:
        return "<p>No design to compare yet.</p>"
    head = f"<th style='{HEAD}'>figure</th>" + "".join(name_cell(name) for name in card.names)
    rows = "".join(
        f"<tr>{rule_cell(line.rule)}{''.join(_figure_cell(cell) for cell in line.cells)}</tr>"
        for line in card.lines
    )
    return f"{TABLE}<tr>{head}</tr>{rows}</table>"


def _figure_cell(cell: Cell) -> str:
    if cell.value is None:
        why = f" title='missing: {html.escape(cell.remedy)}'" if cell.remedy else ""
        return f"<td style='{NUMBER}opacity:.65'{why}>{MISSING}</td>"
    text = number_text(cell.value)
    if cell.best:
        text = f"<b style='color:{BETTER_COLOUR}' title='best'>★ {text}</b>"
    return f"<td style='{NUMBER}'>{text}</td>"


def remedies(card: Card) -> str:
    """What to run for the figures that are missing, one sentence; "" where none is."""
    wanted: dict[str, list[str]] = {}
    for line in card.lines:
        for name, cell in zip(card.names, line.cells, strict=True):
            if cell.remedy and name not in wanted.setdefault(cell.remedy, []):
                wanted[cell.remedy].append(name)
    parts = [f"{what} ({', '.join(names)})" for what, names in wanted.items()]
    return f"{MISSING} is missing; to fill it: {'; '.join(parts)}" if parts else ""


def parameter_table(rows: Sequence[Difference], a: str, b: str) -> str:
    """Parameters that differ, by group."""
    if not rows:
        return "<p>No parameter differs.</p>"
    lines, group = [], ""
    for row in rows:
        if row.group != group:
            group = row.group
            lines.append(f"<tr><th colspan='3' style='{HEAD}padding-top:8px'>{group}</th></tr>")
        unit = f" <span style='opacity:.65'>{html.escape(row.unit)}</span>" if row.unit else ""
        cells = "".join(
            f"<td style='{CELL}text-align:right;max-width:12em;overflow-wrap:anywhere'>"
            f"{html.escape(text)}</td>"
            for text in (row.a, row.b)
        )
        lines.append(f"<tr><td style='{CELL}'>{html.escape(row.label)}{unit}</td>{cells}</tr>")
    head = f"<th style='{HEAD}'></th>{name_cell(a)}{name_cell(b)}"
    return f"{TABLE}<tr>{head}</tr>{''.join(lines)}</table>"


def change_table(rows: Sequence[Change], a: str, b: str) -> str:
    """Figures of both, and how B differs: an arrow, coloured by better or worse."""
    if not rows:
        return "<p>Neither has figures yet: press Run press.</p>"
    lines = "".join(
        f"<tr>{rule_cell(row.rule)}<td style='{NUMBER}'>{number_text(row.a)}</td>"
        f"<td style='{NUMBER}'>{number_text(row.b)}</td>{_change_cell(row)}</tr>"
        for row in rows
    )
    names = f"{name_cell(a, SHORT)}{name_cell(b, SHORT)}"
    head = f"<th style='{HEAD}'>figure</th>{names}<th style='{NUMBER}{WRAPPED}'>B against A</th>"
    return f"{TABLE}<tr>{head}</tr>{lines}</table>"


def _change_cell(row: Change) -> str:
    if row.a is None or row.b is None:
        return f"<td style='{NUMBER}opacity:.65'>{MISSING}</td>"
    if row.verdict == "same":
        return f"<td style='{NUMBER}opacity:.65'>same</td>"
    arrow = "▲" if row.b > row.a else "▼"
    size = "" if row.percent is None else f" {abs(row.percent):.3g} %"
    colour = {"better": BETTER_COLOUR, "worse": WORSE_COLOUR}.get(row.verdict, "inherit")
    word = f" {row.verdict}" if row.rule.better is not Better.NEUTRAL else ""
    return f"<td style='{NUMBER}{WRAPPED}color:{colour}'>{arrow}{size}{word}</td>"
