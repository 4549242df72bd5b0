"""The page of a task: scores beside null and paper, confusions, curves, what went wrong."""

from __future__ import annotations

import html
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from workbench.learning.evaluation.charts import lines
from workbench.report import html_page
from workbench.tasks.features import ON_FEATURES
from workbench.tasks.networks import committee, dent, head
from workbench.tasks.networks.patch import DENT
from workbench.tasks.outcome import WORDS, Failure, Row, Tested
from workbench.tasks.run import Result
from workbench.tasks.task import Net, Told, task_of

CHANGED = "as differences from rest, twice as strong", 128, 2
DENTS = (Net.DENT, Net.MEASURES)
SEEN = {
    **dict.fromkeys(DENTS, ("as the dents that were read, white for a millimetre", 0, 1)),
    Net.MOTION: ("the last image, laid flat", 0, 1),
}
"""What networks are shown, in words, with the grey level of nothing and the gain it is drawn by."""
TOLD_EVERY = {Net.DENT: dent.TOLD_EVERY, Net.MOTION: committee.TOLD_EVERY}
"""Steps between two points of the curve of networks that count no epochs."""
LEFT = {Told.CLASS: "share of the validation part told wrong", Told.VALUES: "error in validation"}
CURVE_POINTS = 12
SHOWN_PX = 220


def report_page(result: Result, table: Mapping[str, Any]) -> str:
    """The whole page.

    Args:
        result: Tests and examples that went wrong.
        table: What `result.json` holds.
    """
    task, details = task_of(result.plan.task), table["details"]
    title = f"{result.plan.task}: {result.design.name}"
    body = [
        f"<h1>{html.escape(title)}</h1>",
        f"<p>{html.escape(task.purpose)}, from {task.look.value}; {html.escape(_learned(details))}."
        " Each value is the mean of three seeds, with its standard deviation; "
        f"null: {html.escape(task.null.value)}.</p>",
        _scores([row for test in result.tests for row in test.rows]),
    ]
    if task.formula:
        body.append(f"<p>{html.escape(f'safety = {task.formula}')}.</p>")
    for test in result.tests:
        body += _test(test, task.told, result.plan.net)
    body.append("<h2>How it was made</h2>")
    body.append(html_page.table(_made(details)))
    return html_page.page(title, "".join(body))


def _learned(details: Mapping[str, Any]) -> str:
    return (
        f"the network {details['network']} ({details['weights_from']}) learned from renders by "
        f"the contact solver, {details['examples']} examples at {details['places']} places"
    )


def _scores(rows: Iterable[Row]) -> str:
    head = ("test", "metric", "value", "spread", "null", "paper")
    lines_of = [
        [
            WORDS[_test_of(row)],
            row.metric,
            *(_number(v) for v in (row.value, row.spread, row.null)),
            "-" if row.paper is None else _number(row.paper),
        ]
        for row in rows
    ]
    return _grid(head, lines_of)


def _test_of(row: Row) -> Any:
    return next(test for test in WORDS if test.value == row.test)


def _test(test: Tested, told: Told, net: Net) -> list[str]:
    """Everything about one test."""
    parts = [f"<h2>{html.escape(WORDS[test.test])}</h2>"]
    details = test.details
    counts = ", ".join(map(str, details["tested_on"]))
    parts.append(f"<p>Tested on {counts} examples, seed by seed.</p>")
    if told is Told.CLASS:
        parts.append(_confusion(details["outputs"], np.array(details["confusion"])))
    else:
        ranks = details["rank_correlation"].items()
        parts.append(html_page.table([(f"rank correlation of {k}", v) for k, v in ranks]))
    if "told_by_frame_alone" in details:
        by_frame = _number(details["told_by_frame_alone"])
        within = _number(details["told_within_frames"])
        parts.append(
            f"<p>By the number of a window's last frame alone: {by_frame}. Among windows that end "
            f"in the same frame, where chance is a half: {within}.</p>"
        )
    if "delay" in details:
        delay = details["delay"]
        told_of = [(name.replace("_", " "), str(value)) for name, value in delay.items()]
        parts.append(f"<h3>Delay of slip</h3>{html_page.table(told_of)}")
    parts.append(curves(details["seeds"][0]["curve"], told, net))
    parts.append(_gallery(test.failures, net))
    return parts


def _confusion(names: Sequence[str], counts: np.ndarray) -> str:
    """Rows are what was true, columns what was told; all seeds together."""
    shares = counts / np.maximum(counts.sum(axis=1, keepdims=True), 1)
    head = "".join(f"<th>{html.escape(name)}</th>" for name in ("true, told as", *names))
    rows = []
    for k, name in enumerate(names):
        cells = "".join(
            f"<td class='n' style='background:{_shade(float(share))}'>{count}</td>"
            for count, share in zip(counts[k], shares[k], strict=True)
        )
        rows.append(f"<tr><td>{html.escape(name)}</td>{cells}</tr>")
    return f"<table><tr>{head}</tr>{''.join(rows)}</table>"


def _shade(share: float) -> str:
    """Blue, the deeper the larger the share."""
    return f"rgb(31 111 235 / {100.0 * share:.0f}%)"


def curves(curve: Sequence[Mapping[str, float]], told: Told, net: Net) -> str:
    """What a training had come to after each epoch, some steps, or with each penalty."""
    if len(curve) < 2:
        return ""
    names, below = [str(k + 1) for k in range(len(curve))], "epoch"
    if net in TOLD_EVERY:
        below = f"{TOLD_EVERY[net]} steps each"
    elif net in ON_FEATURES:
        names, below = [f"{each:g}" for each in head.PENALTIES], "penalty of the regression"
    shown = np.unique(np.linspace(0, len(curve) - 1, CURVE_POINTS).astype(int))
    series = {"loss of training": "train", LEFT[told]: "validation"}
    return lines(
        "How the first seed learned",
        [names[k] for k in shown],
        {words: [curve[k][name] for k in shown] for words, name in series.items()},
        below=below,
    )


def _gallery(failures: Sequence[Failure], net: Net) -> str:
    if not failures:
        return "<p>The first seed told nothing wrong.</p>"
    words, middle, gain = SEEN.get(net, CHANGED)
    figures = "".join(
        html_page.photograph(
            np.clip(middle + gain * _drawn(each.seen, net), 0, 255).astype(np.uint8),
            f"{each.name}: {each.words}",
            width=SHOWN_PX,
        )
        for each in failures
    )
    return f"<p>Wrong of the first seed, {words}:</p><div class='images'>{figures}</div>"


def _drawn(seen: np.ndarray, net: Net) -> np.ndarray:
    """What is drawn of what a network saw, shape (h, w, 3): of a dent itself, not the skin."""
    return np.repeat(seen[..., [DENT]], 3, axis=2) if net in DENTS else seen


def _made(details: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """What the numbers rest on."""
    plain = ("device", "look", "recipe", "design", "code", "program")
    rows: list[tuple[str, Any]] = [(name, details[name]) for name in plain]
    rows.append(("parameters", f"{details['parameters']:,}"))
    rows += [(f"learning: {name}", value) for name, value in details["learning"].items()]
    rows += [(f"time of {name} [s]", value) for name, value in details["seconds"].items()]
    for part in ("twin", "calibration", "trained_on_photos"):
        if part in details:
            rows += [(f"{part}: {k}", str(v)) for k, v in details[part].items() if k != "seeds"]
    return rows


def _grid(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    top = "".join(f"<th>{html.escape(name)}</th>" for name in head)
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table><tr>{top}</tr>{body}</table>"


def _number(value: float) -> str:
    return f"{value:.3g}"
