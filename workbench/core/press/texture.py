"""A pattern raised on the side of an object that meets the skin, as a height field.

Every pattern is made of ridges or bumps with a raised-cosine flank, H cos^2(pi u / 2 R) at a
distance u < R from the crest, so its steepest slope is pi H / 2 R. R is a share of the pitch.
What a height field cannot be: undercut. What the sampled distance cannot hold: flanks beyond
`STEEPEST`, and features narrower than `sim.contact.objects.textures.LEAST_FEATURE_SAMPLES`.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass

import numpy as np

from workbench.core.base.check import expect, within
from workbench.core.base.errors import DesignError, shown


class Pattern(enum.StrEnum):
    """What is raised."""

    NONE = "none"
    """Nothing: the smooth shape."""
    GRID = "grid"
    """Ridges along X and along Y, one per pitch."""
    DOTS = "dots"
    """Round bumps on a square lattice, one per pitch."""
    WAVES = "waves"
    """A cosine along X; crests run along Y."""
    LETTERS = "letters"
    """A line of text about the centre; the pitch is the height of a capital."""
    IMAGE = "image"
    """A greyscale picture, white is high; the pitch is its width on the object."""


FLANK_SHARES = {
    Pattern.GRID: 0.3,
    Pattern.DOTS: 0.4,
    Pattern.WAVES: 0.5,
    Pattern.LETTERS: 0.16,
}
"""Half width R of a ridge or bump, over the pitch."""
STEEPEST = 1.5
"""Steepest slope [1]; 56 degrees. A soft skin does not follow steeper flanks."""
LONGEST_TEXT = 12


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class HeightImage:
    """A picture as heights; compared by identity."""

    heights: np.ndarray
    """Shares of the texture's height, shape (rows, columns), float64 in [0, 1], top row first."""

    def __post_init__(self) -> None:
        expect(self.heights, "R C", name="texture image")
        if min(self.heights.shape) < 2:
            raise DesignError(
                f"the texture image has {self.heights.shape} pixels, at least 2 x 2 are needed",
                hint="give a greyscale picture",
                at="indenter.texture.image",
            )


@dataclass(frozen=True, kw_only=True, slots=True)
class Texture:
    """A height field over body X and Y."""

    pattern: Pattern = Pattern.NONE
    height_mm: float = 0.2
    """Crest above valley [mm]; the valleys are the smooth shape."""
    pitch_mm: float = 2.0
    """Period [mm]; of letters the height of a capital, of an image its width."""
    text: str = ""
    """What the letters say; reads rightly as the camera sees it, looking along body +Z."""
    image: HeightImage | None = None

    def __post_init__(self) -> None:
        if not self.raised:
            return
        at = "indenter.texture"
        within(self.height_mm, 0.0, 5.0, what="texture height", unit="mm", at=f"{at}.height_mm")
        within(self.pitch_mm, 0.1, 100.0, what="texture pitch", unit="mm", at=f"{at}.pitch_mm")
        if self.slope > STEEPEST:
            least = self.pitch_mm * self.slope / STEEPEST
            highest = self.height_mm * STEEPEST / self.slope
            raise DesignError(
                f"{self.pattern} {self.height_mm:g} mm high with a pitch of {self.pitch_mm:g} mm "
                f"rise with a slope of {self.slope:.2f}; the limit is {STEEPEST:g}",
                hint=f"raise the pitch to {least:.2f} mm or lower the height to {highest:.3f} mm",
                at=f"{at}.height_mm",
            )
        if self.pattern is Pattern.LETTERS:
            self._check_text()
        if (self.pattern is Pattern.IMAGE) != (self.image is not None):
            raise DesignError(
                f"texture {self.pattern} {'needs an' if self.image is None else 'takes no'} image",
                hint="give the path of a greyscale picture, or choose another pattern",
                at=f"{at}.image",
            )

    @property
    def raised(self) -> bool:
        """Whether there is anything on the shape."""
        return self.pattern is not Pattern.NONE

    @property
    def flank_mm(self) -> float:
        """Half width of a ridge or bump [mm]; infinite for an image, whose detail is filtered."""
        return self.pitch_mm * FLANK_SHARES.get(self.pattern, math.inf)

    @property
    def slope(self) -> float:
        """Steepest slope [1]; 0 for an image, which is judged when it is sampled."""
        return math.pi * self.height_mm / (2.0 * self.flank_mm)

    def _check_text(self) -> None:
        fits = 0 < len(self.text) <= LONGEST_TEXT
        if not fits or not all(" " <= c <= "~" for c in self.text) or not self.text.strip():
            raise DesignError(
                f"the texture says {shown(self.text)}; it takes 1 to {LONGEST_TEXT} plain "
                "characters",
                hint="use letters, digits and punctuation of ASCII",
                at="indenter.texture.text",
            )


SMOOTH = Texture()
"""No texture."""
