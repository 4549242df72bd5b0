"""The LED table: every LED of the ring with place, colour and power, and one of them to edit."""

from __future__ import annotations

import html
from typing import Any

from ui.desk.desk import Desk
from ui.page.callbacks import put
from ui.panels.optics.handles import RING
from workbench.core.base.errors import WorkbenchError
from workbench.core.design.lighting import LedRing
from workbench.edit.led_colours import shown_colour
from workbench.edit.led_table import Led, leds_of, with_colour, with_factor
from workbench.edit.light_edit import colour_words, read_colour
from workbench.system.names import NONE

CELL = "padding:1px 6px;text-align:right"
MOST_FACTOR = 3.0


class LedTable:
    """Widgets of the folder."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui, guarded = desk.server.gui, desk.guarded
        with gui.add_folder("LED table", expand_by_default=False):
            self.table = gui.add_html("")
            hint = "Counted from the first LED on, in the order of azimuth"
            self.choice = gui.add_dropdown("Single LED", (NONE,), hint=hint)
            self.choice.on_update(guarded(lambda event: self.refresh()))
            hint = "On the ring's LED power; 0 turns this LED off"
            self.factor = gui.add_slider("LED factor", 0.0, MOST_FACTOR, 0.05, 1.0, hint=hint)
            self.factor.on_update(guarded(self._power))
            hint = "red, #ff0000, 525nm, 525nm/35nm or 5600K; press Set LED colour"
            self.colour = gui.add_text("LED colour", "", hint=hint)
            hint = "Give this LED the colour above; the ring then lists every LED's"
            gui.add_button("Set LED colour", hint=hint).on_click(guarded(self._paint))
            desk.fields.anchor("Single LED", f"{RING}.powers")
        self._shown: tuple[LedRing, int] | None = None

    @property
    def ring(self) -> LedRing:
        """The ring as it stands."""
        return self.desk.session.design.optics.ring

    @property
    def number(self) -> int:
        """Of the chosen LED, from 1; 0 without any."""
        return 0 if self.choice.value == NONE else int(self.choice.value)

    def _power(self, event: Any) -> None:
        if event.client is not None and self.number:
            self.desk.edit(RING, with_factor(self.ring, self.number, float(self.factor.value)))

    def _paint(self, event: Any) -> None:
        if not self.number:
            return
        try:
            colour = read_colour(self.colour.value, at="optics.ring.powers")
            ring = with_colour(self.ring, self.number, colour)
        except WorkbenchError as error:
            error.at = "optics.ring.powers"
            raise
        self.desk.edit(RING, ring)
        self.desk.fields.refresh()

    def refresh(self) -> None:
        """List the LEDs as they stand, and show the chosen one."""
        ring = self.ring
        leds = leds_of(ring)
        names = tuple(str(led.number) for led in leds) or (NONE,)
        if tuple(self.choice.options) != names:
            now = self.choice.value
            self.choice.options = names
            self.choice.value = now if now in names else names[0]
        if self._shown == (ring, self.number):
            return
        self._shown = (ring, self.number)
        self.table.content = table_html(leds, self.number)
        if leds:
            led = leds[self.number - 1]
            put(self.factor, min(led.factor, MOST_FACTOR))
            put(self.colour, colour_words((led.colour,)))


def table_html(leds: tuple[Led, ...], chosen: int) -> str:
    """All LEDs as an HTML table, the chosen one marked."""
    head = "".join(
        f"<th style='{CELL}'>{name}</th>" for name in ("", "#", "x mm", "y mm", "z mm", "power")
    )
    return (
        "<div style='max-height:220px;overflow:auto;margin:4px 8px'>"
        f"<table style='font-size:12px;border-collapse:collapse'><tr>{head}</tr>"
        f"{''.join(_row(led, led.number == chosen) for led in leds)}</table></div>"
    )


def _row(led: Led, chosen: bool) -> str:
    r, g, b = shown_colour(led.colour)
    spot = f"<span style='color:rgb({r},{g},{b})'>&#9679;</span>"
    words = html.escape(colour_words((led.colour,)), quote=True)
    cells = [spot, str(led.number), *(f"{x:.1f}" for x in led.place_mm), f"{led.factor:g}"]
    ground = ";background:#8883" if chosen else ""
    columns = "".join(f"<td style='{CELL}'>{cell}</td>" for cell in cells)
    return f"<tr title='{words}' style='cursor:default{ground}'>{columns}</tr>"
