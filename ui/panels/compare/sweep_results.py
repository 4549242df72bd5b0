"""What came of a sweep: plot of a figure, images with their values, and what failed."""

from __future__ import annotations

import base64
import html

import numpy as np
from viser import uplot

from ui.desk.desk import Desk
from ui.page.colours import BLUE, RED
from ui.page.offer import offer
from workbench.report.html_page import jpeg_bytes
from workbench.report.thumbnails import framed
from workbench.system.names import NONE
from workbench.variants.comparison_report import default_metric, strip
from workbench.variants.sweeps import Status, Sweep, curve, lost, metrics_of
from workbench.view.metric_rules import rule

TILE_PX = (104, 78)


class SweepResults:
    """Widgets below the form."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.sweep: Sweep | None = None
        gui = desk.server.gui
        self.metric = gui.add_dropdown(
            "Plot figure", (NONE,), visible=False, hint="What is drawn over the values"
        )
        self.metric.on_update(desk.guarded(lambda event: self._draw()))
        empty = (np.zeros(2), np.zeros(2))
        series = (uplot.Series(label="value"), uplot.Series(label="figure", stroke=BLUE, width=2))
        scales = {"x": uplot.Scale(time=False)}
        self.plot = gui.add_uplot(empty, series, scales=scales, aspect=1.6, visible=False)
        self.tiles = gui.add_html("")

    def load(self, sweep: Sweep | None) -> None:
        """Show a sweep as it stands, or none."""
        self.sweep = sweep
        known = [] if sweep is None else metrics_of(sweep)
        self.metric.visible = bool(known)
        if known:
            labels = tuple(rule(name).label for name in known)
            chosen = "" if self.metric.value in labels else rule(default_metric(known)).label
            offer(self.metric, labels, preferred=chosen)
        self._draw()

    def chosen(self) -> str:
        """The figure that is plotted."""
        known = [] if self.sweep is None else metrics_of(self.sweep)
        found = [name for name in known if rule(name).label == self.metric.value]
        return found[0] if found else default_metric(known)

    def _draw(self) -> None:
        sweep = self.sweep
        if sweep is None:
            self.tiles.content, self.plot.visible = "", False
            return
        metric = self.chosen()
        x, y = curve(sweep, metric)
        about = rule(metric)
        if len(x) > 1:
            unit = f" [{about.unit}]" if about.unit else ""
            self.plot.title = f"{about.label}{unit} against {sweep.field.title}"
            self.plot.data = (np.array(x), np.array(y))
        self.plot.visible = len(x) > 1
        self.tiles.content = self._strip(sweep, metric)

    def _strip(self, sweep: Sweep, metric: str) -> str:
        """Images with their values, then what failed or is lost."""
        store = self.desk.session.store
        tiles = "".join(_tile(image, caption) for image, caption in strip(store, sweep, metric))
        unit = html.escape(sweep.field.unit)
        words = [
            f"<div style='color:{RED}'>{p.value:.6g} {unit} failed: {html.escape(p.message)}</div>"
            for p in sweep.points
            if p.status is Status.FAILED
        ]
        if lost(sweep, store):
            words.append("<div>Some images were cleared from the store: resume the sweep.</div>")
        return (
            "<div style='display:flex;flex-wrap:wrap;gap:6px;margin:4px 8px;font-size:12px'>"
            f"{tiles}</div><div style='margin:4px 8px;font-size:12px'>{''.join(words)}</div>"
        )


def _tile(image: np.ndarray, caption: str) -> str:
    """A small image with its caption as HTML."""
    data = base64.b64encode(jpeg_bytes(framed(image, TILE_PX))).decode()
    return (
        f"<figure style='margin:0'><img alt='' src='data:image/jpeg;base64,{data}' "
        "style='border-radius:3px;display:block'>"
        f"<figcaption>{html.escape(caption)}</figcaption></figure>"
    )
