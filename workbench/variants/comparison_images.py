"""Tactile images of two designs: side by side, one in place of the other, and their difference.

Images of different sizes are brought to the size of A by resampling where their proportions agree;
where they do not, pixels do not correspond and there is no difference to show. The difference is
B - A about mid grey, strengthened so that it is seen (`image_views.visible_change`).
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

import numpy as np

from workbench.core.result.sensing import Shot
from workbench.report.thumbnails import framed
from workbench.view.image_views import visible_change

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
    """What `a` and `b` are."""
    change_words: str
    """What the difference is."""


def pair(a: Shot, b: Shot, moment: Moment) -> Pair:
    """Images of two presses at a moment, changes of both strengthened alike.

    The difference is that of the images themselves, of changes too.
    """
    image_a, image_b = _image(a, moment), _image(b, moment)
    raw_a, raw_b, note = alike(image_a, image_b)
    shown_a, shown_b, words = raw_a, raw_b, str(moment)
    if moment is Moment.CHANGE:
        rest_a, rest_b = _image(a, Moment.REST), _image(b, Moment.REST)
        gain = min(visible_change(image_a, rest_a)[1], visible_change(image_b, rest_b)[1])
        strong = _strengthened(image_a, rest_a, gain), _strengthened(image_b, rest_b, gain)
        shown_a, shown_b, _ = alike(*strong)
        words = f"{words}, both × {gain}"
    source = Moment.REST if moment is Moment.REST else Moment.LAST
    difference, of = None, ""
    if same_proportions(image_a, image_b):
        difference, gain = visible_change(raw_b, raw_a)
        of = f"B − A ({source}) about mid grey, × {gain}"
    words, of = ("; ".join(part for part in (text, note) if part) for text in (words, of))
    return Pair(a=shown_a, b=shown_b, difference=difference, words=words, change_words=of)


def _image(shot: Shot, moment: Moment) -> np.ndarray:
    return np.asarray(shot.frames.rgb[0 if moment is Moment.REST else -1])


def _strengthened(image: np.ndarray, rest: np.ndarray, gain: int) -> np.ndarray:
    change = image.astype(np.int16) - rest.astype(np.int16)
    return np.clip(128 + gain * change, 0, 255).astype(np.uint8)


def same_proportions(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether a pixel of one image belongs to a place in the other."""
    ratio = (a.shape[1] / a.shape[0]) / (b.shape[1] / b.shape[0])
    return abs(ratio - 1.0) < ALIKE


def alike(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray, str]:
    """Two images on one size, and what was done for it."""
    if a.shape == b.shape:
        return a, b, ""
    sizes = f"A has {a.shape[1]} × {a.shape[0]} px, B {b.shape[1]} × {b.shape[0]} px"
    if same_proportions(a, b):
        scaled = framed(b, (a.shape[1], a.shape[0]), GROUND)
        return a, scaled, f"{sizes}: B is resampled to the size of A"
    size = (max(a.shape[1], b.shape[1]), max(a.shape[0], b.shape[0]))
    note = f"their proportions differ ({sizes}): no pixel of one belongs to one of the other"
    return framed(a, size, GROUND), framed(b, size, GROUND), note


def side_by_side(both: Pair) -> np.ndarray:
    """A left, B right, a gap between them."""
    gap = np.full((both.a.shape[0], GAP_PX, 3), GROUND, dtype=np.uint8)
    return np.concatenate([both.a, gap, both.b], axis=1)
