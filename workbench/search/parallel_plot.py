"""Parallel coordinates of a search as inline SVG, and the script by which they are brushed.

A vertical axis for every varied field and every goal; a line is a trial. Dragging along an axis
keeps the lines that cross it there, here and in the plot of the front; a click frees the axis.
"""

from __future__ import annotations

import html
from collections.abc import Sequence

from workbench.report.plot_axis import FAINT, INK, LINE, tick_text
from workbench.search.front import Found, Trial
from workbench.search.front_plot import BEST, GREY, title_of
from workbench.search.problem import Problem, Vary
from workbench.search.proposing import SOBOL

STEP_PX, HEIGHT, TOP, FLOOR = 118, 330, 62, 306
WORDS = 18
"""Longest title of an axis before it is cut."""
STYLE = """
.search .out{opacity:.06}.search .axis{cursor:ns-resize}.search .brush{fill:#c2410c;opacity:.25}
.search figure.out{display:none}
"""
SCRIPT = """
(() => {
  const svg = document.querySelector('svg.parallel');
  if (!svg) return;
  const kept = new Map();
  const lines = [...svg.querySelectorAll('polyline')];
  const all = [...document.querySelectorAll('.search [data-trial]')];
  function follow() {
    const out = new Set();
    for (const line of lines) {
      const at = line.dataset.at.split(' ').map(Number);
      for (const [k, [a, b]] of kept)
        if (!(at[k] >= a && at[k] <= b)) out.add(line.dataset.trial);
    }
    for (const one of all) one.classList.toggle('out', out.has(one.dataset.trial));
  }
  for (const axis of svg.querySelectorAll('.axis')) {
    const k = Number(axis.dataset.axis);
    const brush = svg.querySelector(`.brush[data-axis="${k}"]`);
    const y = e => new DOMPoint(e.clientX, e.clientY).matrixTransform(
      svg.getScreenCTM().inverse()).y;
    let from = null;
    axis.addEventListener('pointerdown', e => {
      from = y(e); axis.setPointerCapture(e.pointerId); e.preventDefault();
    });
    axis.addEventListener('pointermove', e => {
      if (from === null) return;
      const [a, b] = [from, y(e)].sort((p, q) => p - q);
      if (b - a < 3) { kept.delete(k); brush.setAttribute('height', 0); }
      else { kept.set(k, [a, b]); brush.setAttribute('y', a); brush.setAttribute('height', b - a); }
      follow();
    });
    axis.addEventListener('pointerup', e => {
      if (Math.abs(y(e) - from) < 3) {
        kept.delete(k); brush.setAttribute('height', 0); follow();
      }
      from = null;
    });
  }
})();
"""


class _Column:
    """One axis: where a trial crosses it, and what stands at its ends."""

    def __init__(self, title: str, values: Sequence[float | None], ends: tuple[str, str]) -> None:
        self.title = title
        self.values = values
        self.ends = ends
        known = [value for value in values if value is not None]
        self.low, self.high = min(known, default=0.0), max(known, default=1.0)

    def y(self, number: int) -> float | None:
        value = self.values[number]
        if value is None:
            return None
        span = self.high - self.low
        share = (value - self.low) / span if span else 0.5
        return FLOOR - share * (FLOOR - TOP)


def parallel_svg(found: Found) -> str:
    """Axes and lines of all trials that have figures; those of the front are drawn last."""
    best = {trial.number for trial in found.front}
    trials = [trial for trial in found.trials if trial.losses]
    trials.sort(key=lambda trial: trial.number in best)
    if not trials:
        return ""
    columns = _columns(found.problem, trials)
    width = STEP_PX * len(columns)
    lines = "".join(
        _line(trial, [column.y(k) for column in columns], best=trial.number in best)
        for k, trial in enumerate(trials)
    )
    axes = "".join(_axis(k, column) for k, column in enumerate(columns))
    return (
        f"<svg class='parallel' viewBox='0 0 {width} {HEIGHT}' width='100%' role='img'>"
        f"{lines}<g font-size='11' fill='{INK}'>{axes}</g></svg>"
    )


def _columns(problem: Problem, trials: Sequence[Trial]) -> list[_Column]:
    columns = []
    for vary in problem.vary:
        values = [_place(vary, trial) for trial in trials]
        ends = (vary.choices[0], vary.choices[-1]) if vary.choices else ("", "")
        columns.append(_Column(vary.title, values, ends))
    for name in [goal.figure for goal in problem.goals]:
        values = [trial.judged.figures.get(name) for trial in trials]
        columns.append(_Column(title_of(name), values, ("", "")))
    return columns


def _place(vary: Vary, trial: Trial) -> float | None:
    value = trial.judged.parameters.get(vary.path)
    if vary.choices:
        return float(vary.choices.index(str(value))) if value in vary.choices else None
    return None if value is None else float(value)


def _line(trial: Trial, heights: Sequence[float | None], *, best: bool) -> str:
    places = [(k, y) for k, y in enumerate(heights) if y is not None]
    points = " ".join(f"{_x(k):.0f},{y:.1f}" for k, y in places)
    at = " ".join("NaN" if y is None else f"{y:.1f}" for y in heights)
    colour = BEST if best else GREY if trial.sampler == SOBOL else LINE
    thick, share = (2.2, 0.95) if best else (1.0, 0.45)
    return (
        f"<polyline data-trial='{trial.number}' data-at='{at}' points='{points}' fill='none' "
        f"stroke='{colour}' stroke-width='{thick}' stroke-opacity='{share}'>"
        f"<title>trial {trial.number}</title></polyline>"
    )


def _x(number: int) -> float:
    return STEP_PX * (number + 0.5)


def _axis(number: int, column: _Column) -> str:
    x = _x(number)
    low, high = column.ends if any(column.ends) else map(tick_text, (column.low, column.high))
    words, _, unit = column.title.partition(" [")
    group, _, rest = words.rpartition(": ")
    unit = f"[{unit}" if unit else ""
    titles = [group, rest, unit]
    head = "".join(
        f"<text x='{x:.0f}' y='{14 + 13 * k}' text-anchor='middle'>{html.escape(_cut(text))}</text>"
        for k, text in enumerate(titles)
        if text
    )
    return (
        f"{head}<text x='{x:.0f}' y='{TOP - 4}' text-anchor='middle'>{html.escape(high)}</text>"
        f"<text x='{x:.0f}' y='{FLOOR + 14}' text-anchor='middle'>{html.escape(low)}</text>"
        f"<path d='M{x:.0f},{TOP} V{FLOOR}' stroke='{INK}'/>"
        f"<rect class='brush' data-axis='{number}' x='{x - 9:.0f}' y='{TOP}' width='18' "
        "height='0'/>"
        f"<rect class='axis' data-axis='{number}' x='{x - 14:.0f}' y='{TOP - 4}' width='28' "
        f"height='{FLOOR - TOP + 8}' fill='{FAINT}' fill-opacity='0.01'/>"
    )


def _cut(text: str) -> str:
    return text if len(text) <= WORDS + 1 else f"{text[:WORDS]}…"
