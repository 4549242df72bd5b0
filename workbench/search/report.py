"""The report of a search: one HTML page that loads nothing from elsewhere."""

from __future__ import annotations

import html
import time
from collections.abc import Mapping, Sequence

from workbench.core.base.units import human_seconds
from workbench.core.base.version import VERSION
from workbench.pipeline.store import Store
from workbench.report.html_page import figure, page, table
from workbench.report.thumbnails import thumbnail_png
from workbench.search.applying import base_parameters
from workbench.search.finalists import Finalist
from workbench.search.front import Found, progress_lines
from workbench.search.front_plot import (
    front_svg,
    goal_words,
    importance_svg,
    lines_svg,
    title_of,
)
from workbench.search.judged import Status, savings
from workbench.search.parallel_plot import SCRIPT, STYLE, parallel_svg
from workbench.search.problem import Want

COLOURS = (
    "Grey: proposed by a Sobol sequence; blue: guided by what was seen before. Hollow points break "
    "a limit, those with a red rim are the front, the diamond is the base."
)
UNTOLD = "<p>Not told: the search was stopped, or has too few trials.</p>"
HONEST = (
    "What each kind of proposal reaches by itself after so many trials of its kind, refused ones "
    "left out. Guided ones have seen those by Sobol."
)


def report_page(
    found: Found,
    listed: Sequence[Finalist],
    shares: Mapping[str, Mapping[str, float]],
    store: Store,
) -> str:
    """The page.

    Args:
        found: The search.
        listed: Its front.
        shares: Of varied fields in how goals vary, by goal; {} where that was not asked.
        store: Where images are.

    Raises:
        StoreError: If a stored result is damaged.
    """
    problem = found.problem
    title = f"Search of {problem.base.design.name}"
    titles = {vary.path: vary.title for vary in problem.vary}
    bars = "".join(
        f"<h3>{html.escape(title_of(name))}</h3>{importance_svg(each, titles)}"
        for name, each in shares.items()
    )
    sections = [
        f"<style>{STYLE}</style><div class='search'><h1>{html.escape(title)}</h1>",
        f"<p>{time.strftime('%Y-%m-%d %H:%M')}. {html.escape(_told(found))}</p>",
        table([*_asked(found)]),
        f"<h2>Front</h2><p>{COLOURS}</p>{front_svg(found)}{_pictures(listed, store)}",
        _designs(found, listed),
        "<h2>All trials</h2><p>Drag along an axis to keep the trials that cross it there; click it "
        f"to free it.</p>{parallel_svg(found)}",
        f"<h2>How fast</h2><p>{HONEST}</p>{lines_svg(progress_lines(found))}",
        f"<h2>What matters</h2>{bars or UNTOLD}",
        f"<h2>What was refused</h2>{_refusals(found)}",
        f"<h2>To make it again</h2>{table([('workbench', VERSION), ('seed', problem.seed)])}",
        f"</div><script>{SCRIPT}</script>",
    ]
    return page(title, "\n".join(sections))


def _told(found: Found) -> str:
    refused = len(found.trials) - found.counted
    spent = human_seconds(sum(trial.judged.seconds for trial in found.trials))
    saved = savings(trial.judged for trial in found.trials).words
    return (
        f"{found.counted} trials in {spent}, {refused} more refused; "
        f"{len(found.front)} designs on the front. {saved}."
    )


def _asked(found: Found) -> list[tuple[str, str]]:
    problem = found.problem
    rows = [("goal", goal_words(goal)) for goal in problem.goals]
    rows += [("limit", f"{title_of(limit.figure)} {limit.words}") for limit in problem.limits]
    for vary in problem.vary:
        rows.append(("varied", f"{vary.title}: {vary.span}"))
    for link in problem.links:
        rows.append(("linked", f"{link.path} = {link.factor:g} x {link.follows} {link.offset:+g}"))
    if problem.even_light:
        rows.append(("solved", "LED powers for even light, by least squares in every trial"))
    rows.append(("settings of trials", ", ".join(problem.draft) or "the base's own"))
    return rows


def _pictures(listed: Sequence[Finalist], store: Store) -> str:
    """Membrane at rest, pressed, and the image, of each design that has one."""
    parts = []
    for one in listed:
        png = thumbnail_png(store, one.keys)
        if png is not None:
            drawn = figure(png, one.name, width=320)
            parts.append(drawn.replace("<figure", f"<figure data-trial='{one.trial.number}'", 1))
    return f"<div class='images'>{''.join(parts)}</div>"


def _designs(found: Found, listed: Sequence[Finalist]) -> str:
    """Table of the front: parameters, and each goal as drafted, confirmed, and at its worst."""
    problem, base = found.problem, found.base
    names = dict.fromkeys(name for one in listed for name in one.trial.judged.parameters)
    goals = [goal.figure for goal in problem.goals]
    limits = [limit.figure for limit in problem.limits if limit.figure not in goals]
    head = ["", "trial", *(name.removeprefix("design.") for name in names)]
    for name in (*goals, *limits):
        head += [title_of(name), "confirmed", "worst"]
    rows = [_row(one, names, (*goals, *limits)) for one in listed]
    if base is not None:
        figures = [base.figures.get(name) for name in (*goals, *limits)]
        cells = [cell for value in figures for cell in (_number(value), "", "")]
        own = base_parameters(problem)
        rows.insert(0, ["base", "", *(_value(own.get(name)) for name in names), *cells])
    header = "".join(f"<th>{html.escape(text)}</th>" for text in head)
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    better = "".join(f"<p>{html.escape(text)}</p>" for text in gains(found))
    return (
        f"<h2>Designs</h2>{better}<div style='overflow-x:auto'>"
        f"<table><tr>{header}</tr>{body}</table></div>"
    )


def _row(one: Finalist, names: Mapping[str, None], figures: Sequence[str]) -> list[str]:
    judged = one.trial.judged
    cells = [one.name + ("" if one.holds else " (does not hold)"), str(one.trial.number)]
    cells += [_value(judged.parameters.get(name)) for name in names]
    for name in figures:
        confirmed = {} if one.confirmed is None else one.confirmed.figures
        worst = {} if one.worst is None else one.worst.figures
        cells += [_number(each.get(name)) for each in (judged.figures, confirmed, worst)]
    return cells


def _value(value: object) -> str:
    return f"{value:.5g}" if isinstance(value, float) else "" if value is None else str(value)


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.5g}"


def gains(found: Found) -> list[str]:
    """How much better than the base the best of each goal is, by the settings of trials."""
    if found.base is None or not found.front:
        return []
    words = []
    for place, goal in enumerate(found.problem.goals):
        before = found.base.figures.get(goal.figure)
        best = min(found.front, key=lambda trial, place=place: trial.losses[place])
        after = best.judged.figures[goal.figure]
        if before and goal.want is not Want.TARGET:
            change = 100.0 * (after / before - 1.0)
            words.append(
                f"{title_of(goal.figure)}: base {before:.4g}, best {after:.4g} ({change:+.0f} %)."
            )
    return words


def _refusals(found: Found) -> str:
    """Reasons of refused and failed trials, the most frequent first."""
    count: dict[str, int] = {}
    for trial in found.trials:
        if trial.judged.status is not Status.JUDGED:
            reason = f"{trial.judged.status.value}: {trial.judged.reason}"
            count[reason] = count.get(reason, 0) + 1
    rows = sorted(count.items(), key=lambda item: -item[1])[:20]
    return table([(str(number), reason) for reason, number in rows]) if rows else "<p>Nothing.</p>"
