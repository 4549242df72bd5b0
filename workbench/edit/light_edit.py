"""How a designer writes lights: colours as a list of words, lamps by their form, models by a line.

A colour is `#rrggbb`, `525nm`, `525nm/35nm`, `5600K`, or one of a few names.
"""

from __future__ import annotations

import re

import numpy as np

from workbench.core.base.errors import DesignError, shown
from workbench.core.design.lighting import HEX, SPECTRUM, TEMPERATURE, Lamp, LampKind, LedRing

NAMED = {
    "red": "#ff0000",
    "green": "#00ff00",
    "blue": "#0000ff",
    "white": "#ffffff",
    "yellow": "#ffff00",
    "cyan": "#00ffff",
    "magenta": "#ff00ff",
}
"""Names that stand for a colour of the primaries of the display."""
ALLOWED = (
    "write #rrggbb (red, green and blue from 00 to ff, for example #ff8000), a wavelength as 525nm "
    f"or 525nm/35nm, a temperature as 5600K, or one of {', '.join(NAMED)}"
)
"""What a colour may be."""
NEW_LAMP_SHARE = 0.5
"""Where a new lamp stands, over the radius of the ring."""


def read_colours(text: str, *, at: str) -> tuple[str, ...]:
    """Colours that a designer writes with commas or spaces between them.

    Raises:
        DesignError: If there is none, or a word names none.
    """
    words = [word for word in re.split(r"[,;\s]+", text) if word]
    if not words:
        raise DesignError(
            "no colour is given", hint="for example: red green blue, or 525nm, or 5600K", at=at
        )
    return tuple(_code(word, at=at) for word in words)


def _code(word: str, *, at: str) -> str:
    """A colour as the design writes it; numbers out of their range the design refuses."""
    colour = NAMED.get(word.lower(), word)
    if not any(form.fullmatch(colour) for form in (HEX, SPECTRUM, TEMPERATURE)):
        raise DesignError(f"{shown(word)} is not a colour", hint=ALLOWED, at=at)
    return colour


def read_colour(text: str, *, at: str) -> str:
    """The one colour that a designer writes.

    Raises:
        DesignError: If it is none, or several.
    """
    colour, *more = read_colours(text, at=at)
    if more:
        raise DesignError(
            f"{1 + len(more)} colours are given for one lamp", hint="give one colour", at=at
        )
    return colour


def colour_words(colours: tuple[str, ...]) -> str:
    """Colours as a designer writes them."""
    names = {code: name for name, code in NAMED.items()}
    return ", ".join(names.get(colour.lower(), colour) for colour in colours)


def read_numbers(text: str, *, at: str) -> tuple[float, ...]:
    """Numbers with commas or spaces between them; none of an empty text.

    Raises:
        DesignError: If a word is no number.
    """
    words = [word for word in re.split(r"[,;\s]+", text) if word]
    try:
        return tuple(float(word) for word in words)
    except ValueError as error:
        raise DesignError(
            f"{shown(text)} is not a list of numbers", hint="for example: -0.12, 0.01, 0, 0", at=at
        ) from error


def number_words(numbers: tuple[float, ...]) -> str:
    """Numbers as `read_numbers` reads them."""
    return ", ".join(f"{number:g}" for number in numbers)


def new_lamp(kind: LampKind, ring: LedRing) -> Lamp:
    """A lamp to begin with: at the height of the ring, half as far out."""
    x_mm = round(NEW_LAMP_SHARE * ring.radius_mm, 2)
    return Lamp(kind=kind, position_mm=(x_mm, 0.0, ring.height_mm))


def lamp_frame(lamp: Lamp) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Unit axis, direction of the length and direction across, shape (3,) each.

    The length of an area turns into the plane across its axis, as in `core.leds`.
    """
    axis = np.asarray(lamp.axis) / np.linalg.norm(lamp.axis)
    along = np.asarray(lamp.along) / np.linalg.norm(lamp.along)
    if lamp.kind is LampKind.AREA:
        along = along - (along @ axis) * axis
        along = along / np.linalg.norm(along)
    return axis, along, np.cross(axis, along)


def lamp_corners_mm(lamp: Lamp) -> np.ndarray:
    """Ends of a line, shape (2, 3), or corners of an area in turn, shape (4, 3) [mm]."""
    _, along, across = lamp_frame(lamp)
    centre, half = np.asarray(lamp.position_mm), 0.5 * lamp.length_mm * along
    if lamp.kind is not LampKind.AREA:
        return np.array([centre - half, centre + half])
    side = 0.5 * lamp.width_mm * across
    return np.array(
        [centre - half - side, centre + half - side, centre + half + side, centre - half + side]
    )
