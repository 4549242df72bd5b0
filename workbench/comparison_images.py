"""Tactile images of two designs: side by side, one in place of the other, and their difference.

Images of different sizes are brought to the size of A by resampling where their proportions agree;
where they do not, pixels do not correspond and there is no difference to show. The difference is
B - A about mid grey, strengthened so that it is seen (`image_views.visible_change`).
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

import numpy as np

from workbench.core.sensing import Shot
from workbench.image_views import visible_change
from workbench.portraits import framed

GAP_PX = 8
GROUND = (70, 70, 70)
ALIKE = 0.01
"""Proportions that differ by less are the same."""


class Moment(enum.StrEnum):
    """Which image of a press."""

    LAST = "last frame"
    REST = "at rest"
    CHANGE = "change of the last frame"
    """From the image at rest."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Pair:
    """Two images on canvases of one size, and what is to be said of them."""

    a: np.ndarray
    """Shape (H, W, 3), uint8."""
    b: np.ndarray
    """Of the same shape."""
    difference: np.ndarray | None
    """None where pixels do not correspond."""
    words: str


def image_of(shot: Shot, moment: Moment) -> tuple[np.ndarray, str]:
    """An image of a press and how it was strengthened, "" where it was not."""
    rgb = shot.frames.rgb
    if moment is Moment.CHANGE:
        change, gain = visible_change(np.asarray(rgb[-1]), np.asarray(rgb[0]))
        return change, f"× {gain}"
    return np.asarray(rgb[-1 if moment is Moment.LAST else 0]), ""


def pair(a: Shot, b: Shot, moment: Moment) -> Pair:
    """Images of two presses at a moment; of changes, the difference is that of the images."""
    (image_a, gain_a), (image_b, gain_b) = image_of(a, moment), image_of(b, moment)
    strength = f" (A {gain_a}, B {gain_b})" if gain_a else ""
    shown_a, shown_b, note = alike(image_a, image_b)
    source = Moment.LAST if moment is Moment.CHANGE else moment
    raw_a, raw_b, _ = alike(image_of(a, source)[0], image_of(b, source)[0])
    if note.startswith("their proportions"):
        return Pair(a=shown_a, b=shown_b, difference=None, words=f"{moment}{strength}; {note}")
    change, gain = visible_change(raw_b, raw_a)
    words = f"{moment}{strength}; difference B − A of the {source} about mid grey, × {gain}"
    return Pair(a=shown_a, b=shown_b, difference=change, words=f"{words}; {note}".rstrip("; "))


def alike(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray, str]:
    """Two images on one size, and what was done for it."""
    if a.shape == b.shape:
        return a, b, ""
    sizes = f"A has {a.shape[1]} × {a.shape[0]} px, B {b.shape[1]} × {b.shape[0]} px"
    ratio = (a.shape[1] / a.shape[0]) / (b.shape[1] / b.shape[0])
    if abs(ratio - 1.0) < ALIKE:
        scaled = framed(b, (a.shape[1], a.shape[0]), GROUND)
        return a, scaled, f"{sizes}: B is resampled to the size of A"
    size = (max(a.shape[1], b.shape[1]), max(a.shape[0], b.shape[0]))
    note = f"their proportions differ ({sizes}): no pixel of one belongs to one of the other"
    return framed(a, size, GROUND), framed(b, size, GROUND), note


def side_by_side(both: Pair) -> np.ndarray:
    """A left, B right, a gap between them."""
    gap = np.full((both.a.shape[0], GAP_PX, 3), GROUND, dtype=np.uint8)
    return np.concatenate([both.a, gap, both.b], axis=1)
