"""Reports to hand on: a comparison of two designs, and a sweep, each as one self-contained page.

Neither needs a script or anything from elsewhere, and both print. They end with versions and keys,
so that whoever has the designs can make the same results again.
"""

from __future__ import annotations

import html
import platform
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.base.version import VERSION
from workbench.pipeline.store import Store
from workbench.planning.stage_table import STAGES
from workbench.project.state import State
from workbench.report.html_page import figure, page, photograph, table
from workbench.report.thumbnails import framed, thumbnail_png
from workbench.variants.comparison import (
    changes,
    number_text,
    parameter_differences,
    press_notice,
    summary,
)
from workbench.variants.comparison_images import Moment, pair
from workbench.variants.comparison_side import NOW, Side
from workbench.variants.comparison_tables import card_table, change_table, parameter_table, remedies
from workbench.variants.comparison_words import sentences
from workbench.variants.score_card import Figures, card
from workbench.variants.sweep_plot import sweep_svg
from workbench.variants.sweeps import Status, Sweep, metrics_of, state_at
from workbench.variants.variants import KEPT
from workbench.view.metric_rules import rule

IMAGE_PX, STRIP_PX = 470, (160, 120)
ARROWS = (
    "↑ higher is better, ↓ lower is better, – neither. ▲ and ▼ say how B differs from A; figures "
    "that differ by less than 0.1 % are called the same."
)


@dataclass(frozen=True, kw_only=True, slots=True)
class Reported:
    """What stands in a comparison beside A and B."""

    others: Sequence[tuple[str, Figures]] = ()
    """Further designs of the score card: name and figures."""
    sweep: Sweep | None = None
    metric: str = ""
    """Figure that the sweep is plotted by."""


def comparison_page(store: Store, a: Side, b: Side, more: Reported | None = None) -> str:
    """A against B as one page; what is not stored is said instead of shown.

    Raises:
        StoreError: If a stored result is damaged.
    """
    more = Reported() if more is None else more
    title = f"{called(a)} against {called(b)}"
    rows = changes(a.figures, b.figures)
    found = summary(rows, press_notice(a.state, b.state))
    words = f"{_now()}. B is {html.escape(called(b))}. <b>{html.escape(found)}</b>"
    names = (f"A: {called(a)}", f"B: {called(b)}")
    designs = [(names[0], a.figures), (names[1], b.figures), *more.others]
    full = card(designs)
    sections = [
        f"<h1>{html.escape(title)}</h1><p>{words}</p>",
        *(f"<p>{html.escape(line)}</p>" for line in sentences(rows)),
        f"<div class='images'>{_who(store, a, 'A')}{_who(store, b, 'B')}</div>",
        "<h2>Parameters that differ</h2>"
        + parameter_table(parameter_differences(a.state, b.state), *names),
        f"<h2>Figures</h2><p>{ARROWS}</p>" + change_table(rows, *names),
        "<h2>Tactile images</h2>" + _images(store, a, b),
        "<h2>Score card</h2>" + card_table(full) + f"<p>{html.escape(remedies(full))}</p>",
    ]
    if more.sweep is not None:
        sections.append(_sweep_section(store, more.sweep, more.metric))
    sections.append("<h2>To make it again</h2>" + _provenance({"A": a.keys, "B": b.keys}))
    return page(title, "\n".join(sections))


def called(side: Side) -> str:
    """The name of a side for people."""
    if side.name == NOW:
        return f"{side.state.design.name} as it stands"
    return side.name


def _now() -> str:
    return time.strftime("%Y-%m-%d %H:%M")


def _who(store: Store, side: Side, letter: str) -> str:
    """Name, note and thumbnail of a side."""
    kept = f", kept {side.saved}" if side.saved else ""
    head = html.escape(f"{letter}: {called(side)} ({side.state.design.family}{kept})")
    note = f"<p style='white-space:pre-wrap'>{html.escape(side.note)}</p>" if side.note else ""
    thumbnail = thumbnail_png(store, side.keys)
    drawn = "<p>No result of it is stored, so there is no thumbnail.</p>"
    if thumbnail is not None:
        caption = "Membrane at rest and pressed (darker moved farther), and its tactile image"
        drawn = figure(thumbnail, caption, width=IMAGE_PX)
    return f"<section style='max-width:{IMAGE_PX}px'><h2>{head}</h2>{note}{drawn}</section>"


def _images(store: Store, a: Side, b: Side) -> str:
    shot_a, shot_b = a.shot(store), b.shot(store)
    lost = [called(s) for s, shot in ((a, shot_a), (b, shot_b)) if shot is None]
    if shot_a is None or shot_b is None:
        names = html.escape(" and ".join(lost))
        return f"<p>No image of {names} is stored: it was never pressed, or cleared since.</p>"
    parts = []
    for moment in (Moment.REST, Moment.LAST, Moment.CHANGE):
        both = pair(shot_a, shot_b, moment)
        parts += [
            photograph(both.a, f"A, {both.words.partition(';')[0]}", width=IMAGE_PX),
            photograph(both.b, f"B, {both.words.partition(';')[0]}", width=IMAGE_PX),
        ]
    last = pair(shot_a, shot_b, Moment.LAST)
    if last.difference is not None:
        parts.append(photograph(last.difference, f"difference {last.change_words}", width=IMAGE_PX))
    else:
        parts.append(f"<p>{html.escape(last.words)}</p>")
    return f"<div class='images'>{''.join(parts)}</div>"


def _provenance(keys: Mapping[str, Mapping[str, str]]) -> str:
    """Versions of program and stages, and keys of the results."""
    versions = ", ".join(f"{name} {STAGES[name].version}" for name in KEPT)
    rows = [
        ("workbench", VERSION),
        ("Python", platform.python_version()),
        ("versions of the stages", versions),
    ]
    for letter, stages in keys.items():
        rows += [(f"key of {stage}, {letter}", key) for stage, key in stages.items()]
    return table(rows)


def sweep_page(store: Store, sweep: Sweep, metric: str = "") -> str:
    """A sweep as one page: plot, images, figures of every point, and keys.

    Raises:
        StoreError: If a stored result is damaged.
    """
    title = f"Sweep {sweep.name}: {sweep.field.title}"
    keys = {f"{point.value:.6g}": point.keys for point in sweep.points if point.keys}
    designs = [(f"{p.value:.6g}", p.figures) for p in sweep.points if p.status is Status.DONE]
    full = card(designs)
    base = html.escape(f"{sweep.base.design.name} ({sweep.base.design.family})")
    sections = [
        f"<h1>{html.escape(title)}</h1><p>{_now()}, of {base}.</p>",
        _sweep_section(store, sweep, metric),
        f"<h2>Figures</h2><p>{ARROWS.split('▲', maxsplit=1)[0]}</p>" + card_table(full),
        "<h2>To make it again</h2>" + _provenance(keys),
    ]
    return page(title, "\n".join(sections))


def _sweep_section(store: Store, sweep: Sweep, metric: str) -> str:
    known = metrics_of(sweep)
    metric = metric if metric in known else default_metric(known)
    fails = [
        (f"{point.value:.6g} {sweep.field.unit}", f"failed: {point.message}")
        for point in sweep.points
        if point.status is Status.FAILED
    ]
    tiles = "".join(
        photograph(framed(image, STRIP_PX), caption, width=STRIP_PX[0])
        for image, caption in strip(store, sweep, metric)
    )
    head = html.escape(f"Sweep of {sweep.field.title}")
    failed = table(fails) if fails else ""
    return f"<h2>{head}</h2>{sweep_svg(sweep, metric)}<div class='images'>{tiles}</div>{failed}"


def default_metric(known: Sequence[str]) -> str:
    """The figure that a sweep is plotted by where none is chosen."""
    wanted = ("contact_change_mean_grey", "peak_normal_force_N")
    return next((name for name in wanted if name in known), known[0] if known else wanted[0])


def strip(store: Store, sweep: Sweep, metric: str) -> list[tuple[np.ndarray, str]]:
    """Last tactile image of each point that has one, with value and figure under it.

    Raises:
        StoreError: If a stored result is damaged.
    """
    found = []
    for point in sweep.points:
        key = point.keys.get("shoot", "none")
        if store.has("shoot", key):
            image = np.asarray(store.load("shoot", key).frames.rgb[-1])
            value = number_text(point.figures.get(metric))
            unit = f" {sweep.field.unit}" if sweep.field.unit else ""
            caption = f"{point.value:.6g}{unit}: {value} {rule(metric).unit}".rstrip()
            found.append((image, caption))
    return found


def point_state(sweep: Sweep, value: str) -> State:
    """Design and press of the point with that value, as the lists write it.

    Raises:
        DesignError: If there is none.
    """
    for number, point in enumerate(sweep.points):
        if f"{point.value:.6g}" == value:
            return state_at(sweep, number)
    raise DesignError(f"the sweep has no point {value}", hint="choose one of the list", at="sweep")
