"""The colour in which a front shows a light, and a letter for those who do not see it."""

from __future__ import annotations

LETTERS = {
    (True, False, False): "R",
    (False, True, False): "G",
    (False, False, True): "B",
    (True, True, False): "Y",
    (False, True, True): "C",
    (True, False, True): "M",
}
"""By which of red, green and blue are strong; all of them are white."""
STRONG = 0.5
"""Share of the strongest channel from which another one is strong as well."""


def shown_colour(colour: str) -> tuple[int, int, int]:
    """Red, green, blue from 0 to 255 of `#rrggbb`, `525nm`, `525nm/35nm` or `5600K`."""
    from sim.optics.light.spectrum import linear_rgb

    red, green, blue = (round(255.0 * part) for part in linear_rgb(colour))
    return red, green, blue


def colour_letter(colour: str) -> str:
    """R, G, B, Y, C, M or W, as a light looks; the same words as for `shown_colour`."""
    rgb = shown_colour(colour)
    red, green, blue = (part >= STRONG * max(rgb) for part in rgb)
    return LETTERS.get((red, green, blue), "W")
