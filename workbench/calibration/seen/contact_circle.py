"""Finding the contact in a photograph: where its difference from rest looks like a dent.

Light changes with the slope of the skin, whatever the lights are: on a matte skin in proportion,
and on a glossy one what is steep loses its highlight as well. So the change of each colour is some
a dz/dx + b dz/dy + c |grad z|^2. The slopes of a dent of radius r are known: z' = rho / r inside
and falling as (r / rho)^3 outside. At each place and radius the change is projected onto the three,
and where they explain most of its square, all colours together, there is the contact.

Near the rim of the skin one flank of a dent faces the lights and the other is dark. Its change is
therefore taken over the light at rest; and of the square of the change within a dent's own disc the
dent should explain much too, else one bright flank is taken for a small dent beside the true one.

Circles are found or drawn to a tenth of their radius. Once light and depth are known, the predicted
change is moved over the photograph until both agree best: Gauss-Newton in the shift,

    photo - predicted(x - s) = 0,   with  d predicted / d s = -grad predicted,

all colours together, in grey levels.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from workbench.calibration.seen.photo_set import Circle
from workbench.core.base.errors import DesignError

SPAN = (0.03, 0.2)
"""Radii that are looked for, over the shorter side of the image [1]."""
RADII = 16
BRIGHTEST = 250
"""Grey level from which a pixel counts as cut off: it changes no more."""
REACH = 2.2
"""Radius of the template over that of the dent [1]."""
COARSE = 8
"""Pixels that a dent's radius is drawn with: larger ones are looked for in a smaller image."""
LEAST_SHARE = 0.25
"""Share of the square of the change that a contact explains [1]. Balls pressed into a twin that
Mitsuba photographed at 160 px, in much noise, give .4 to .7; noise .005, a ramp of light .19."""
LEAST_OVER_MEDIAN, LEAST_OWN_SHARE, SURE_OVER_MEDIAN = 20.0, 0.6, 150.0
"""What a small contact in a large noisy image explains over what is explained at half of all
places, and its share of the change where it is [1]. Of 16 photographs of a finger's twin, in noise
of 2 to 7 grey levels, places that were right gave 22 to 3,450 and .77 to .87, wrong ones 8 to 88
and .41 to .55; noise, smooth or not, and ramps of light give 2 to 6. The third is enough by itself:
of 20 in less noise, of which all were right, 16 gave more."""
SEEN_RADIUS = 1.38
"""Radius of the best template over that of the circle that people draw around a contact [1],
measured on 42 photographs of a ball, standard deviation .12."""
REST_PX = 20
"""Light at rest is smoothed over the larger side of the image divided by this."""
DARK_GREY = 10.0
"""Added to the light at rest that a change is taken over: what is darker is noise."""
SMOOTHED = 0.25
"""Standard deviation by which a change is smoothed, over the least radius [1]: so noise is less."""
DISC = 2.0
"""Radius of a dent's own disc over that of the dent [1]."""
LEAST_DISC = 1e-3
"""Of all square of the change, in a disc: where nothing changed nothing is explained."""
SHIFT_STEPS = 6
MOST_SHIFT = 0.35
"""Of the circle's radius that a contact may be from its middle [1]; more is another contact."""


def relative_change(image: np.ndarray, idle: np.ndarray) -> np.ndarray:
    """Change from rest over the light at rest [1], shape (H, W, 3), float64; 0 where cut off.

    Args:
        image: Grey levels, at the exposure of rest, shape (H, W, 3).
        idle: At rest, same shape, uint8.
    """
    import cv2

    rest = idle.astype(np.float32)
    smooth = cv2.GaussianBlur(rest, (0, 0), max(idle.shape[:2]) / REST_PX)
    found = (image - rest) / (smooth + DARK_GREY)
    cut = (np.maximum(image, rest) >= BRIGHTEST).any(axis=2)
    found[cut] = 0.0
    return found


def find_circle(change: np.ndarray, name: str) -> Circle:
    """The contact in a relative change, shape (H, W, 3).

    Raises:
        DesignError: With the photograph's name, if nothing looks like a dent.
    """
    import cv2

    height, width = change.shape[:2]
    change = (change - np.median(change.reshape(-1, 3), axis=0)).astype(np.float32)
    low, high = (share * min(height, width) for share in SPAN)
    change = cv2.GaussianBlur(change, (0, 0), SMOOTHED * low)
    best = max(
        (_best_place(change, radius) for radius in np.geomspace(low, high, RADII)),
        key=lambda found: found.score,
    )
    stands_out = best.over_median >= LEAST_OVER_MEDIAN and best.own_share >= LEAST_OWN_SHARE
    stands_out |= best.over_median >= SURE_OVER_MEDIAN
    if best.share < LEAST_SHARE and not stands_out:
        raise DesignError(
            f"{name} shows no contact: the slopes of a dent explain {100 * best.share:.0f} % of "
            f"its difference from rest, less than {100 * LEAST_SHARE:.0f} %, and "
            f"{best.over_median:.0f} times as much as elsewhere, less than {LEAST_OVER_MEDIAN:.0f}",
            hint="press deeper, or write column_px, row_px and radius_px of the contact",
            at="--photos",
        )
    radius_px = best.radius_px / SEEN_RADIUS
    return Circle(column_px=best.column_px, row_px=best.row_px, radius_px=radius_px)


class _Place(NamedTuple):
    """Where a dent of one radius explains most."""

    score: float
    share: float
    """Of the change of the whole image that it explains [1]."""
    own_share: float
    """Of the change where it is."""
    over_median: float
    """What it explains over what it would at half of all places."""
    column_px: float
    row_px: float
    radius_px: float


def _best_place(change: np.ndarray, radius_px: float) -> _Place:
    """The best place of a dent of this radius."""
    import cv2

    step = max(1, int(radius_px / COARSE))
    height, width = change.shape[:2]
    small = change
    if step > 1:
        size = (width // step, height // step)
        small = cv2.resize(change, size, interpolation=cv2.INTER_AREA)
    explained, border = np.zeros(small.shape[:2]), cv2.BORDER_CONSTANT
    shapes = dent_shapes(radius_px / step)
    for shape in shapes:
        for colour in range(3):
            found = cv2.filter2D(small[..., colour], cv2.CV_32F, shape, borderType=border)
            explained += found.astype(np.float64) ** 2
    square = (small.astype(np.float64) ** 2).sum(axis=2)
    disc = _disc(shapes[0].shape[0] // 2, DISC * radius_px / step)
    within = cv2.filter2D(square.astype(np.float32), cv2.CV_32F, disc, borderType=border)
    whole = max(float(square.sum()), 1e-9)
    score = explained * np.sqrt(explained / np.maximum(within, LEAST_DISC * whole)) / whole
    row, column = np.unravel_index(int(score.argmax()), score.shape)
    most = float(explained[row, column])
    return _Place(
        score=float(score[row, column]),
        share=most / whole,
        own_share=most / max(float(within[row, column]), LEAST_DISC * whole),
        over_median=most / max(float(np.median(explained)), 1e-12),
        column_px=float((column + 0.5) * step - 0.5),
        row_px=float((row + 0.5) * step - 0.5),
        radius_px=radius_px,
    )


def _disc(reach: int, radius: float) -> np.ndarray:
    """1 within a radius of the middle of a square of (2 reach + 1)^2, float32."""
    row, column = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    return (np.hypot(column, row) <= radius).astype(np.float32)


def dent_shapes(radius_px: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Slopes of a dent along columns and rows, and their square, each of unit length, float32.

    They are at right angles to each other: the first two are odd, the last is even.
    """
    reach = int(np.ceil(REACH * radius_px))
    row, column = np.mgrid[-reach : reach + 1, -reach : reach + 1].astype(np.float64)
    away = np.hypot(column, row) / radius_px
    size = np.where(away < 1.0, away, np.maximum(away, 1.0) ** -3.0)
    size *= np.clip((REACH - away) / 0.4, 0.0, 1.0)
    # Direction times size: away is at least 1 px / radius where it is not 0.
    share = size / np.maximum(away * radius_px, 1e-9)
    along, across, square = (
        (part / np.linalg.norm(part)).astype(np.float32)
        for part in (share * column, share * row, size**2)
    )
    return along, across, square


def contact_shift(predicted: np.ndarray, taken: np.ndarray, usable: np.ndarray) -> np.ndarray:
    """Shift along columns and rows [sample] that brings a prediction onto a photograph.

    Args:
        predicted: Change of grey levels on a regular grid, shape (H, W, 3).
        taken: The photograph's, same shape.
        usable: Where neither is cut off, same shape, bool.
    """
    from scipy import ndimage

    shift = np.zeros(2)
    for _ in range(SHIFT_STEPS):
        moved = np.stack(
            [
                ndimage.shift(predicted[..., c], shift[::-1], order=1, mode="nearest")
                for c in range(3)
            ],
            axis=-1,
        )
        right, down = (np.gradient(moved, axis=axis)[usable] for axis in (1, 0))
        rows = -np.column_stack([right, down])
        square = rows.T @ rows
        if np.linalg.cond(square) > 1e6:
            break
        step = np.linalg.solve(square, rows.T @ (taken - moved)[usable])
        shift += step
        if np.abs(step).max() < 0.01:
            break
    return shift
