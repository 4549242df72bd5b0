"""What a sensor as it was drawn would show of a touch that the one built from it photographed.

A learned reader knows light and camera of one design. The sensor that was built has others, and its
calibration says which. Each pixel of the drawn camera sees a place of the skin that the built one
sees elsewhere (`SamePlaces`). What light comes from there follows from the tilt t of the skin
(`TiltLight`): l in the built sensor, l' in the drawn one, with exposures E and E'. Of each pixel
that tilt is found which explains the change c of its display light,

    min over t of  |E (l(t) - l(0)) - c|^2 / s^2  +  |t|^2 / T^2,

by Gauss-Newton (a photometric inversion with a prior: Woodham, 1980), and the drawn one changes by

    E' (l'(t) - l'(0))  +  SHARE g (c - E (l(t) - l(0))),

g how much brighter the place is drawn than built. What no tilt explains is the shadow of a dent,
which a reader makes use of, and what a calibration leaves, which misleads it. Colours that are
black or saturated take no part. What the built sensor's unit file adds is left in c.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from workbench.reading.same_places import SURELY, SamePlaces

if TYPE_CHECKING:
    # It needs the device that reading opens.
    from sim.reading.untouched import Untouched

LIGHT_SIGMA = 1.5 / 255.0
"""s: of what light by tilt does not know, in display light."""
TILT_SIGMA = 0.5
"""T."""
STEPS, FARTHEST, STEEPEST = 4, 0.25, 0.8
"""Of Gauss-Newton; largest change of a tilt in one, and largest tilt."""
SHARE = 0.75
"""In the calibrated twins of finger and pad readings are .088 and .060 mm off with it, .092 and
.061 with 1, .089 and .072 with .5, on the pad .086 with 0."""
LEAST_LIGHT, BRIGHTER = 1e-6, (1.0 / 3.0, 3.0)
"""Display light by which brightness is divided at least, and range of g: in a corner that is nearly
black all is noise."""


class Relight:
    """Photographs of one built sensor as its design was drawn."""

    def __init__(self, built: Untouched, drawn: Untouched) -> None:
        """Prepare.

        Args:
            built: The calibrated sensor and its photograph at rest.
            drawn: The design as it was drawn and its image at rest; its skin is the same.
        """
        self._built, self._drawn = built, drawn
        self.places = SamePlaces.of(drawn, built)
        pixels = np.flatnonzero(self.places.seen)
        corners, weights = drawn.skin.faces[drawn.sight.face[pixels]], drawn.sight.weights[pixels]
        self._pixels = pixels
        self._vertex = corners[np.arange(len(pixels)), weights.argmax(axis=1)]
        """The nearest of each pixel that both see."""
        built_grey = self.places.brought(built.idle).reshape(-1, 3)
        self._built_light = _light(built_grey, built)
        per_radiance = (built.through[:, None] * built.exposure).reshape(*built.shape, 3)
        self._exposure = self.places.brought(per_radiance).reshape(-1, 3)[pixels].astype(np.float64)
        self._drawn_exposure = drawn.exposure[pixels] * drawn.through[pixels, None]
        level = np.zeros((len(pixels), 2))
        self._level = built.light.at(self._vertex, level)
        self._drawn_level = drawn.light.at(self._vertex, level)
        brightness = (self._exposure * self._level).sum(axis=1)
        drawn_brightness = (self._drawn_exposure * self._drawn_level).sum(axis=1)
        self._brighter = np.clip(drawn_brightness / np.maximum(brightness, LEAST_LIGHT), *BRIGHTER)

    def photo(self, photo: np.ndarray) -> np.ndarray:
        """A photograph of the built sensor as the drawn one would show it, (H, W, 3), float32.

        Args:
            photo: Grey levels, of the size of the built one's photograph at rest, uint8.
        """
        from sim.optics.raster.display import shown
        from sim.reading.changed import change

        built, drawn = self._built, self._drawn
        seen = change(built.idle, photo, built.sees.reshape(built.shape))
        touched = self.places.brought(seen.near).ravel()[self._pixels] > 0.0
        there = self.places.brought(seen.photo).reshape(-1, 3)
        told = self._told(photo)
        changed = told * (_light(there, built) - self._built_light)[self._pixels]
        drawn_change = np.zeros_like(changed)
        explained = np.zeros_like(changed)
        rows = np.flatnonzero(touched)
        tilts = self._tilts(changed[rows], told[rows], rows)
        vertex = self._vertex[rows]
        explained[rows] = self._exposure[rows] * (built.light.at(vertex, tilts) - self._level[rows])
        drawn_change[rows] = self._drawn_exposure[rows] * (
            drawn.light.at(vertex, tilts) - self._drawn_level[rows]
        )
        drawn_change += SHARE * self._brighter[:, None] * told * (changed - explained)
        light = drawn.idle_light.copy()
        light[self._pixels] += drawn_change
        grey = 255.0 * shown(light, drawn.sensor)
        return grey.reshape(*drawn.shape, 3).astype(np.float32)

    def _told(self, photo: np.ndarray) -> np.ndarray:
        """1 where a colour says something, else 0, shape (n, 3), of the pixels that both see.

        All of the pixels around a place have to.
        """
        from sim.reading.photo_view import BLACK_GREY, WHITE_GREY

        dark, bright = (limit(photo, self._built.idle) for limit in (np.minimum, np.maximum))
        tells = (dark > BLACK_GREY) & (bright < WHITE_GREY)
        shares = self.places.brought(tells.astype(np.float32)).reshape(-1, 3)[self._pixels]
        return (shares > SURELY).astype(np.float64)

    def _tilts(self, changed: np.ndarray, told: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Tilts that explain changes of display light of some pixels (n,), shape (n, 2).

        Args:
            changed: Of the colours, shape (n, 3).
            told: 1 where one says something, else 0, shape (n, 3).
            rows: Of the pixels that both see, which.
        """
        light, vertex, exposure = self._built.light, self._vertex[rows], self._exposure[rows]
        tilts = np.zeros((len(rows), 2))
        for _ in range(STEPS):
            weight = told / LIGHT_SIGMA
            slopes = (weight * exposure)[:, :, None] * light.slopes(vertex, tilts)
            left = changed - exposure * (light.at(vertex, tilts) - self._level[rows])
            step = _least_squares(slopes, weight * left, tilts)
            tilts = _no_longer(tilts + _no_longer(step, FARTHEST), STEEPEST)
        return tilts


def _least_squares(slopes: np.ndarray, left: np.ndarray, tilts: np.ndarray) -> np.ndarray:
    """A step of Gauss-Newton with the prior, shape (n, 2), for slopes (n, 3, 2) of what is left,
    (n, 3), both over their standard deviation."""
    held = 1.0 / TILT_SIGMA**2
    one, two = slopes[:, :, 0], slopes[:, :, 1]
    a = np.einsum("nc,nc->n", one, one) + held
    b = np.einsum("nc,nc->n", one, two)
    d = np.einsum("nc,nc->n", two, two) + held
    p = np.einsum("nc,nc->n", one, left) - held * tilts[:, 0]
    q = np.einsum("nc,nc->n", two, left) - held * tilts[:, 1]
    return np.column_stack([d * p - b * q, a * q - b * p]) / (a * d - b * b)[:, None]


def _no_longer(vectors: np.ndarray, most: float) -> np.ndarray:
    """Vectors (n, 2), shortened to a length."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors * np.minimum(1.0, most / np.maximum(length, 1e-12))


def _light(grey: np.ndarray, of: Untouched) -> np.ndarray:
    """Display light of grey levels (N, 3), float64."""
    from sim.optics.raster.display import light_of

    return light_of(np.clip(grey.astype(np.float64) / 255.0, 0.0, 1.0), of.sensor)
