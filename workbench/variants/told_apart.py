"""Two designs by what tasks found of them: scores beside each other, and what each confuses.

Scores count where networks were tested at places that they did not learn from. One design is called
better in a score where both differ by more than the spread of either over the seeds.
"""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from workbench.variants.comparison_tables import CELL, HEAD, NUMBER, TABLE, name_cell, scrolled
from workbench.variants.kept_tasks import Kept
from workbench.view.frame_words import MISSING

BY_PLACE = "sim_by_place"
"""The test that counts: places that training did not show."""
ERROR = "mae_"
"""Beginning of metrics of which less is better."""
CONFUSED = 0.2
"""Share of a class that is told as another from which on they are confused [1]."""
MOST_CONFUSED = 6
A_LETTER, B_LETTER = "A", "B"


@dataclass(frozen=True, kw_only=True, slots=True)
class Score:
    """One metric of one design."""

    value: float
    spread: float
    null: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Line:
    """One metric of both designs; None of one that was not judged so."""

    task: str
    how: str
    """Size and network."""
    metric: str
    a: Score | None
    b: Score | None

    @property
    def better(self) -> str:
        """The letter of the better one; "" where it is open."""
        if self.a is None or self.b is None:
            return ""
        apart = self.b.value - self.a.value
        if abs(apart) <= max(self.a.spread, self.b.spread):
            return ""
        return B_LETTER if (apart < 0.0) == self.metric.startswith(ERROR) else A_LETTER


def lines(a: Kept, b: Kept) -> list[Line]:
    """Scores of both, task by task; of the same size and network stand in one line."""
    found = []
    for name in sorted({*a, *b}):
        ours, theirs = _scores(a.get(name)), _scores(b.get(name))
        task, *how = name.split("-")
        for metric in dict.fromkeys((*ours, *theirs)):
            line = Line(
                task=task,
                how=" ".join(how),
                metric=metric,
                a=ours.get(metric),
                b=theirs.get(metric),
            )
            found.append(line)
    return found


def _scores(result: Mapping[str, Any] | None) -> dict[str, Score]:
    """Scores by metric of the test that counts."""
    return {
        row["metric"]: Score(value=row["value"], spread=row["spread"], null=row["null"])
        for row in (result or {"rows": ()})["rows"]
        if row["test"] == BY_PLACE
    }


def recalls(result: Mapping[str, Any] | None) -> dict[str, float]:
    """Share of each class that is told right; nothing where no classes are told."""
    found = _by_place(result).get("recall", {})
    return {name: share for name, share in found.items() if share is not None}


def confusions(result: Mapping[str, Any] | None) -> dict[tuple[str, str], float]:
    """Share of a class that is told as another, by both names, where it is `CONFUSED` or more."""
    details = _by_place(result)
    if "confusion" not in details:
        return {}
    counts = np.array(details["confusion"], np.float64)
    shares = counts / np.maximum(counts.sum(axis=1, keepdims=True), 1.0)
    names = details["outputs"]
    return {
        (names[true], names[told]): float(shares[true, told])
        for true, told in np.argwhere(shares >= CONFUSED).tolist()
        if true != told
    }


def _by_place(result: Mapping[str, Any] | None) -> Mapping[str, Any]:
    return {} if result is None else result["details"]["tests"].get(BY_PLACE, {})


def only_of(
    one: Mapping[str, Any] | None, other: Mapping[str, Any] | None
) -> list[tuple[str, str, float]]:
    """What one confuses that the other does not, the most often confused first."""
    others = confusions(other)
    found = [(*pair, share) for pair, share in confusions(one).items() if pair not in others]
    return sorted(found, key=lambda each: -each[2])[:MOST_CONFUSED]


def told_html(a: Kept, b: Kept, names: tuple[str, str]) -> str:
    """Everything about two designs as HTML; "" where nothing is known of either."""
    found = lines(a, b)
    if not found:
        return ""
    parts = [scrolled(_score_table(found, names))]
    for name in sorted({*a, *b}):
        one, other = a.get(name), b.get(name)
        classes = _class_table(recalls(one), recalls(other), names)
        if classes:
            parts.append(_words(f"{name.split('-')[0]}: share of each class that is told right"))
            parts.append(scrolled(classes))
        if one is not None and other is not None:
            parts += [
                _words(f"Only {letter} takes {_pairs(only)}.")
                for letter, only in (
                    (A_LETTER, only_of(one, other)),
                    (B_LETTER, only_of(other, one)),
                )
                if only
            ]
    return "".join(parts)


def _score_table(found: Sequence[Line], names: tuple[str, str]) -> str:
    head = "".join(f"<th style='{HEAD}'>{text}</th>" for text in ("task", "score"))
    head += "".join(map(name_cell, names)) + f"<th style='{HEAD}'>better</th>"
    rows = []
    for line in found:
        how = html.escape(f"{line.how}, renders at places that training did not show")
        cells = "".join(_score_cell(score) for score in (line.a, line.b))
        rows.append(
            f"<tr><td style='{CELL}' title='{how}'>{html.escape(line.task)}</td>"
            f"<td style='{CELL}'>{html.escape(line.metric.replace('_', ' '))}</td>{cells}"
            f"<td style='{CELL}'>{line.better or MISSING}</td></tr>"
        )
    return f"{TABLE}<tr>{head}</tr>{''.join(rows)}</table>"


def _score_cell(score: Score | None) -> str:
    if score is None:
        return f"<td style='{NUMBER}opacity:.65'>{MISSING}</td>"
    text = f"{score.value:.3g} ± {score.spread:.2g}"
    null = f"<br><span style='opacity:.65'>null {score.null:.3g}</span>"
    return f"<td style='{NUMBER}'>{text}{null}</td>"


def _class_table(a: Mapping[str, float], b: Mapping[str, float], names: tuple[str, str]) -> str:
    """Classes by recall, those first that the two differ most in."""
    classes = sorted({*a, *b}, key=lambda name: (-abs(a.get(name, 0.0) - b.get(name, 0.0)), name))
    if not classes:
        return ""
    head = f"<th style='{HEAD}'>class</th>" + "".join(map(name_cell, names))
    rows = "".join(
        f"<tr><td style='{CELL}'>{html.escape(name.replace('_', ' '))}</td>"
        f"{''.join(_share_cell(side.get(name)) for side in (a, b))}</tr>"
        for name in classes
    )
    return f"{TABLE}<tr>{head}</tr>{rows}</table>"


def _share_cell(share: float | None) -> str:
    text = MISSING if share is None else f"{100.0 * share:.0f} %"
    return f"<td style='{NUMBER}'>{text}</td>"


def _pairs(found: Sequence[tuple[str, str, float]]) -> str:
    return "; ".join(
        f"{true.replace('_', ' ')} for {told.replace('_', ' ')} ({100.0 * share:.0f} %)"
        for true, told, share in found
    )


def _words(text: str) -> str:
    return f"<p style='font-size:12px;margin:4px 8px'>{html.escape(text)}</p>"
