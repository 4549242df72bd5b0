"""The colour in which a front shows a light."""

from __future__ import annotations


def shown_colour(colour: str) -> tuple[int, int, int]:
    """Red, green, blue from 0 to 255 of `#rrggbb`, `525nm`, `525nm/35nm` or `5600K`."""
    from sim.optics.light.spectrum import linear_rgb

    red, green, blue = (round(255.0 * part) for part in linear_rgb(colour))
    return red, green, blue
