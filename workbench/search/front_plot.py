"""Plots of a search as inline SVG: its front, how fast it came, and what mattered.

A point of a trial carries its number (`data-trial`), by which the report's script finds it.
"""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence

from workbench.report.plot_axis import INK, LINE, Axis, grid_lines
from workbench.search.front import Found, Trial
from workbench.search.problem import Goal, Want
from workbench.search.proposing import SOBOL
from workbench.search.search_figures import KNOWN

WIDTH, HEIGHT = 640, 380
LEFT, RIGHT, TOP, BOTTOM = 78, 20, 16, 48
GREY, BEST = "#8a93a0", "#c2410c"
BAR_PX, ROW_PX = 320, 20


def title_of(figure: str) -> str:
    """Label of a figure with its unit."""
    about = KNOWN[figure]
    return f"{about.label} [{about.unit}]" if about.unit else about.label


def goal_words(goal: Goal) -> str:
    """A goal for people."""
    near = f"as near {goal.value:g} as can be" if goal.want is Want.TARGET else ""
    way = {Want.MAX: "as large as can be", Want.MIN: "as small as can be"}.get(goal.want, near)
    return f"{title_of(goal.figure)} {way}"


def front_svg(found: Found) -> str:
    """The first two goals of every trial; of one goal the trials in their order."""
    first, *others = (goal.figure for goal in found.problem.goals)
    shown = [trial for trial in found.trials if trial.losses]
    if not shown:
        return "<p>No trial has figures yet.</p>"
    up_name = others[0] if others else first
    base: Mapping[str, float] = found.base.figures if found.base is not None else {}

    def place(trial: Trial) -> tuple[float, float]:
        figures = trial.judged.figures
        return figures[first] if others else float(trial.number), figures[up_name]

    places = [place(trial) for trial in shown]
    extra: list[tuple[float, float]] = []
    if others and first in base and up_name in base:
        extra.append((base[first], base[up_name]))
    across = Axis([x for x, _ in (*places, *extra)], WIDTH - RIGHT, LEFT)
    up = Axis([y for _, y in (*places, *extra)], TOP, HEIGHT - BOTTOM)
    best = {trial.number for trial in found.front}
    dots = "".join(
        _dot(trial, across(x), up(y), best=trial.number in best)
        for trial, (x, y) in zip(shown, places, strict=True)
    )
    marks = "".join(
        f"<path d='M{across(x):.1f},{up(y) - 7:.1f} l7,7 -7,7 -7,-7 z' fill='none' stroke='{INK}' "
        "stroke-width='2'><title>base</title></path>"
        for x, y in extra
    )
    x_title = title_of(first) if others else "trial"
    return _framed(across, up, (x_title, title_of(up_name)), dots + marks)


def _dot(trial: Trial, x: float, y: float, *, best: bool) -> str:
    colour = GREY if trial.sampler == SOBOL else LINE
    fill = colour if trial.allowed else "none"
    ring = f" stroke='{BEST}' stroke-width='3'" if best else f" stroke='{colour}'"
    figures = trial.judged.figures.items()
    words = ", ".join(f"{name} {value:.5g}" for name, value in figures if name in KNOWN)
    text = html.escape(f"trial {trial.number} by {trial.sampler}: {words}", quote=True)
    return (
        f"<circle data-trial='{trial.number}' cx='{x:.1f}' cy='{y:.1f}' r='5' fill='{fill}'{ring}>"
        f"<title>{text}</title></circle>"
    )


def _framed(across: Axis, up: Axis, titles: tuple[str, str], content: str) -> str:
    floor = HEIGHT - BOTTOM
    x_title, y_title = (html.escape(title) for title in titles)
    return (
        f"<svg viewBox='0 0 {WIDTH} {HEIGHT}' width='{WIDTH}' style='max-width:100%' role='img'>"
        f"<g font-size='12' fill='{INK}'>{grid_lines(across, up)}"
        f"<text x='{LEFT}' y='{HEIGHT - 6}'>{x_title}</text>"
        f"<text x='14' y='{floor}' transform='rotate(-90 14 {floor})'>{y_title}</text></g>"
        f"{content}</svg>"
    )


def lines_svg(lines: Mapping[str, Sequence[float]]) -> str:
    """Hypervolume over the trials of each kind."""
    if not lines:
        return "<p>No trial is allowed yet.</p>"
    most = max(len(line) for line in lines.values())
    across = Axis([1.0, float(max(most, 2))], WIDTH - RIGHT, LEFT)
    up = Axis([0.0, 1.0], TOP, HEIGHT - BOTTOM)
    parts = []
    for number, (name, line) in enumerate(lines.items()):
        colour = GREY if name == SOBOL else LINE
        points = " ".join(f"{across(k + 1):.1f},{up(v):.1f}" for k, v in enumerate(line))
        parts.append(
            f"<polyline points='{points}' fill='none' stroke='{colour}' stroke-width='2'/>"
            f"<text x='{LEFT + 10}' y='{TOP + 16 + 16 * number}' font-size='13' fill='{colour}'>"
            f"{html.escape(name)}</text>"
        )
    titles = ("trials of this kind", "hypervolume over that of all")
    return _framed(across, up, titles, "".join(parts))


def importance_svg(shares: Mapping[str, float], titles: Mapping[str, str]) -> str:
    """Bars of the share that each varied field has in a goal, the largest first."""
    rows = sorted(shares.items(), key=lambda item: -item[1])
    bars = "".join(
        f"<text x='0' y='{ROW_PX * k + 14}'>{html.escape(titles.get(name, name))}</text>"
        f"<rect x='240' y='{ROW_PX * k + 3}' width='{BAR_PX * share:.1f}' height='14' "
        f"fill='{LINE}'/><text x='{246 + BAR_PX * share:.0f}' y='{ROW_PX * k + 14}'>"
        f"{100.0 * share:.0f} %</text>"
        for k, (name, share) in enumerate(rows)
    )
    height = ROW_PX * len(rows) + 4
    return (
        f"<svg viewBox='0 0 {WIDTH} {height}' width='{WIDTH}' role='img'>"
        f"<g font-size='12' fill='{INK}'>{bars}</g></svg>"
    )
