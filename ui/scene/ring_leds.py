"""LEDs of the ring in the 3D view: a ball with a glow in its colour, and a letter for that colour.

Letters stand there while the skin is looked through, when LEDs are what is looked at: nobody then
has to tell red from green by the hue.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from workbench.core.design.leds import colour_sectors, led_places
from workbench.core.design.lighting import LedRing
from workbench.edit.led_colours import colour_letter, shown_colour

BALL_MM = 0.7
GLOW_MM = 1.3
GLOW_OPACITY = 0.25
LETTER_MM = (0.0, 0.0, 1.0)
"""Where the letter begins, from the middle of its LED."""


@dataclass(frozen=True, kw_only=True, slots=True)
class _Led:
    """Nodes of one LED; glow and letter follow the ball."""

    ball: Any
    glow: Any
    letter: Any


class RingLeds:
    """Nodes of one ring."""

    def __init__(self, api: Any) -> None:
        self.api = api
        self._leds: list[_Led] = []
        self._opacity: float | None = None
        """If the designer chose one."""
        self._lettered = False

    def show_ring(self, ring: LedRing) -> None:
        """Show the LEDs of a ring in their colours."""
        places, _ = led_places(ring)
        sectors = colour_sectors(ring)
        while len(self._leds) > ring.count:
            self._leds.pop().ball.remove()
        for i, place in enumerate(places):
            colour = ring.colours[sectors[i]]
            if i == len(self._leds):
                self._leds.append(self._add(i))
            led = self._leds[i]
            led.ball.position = place
            led.ball.color = led.glow.color = shown_colour(colour)
            if led.letter.text != colour_letter(colour):
                led.letter.text = colour_letter(colour)

    def _add(self, number: int) -> _Led:
        name = f"/leds/{number}"
        ball = self.api.add_icosphere(name, radius=BALL_MM, subdivisions=2)
        ball.opacity = self._opacity
        glow = self.api.add_icosphere(
            f"{name}/glow",
            radius=GLOW_MM,
            subdivisions=2,
            opacity=GLOW_OPACITY,
            cast_shadow=False,
            receive_shadow=False,
        )
        letter = self.api.add_label(
            f"{name}/letter",
            "",
            position=LETTER_MM,
            anchor="bottom-center",
            visible=self._lettered,
        )
        return _Led(ball=ball, glow=glow, letter=letter)

    def show(self, visible: bool) -> None:
        """Show or hide all of them."""
        for led in self._leds:
            led.ball.visible = visible

    def fade(self, opacity: float) -> None:
        """Draw them with an opacity in [0, 1]."""
        self._opacity = opacity
        for led in self._leds:
            led.ball.opacity = opacity

    def show_letters(self, wanted: bool) -> None:
        """Write the letter of its colour over each, or take the letters away."""
        self._lettered = wanted
        for led in self._leds:
            led.letter.visible = wanted
