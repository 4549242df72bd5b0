"""Exposure and white balance that drift from photo to photo, told by skin that nothing touched.

Many cameras choose both anew for each photograph, and show it in the whole image: grey levels of
untouched skin are those at rest times a gain plus an offset, colour by colour. What a contact
changes is then looked for in the photograph with that taken back, and so is the contact itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from workbench.calibration.seen.contact_circle import MOST_SHIFT, find_circle, relative_change
from workbench.calibration.seen.photo_set import FEWEST, BallPhoto, Circle, PhotoSet
from workbench.core.base.errors import DesignError

Place = TypeVar("Place")
FEWEST_SHARE = 2 / 3
"""Of the photographs to fit to that must show a contact: else they are of something else."""
BEYOND = 2.3
"""Skin is untouched beyond this many radii of the contact's circle [1]."""
FEWEST_PX = 500
"""Untouched pixels that tell a gain and an offset; with fewer, only the offset, or nothing."""
MILD = 0.5
"""Prior: a gain of 1 with this standard deviation times 255 grey levels' worth of offset [1]."""
CUT_OFF = 252
"""Grey level from which a colour may have been cut off."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Drift:
    """Grey levels of a photograph of untouched skin: gain times those at rest plus offset."""

    gain: np.ndarray
    """Shape (3,)."""
    offset: np.ndarray
    """[grey level], shape (3,)."""

    def applied(self, grey: np.ndarray) -> np.ndarray:
        """What an image (H, W, 3) at rest's exposure is in the photograph's."""
        return grey * self.gain + self.offset

    def taken_back(self, grey: np.ndarray) -> np.ndarray:
        """What an image (H, W, 3) at the photograph's exposure is in rest's, float64."""
        return (grey - self.offset) / self.gain


NO_DRIFT = Drift(gain=np.ones(3), offset=np.zeros(3))


def untouched(shape: tuple[int, ...], circle: Circle) -> np.ndarray:
    """Pixels that a contact leaves alone, shape (H, W), bool."""
    row, column = np.ogrid[: shape[0], : shape[1]]
    away = np.hypot(column - circle.column_px, row - circle.row_px)
    return away > BEYOND * circle.radius_px


def measured_drift(image: np.ndarray, idle: np.ndarray, circle: Circle) -> Drift:
    """The drift of a photograph (H, W, 3) from the one at rest.

    Least squares in two rounds, the second without the tenth that fits worst: dirt, the rim.
    """
    far = untouched(image.shape, circle)
    gain, offset = np.ones(3), np.zeros(3)
    if far.sum() < FEWEST_PX:
        return NO_DRIFT
    for colour in range(3):
        use = far & (image[..., colour] < CUT_OFF) & (idle[..., colour] < CUT_OFF)
        if use.sum() < FEWEST_PX:
            continue
        rest = idle[..., colour][use].astype(np.float64)
        now = image[..., colour][use].astype(np.float64)
        kept = np.ones(len(rest), dtype=bool)
        for _ in range(2):
            gain[colour], offset[colour] = _line(rest[kept], now[kept])
            error = np.abs(gain[colour] * rest + offset[colour] - now)
            kept = error <= np.quantile(error, 0.9)
    return Drift(gain=gain, offset=offset)


def _line(rest: np.ndarray, now: np.ndarray) -> tuple[float, float]:
    """Gain and offset; the gain stays near 1 where the image at rest is too even to tell."""
    mean_rest, mean_now = rest.mean(), now.mean()
    spread = float(((rest - mean_rest) ** 2).mean())
    together = float(((rest - mean_rest) * (now - mean_now)).mean())
    # One grey level of noise against a gain that is mild: a ridge of (1 / MILD)^2 grey levels^2.
    ridge = 1.0 / MILD**2
    gain = (together + ridge) / (spread + ridge)
    return gain, float(mean_now - gain * mean_rest)


@dataclass(frozen=True, kw_only=True, slots=True)
class SeenPhoto:
    """A photograph with what was found in it."""

    photo: BallPhoto
    circle: Circle
    drift: Drift

    @property
    def at_rest(self) -> np.ndarray:
        """Grey levels at rest's exposure, shape (H, W, 3), float64."""
        return self.drift.taken_back(self.photo.image)


@dataclass(frozen=True, kw_only=True, slots=True)
class LeftOut:
    """A photograph in which no contact was found, or none on the skin."""

    photo: str
    why: str


def seen_photos(
    photos: PhotoSet, located: Callable[[Circle, BallPhoto], Place]
) -> tuple[list[tuple[SeenPhoto, Place]], list[LeftOut]]:
    """The photographs that show a contact, with its place on the skin, and those that do not.

    A weak photograph among good ones is left out. Contacts that were given are not doubted.

    Args:
        photos: The set.
        located: Where on the skin the contact of a photograph is, seen as a circle.

    Raises:
        DesignError: With the photograph's name: if a contact that was given is not on the skin, or
            the first one without a contact if so many are left out that `FEWEST` or two thirds of
            those to fit to do not remain.
    """
    seen, left_out, first = list[tuple[SeenPhoto, Place]](), list[LeftOut](), None
    for photo in photos.photos:
        try:
            found = seen_photo(photo, photos.idle)
            seen.append((found, located(found.circle, photo)))
        except DesignError as error:
            if photo.circle is not None:
                raise
            first = first or error
            left_out.append(LeftOut(photo=photo.name, why=error.message))
    fitted = sum(not each.photo.held_out for each, _ in seen)
    if first is not None and fitted < max(FEWEST, FEWEST_SHARE * len(photos.fitted)):
        raise first
    return seen, left_out


def seen_photo(photo: BallPhoto, idle: np.ndarray) -> SeenPhoto:
    """Where the contact is and how the exposure drifted, looked for where it is not given."""
    circle, drift = seen_contact(photo.name, photo.image, idle, photo.circle)
    return SeenPhoto(photo=photo, circle=circle, drift=drift)


def seen_contact(
    name: str, image: np.ndarray, idle: np.ndarray, circle: Circle | None
) -> tuple[Circle, Drift]:
    """A contact and the drift about it: each is looked for without the other.

    Args:
        name: Of the photograph.
        image: Shape (H, W, 3), uint8.
        idle: At rest, same shape.
        circle: The contact, if it is known.

    Raises:
        DesignError: With the photograph's name, if nothing looks like a contact.
    """
    if circle is not None:
        return circle, measured_drift(image, idle, circle)
    circle = find_circle(relative_change(image.astype(np.float64), idle), name)
    drift = measured_drift(image, idle, circle)
    circle = find_circle(relative_change(drift.taken_back(image), idle), name)
    return circle, measured_drift(image, idle, circle)


def shifted(seen: SeenPhoto, shift_px: np.ndarray, idle: np.ndarray) -> SeenPhoto:
    """A photograph with its contact elsewhere, if that is the same contact."""
    circle, (height, width) = seen.circle, idle.shape[:2]
    if not np.hypot(*shift_px) <= MOST_SHIFT * circle.radius_px:
        return seen
    moved = Circle(
        column_px=float(np.clip(circle.column_px + shift_px[0], 0, width - 1)),
        row_px=float(np.clip(circle.row_px + shift_px[1], 0, height - 1)),
        radius_px=circle.radius_px,
    )
    drift = measured_drift(seen.photo.image, idle, moved)
    return SeenPhoto(photo=seen.photo, circle=moved, drift=drift)
