"""The Forces tab: numbers of the frame on show, force against depth, stick to slip, and a table."""

from __future__ import annotations

import numpy as np
from viser import uplot

from ui.desk.desk import Desk
from ui.page.colours import AMBER, BLUE, GREEN, GREY
from ui.panels.results.force_box import ForceBox
from ui.patches.leading import empty_state
from workbench.core.press.press import Press
from workbench.core.result.sensing import Contact
from workbench.view.force_asked import WayIn
from workbench.view.forces import gross_slip, slip_curve
from workbench.view.frame_words import finite, number, of_frame, phase
from workbench.view.press_figures import force_balance, frame_depths_mm

NO_PRESS = empty_state(
    "No press of this sensor yet: it tells forces, frame by frame.", "Run press (R)", key="r"
)
COLUMNS = {
    "#": "frame",
    "mm": "depth from first touch",
    "N": "force along the inward normal",
    "residual": "of the solver, over the force: 0 is exact equilibrium",
    "overlap µm": "how far skin and object stand in each other at most",
    "min J": "least volume of a cell over that at rest: 1 is unpressed, near 0 is crushed",
    "kinetic": "energy of motion over that of the strain: near 0 is at rest",
}
"""Columns of the table and what they mean."""
MOST_ROWS = 400
"""Frames of the table."""


class ForcesTab:
    """Widgets of the tab."""

    def __init__(self, desk: Desk) -> None:
        gui = desk.server.gui
        self.empty = gui.add_html(NO_PRESS)
        self.text = gui.add_markdown("", visible=False)
        empty = (np.zeros(2), np.zeros(2), np.zeros(2))
        self._curves = empty
        self._depth_mm = np.zeros(0)
        self._way = WayIn(depth_mm=empty[0], force_N=empty[1])
        self._marked = -1
        self.depth = gui.add_uplot(
            (*empty, np.zeros(2)),
            (
                uplot.Series(label="depth mm"),
                uplot.Series(label="normal force N", stroke=BLUE, width=2),
                uplot.Series(label="tangential force N", stroke=AMBER, width=2),
                uplot.Series(label="frame on show", stroke=GREY, width=1),
            ),
            scales={"x": uplot.Scale(time=False)},
            title="Force [N] against depth [mm], way in",
            aspect=1.5,
            visible=False,
        )
        self.box = ForceBox(desk)
        self.slip = gui.add_uplot(
            empty,
            (
                uplot.Series(label="frame"),
                uplot.Series(label="friction / pressing", stroke=AMBER, width=2),
                uplot.Series(label="share sliding", stroke=GREEN, width=2),
            ),
            scales={"x": uplot.Scale(time=False)},
            title="Stick to slip, frame by frame",
            aspect=1.5,
            visible=False,
        )
        self.rows = gui.add_folder("Frame by frame", expand_by_default=False, visible=False)
        with self.rows:
            self.table = gui.add_html("")

    def _offer(self, known: bool) -> None:
        """Show the figures and plots, or what to do for them."""
        self.empty.visible = not known
        for handle in (self.text, self.depth, self.slip, self.rows):
            handle.visible = known

    def clear(self) -> None:
        """Show no press."""
        self._offer(False)
        zero = np.zeros(2)
        self._curves = zero, zero, zero
        self.text.content = self.table.content = ""
        self.box.take(None)
        self.depth.data = (zero, zero, zero, zero)
        self.slip.data = (zero, zero, zero)

    def load(self, press: Press, contact: Contact, *, wall_mm: float | None) -> None:
        """Show all frames of a press.

        Args:
            press: What was asked for.
            contact: What came of it.
            wall_mm: Elastomer over the support; None where something else lies behind the skin.
        """
        self._offer(True)
        depth_mm = finite(np.array(frame_depths_mm(press, contact)))
        # A plot goes to the right: the way in ends where the object first stops going deeper.
        falls = np.flatnonzero(np.diff(depth_mm) <= 0.0)
        count = int(falls[0]) + 1 if len(falls) else len(depth_mm)
        self._curves = tuple(
            np.r_[0.0, finite(values)[:count]]
            for values in (depth_mm, contact.normal_N, tangential_force_N(contact))
        )
        self._way = WayIn(depth_mm=self._curves[0], force_N=self._curves[1], wall_mm=wall_mm)
        self._depth_mm = depth_mm
        self.box.take(self._way)
        self._marked = -1
        self.mark(len(depth_mm))
        ratio, share = slip_curve(contact)
        self.slip.data = (
            np.arange(len(ratio) + 1.0),
            np.r_[0.0, finite(ratio)],
            np.r_[0.0, finite(share)],
        )
        self.table.content = table_html(press, contact)

    def mark(self, frame: int) -> None:
        """Draw a line under the curve of force at a frame, counted from 1; none after the way in.

        The plot takes no gaps: the frame's place stands three times, so that the line goes up and
        down there.
        """
        count = len(self._curves[0])
        here = frame if 0 < frame < count else 0
        if here == self._marked:
            return
        self._marked = here
        places = np.sort(np.r_[np.arange(count), [here] * 2])
        line = np.zeros(count + 2)
        line[here + 1] = self._curves[1][here]
        self.depth.data = (*(values[places] for values in self._curves), line)

    def show(self, contact: Contact, k: int, *, what: str, note: str) -> None:
        """Show the numbers of frame `k`, counted from 0, in which `what` happens, below a note."""
        x, y, z = (number(value, ".3f") for value in contact.reaction_N[k])
        across = float(tangential_force_N(contact)[k])
        friction, pressing = of_frame(contact.tangential_N, k), of_frame(contact.pressing_N, k)
        text = (
            f"**{number(contact.normal_N[k], '.3f')} N** along the normal, frame {k + 1} of "
            f"{len(contact.reaction_N)}: {what}\n\n"
            f"{self._wall(k)}"
            f"on the object: x {x} · y {y} · z {z} N\n\n"
            f"tangential force {number(across, '.3f')} N · friction of all points "
            f"{number(friction, '.3f')} N, pressing {number(pressing, '.3f')} N\n\n"
            f"{slip_words(contact, k)}\n\n"
            f"peak {number(contact.normal_N.max(), '.3f')} N · residual "
            f"{number(contact.residual.max(), '.1e')} · force balance "
            f"{number(100 * force_balance(contact), '.2f')}\N{NO-BREAK SPACE}% · friction ratio ≤ "
            f"{number(contact.friction_ratio.max(), '.3f')}"
        )
        text = f"{note}\n\n{text}" if note else text
        if self.text.content != text:
            self.text.content = text

    def _wall(self, k: int) -> str:
        """How much of the wall is left under the object in frame `k`, with an empty line."""
        words = self._way.wall_words(float(self._depth_mm[k])) if k < len(self._depth_mm) else ""
        return f"{words}\n\n" if words else ""


def slip_words(contact: Contact, k: int) -> str:
    """How much of the contact slides in frame `k`, and when all of it began to."""
    if not len(contact.sliding_share):
        return "the method of particles does not say what slides"
    share = f"{number(100 * contact.sliding_share[k], '.0f')} % of the contact slides"
    gross = gross_slip(contact)
    if gross is None:
        return f"{share} · no gross slip"
    return f"{share} · gross slip from {number(gross.way_mm, '.2f')} mm on, frame {gross.frame}"


def tangential_force_N(contact: Contact) -> np.ndarray:
    """Size of the reaction across the target normal [N], shape (K,).

    That of a vector sum: frictions that oppose each other cancel here, while
    `Contact.tangential_N` adds up their sizes.
    """
    along = contact.normal_N[:, None] * contact.normal
    return np.linalg.norm(contact.reaction_N - along, axis=1)


def table_html(press: Press, contact: Contact) -> str:
    """Quality of every frame as an HTML table."""
    head = "".join(
        f"<th style='text-align:right;padding:0 5px' title='{meaning}'>{name}</th>"
        for name, meaning in COLUMNS.items()
    )
    depths_mm = frame_depths_mm(press, contact)
    rows = []
    for k in range(min(len(contact.reaction_N), MOST_ROWS)):
        cells = (
            str(k + 1),
            number(depths_mm[k], ".2f"),
            number(contact.normal_N[k], ".3f"),
            number(of_frame(contact.residual, k), ".0e"),
            number(1e3 * of_frame(contact.penetration_mm, k), ".0f"),
            number(of_frame(contact.least_volume_ratio, k), ".3f"),
            number(of_frame(contact.kinetic_ratio, k), ".0e"),
        )
        columns = "".join(f"<td style='text-align:right;padding:0 5px'>{c}</td>" for c in cells)
        rows.append(f"<tr title='{phase(press, k + 1)}'>{columns}</tr>")
    return (
        "<div style='max-height:260px;overflow:auto;margin:4px 8px'>"
        f"<table style='font:11px monospace;border-collapse:collapse'><tr>{head}</tr>"
        f"{''.join(rows)}</table></div>"
    )
