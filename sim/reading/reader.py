"""Reading touch from photographs of one camera of one design, without training.

The unknown is the inward displacement of the skin's vertices; what explains the difference between
two photographs best is found by Gauss-Newton (`fit`), with the design's own light in the loop.
First the light of the tilts alone is asked from several guesses, then the renderer from the best.
"""

from __future__ import annotations

import dataclasses
import functools
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sim.reading.changed import Change, change
from sim.reading.deviation import deviations_mm
from sim.reading.fit import LEVELS, Fitted, Prediction, Priors, fitted
from sim.reading.noise import Noise
from sim.reading.patch import Patch
from sim.reading.photo_view import PhotoView
from sim.reading.pixel_maps import SUREST, TOUCHED_MM, pressed
from sim.reading.rest_skin import bending, neighbours
from sim.reading.sight import Sight
from sim.reading.untouched import Untouched

STARTS_MM = (0.3, 0.8, 1.5)
"""Heights of the domes that are tried as a first guess where the photograph changed: skin is
pressed in, and near rest all tilts of a finger may look alike."""
START_BLUR_PX = 2.0
EXPLAINED, PLAIN = 0.3, 1.5
"""Share of the misfit of an untouched skin, and misfit, up to which no other start is tried."""
OWN_SHARE, OWN_MM = 0.02, 2e-3
"""Standard deviation of what a reading leaves out, over the depth and beside it [mm]: skin moves
sideways too. Of 16 readings of pressed balls, .2 to 1 mm deep in pad and finger, without noise and
with 1 grey of it, 60 % of the errors are then within one standard deviation (10 to 97 %)."""
LEFT = 2.0
"""Factor on that of a built sensor, whose unit is known: the fit knows noise and the error of the
light at rest, not what a calibration leaves. Of the errors in calibrated twins .37 in a pad's and
.43 in a finger's are within one without it, .64 and .72 with it."""
FEWEST_PIXELS = 5
"""Changed pixels below which nothing was touched."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Touch:
    """What a photograph says of the skin's V vertices."""

    inward_mm: np.ndarray
    """Displacement along the inward normal at rest, shape (V,); 0 where nothing changed."""
    sigma_mm: np.ndarray
    """Its standard deviation, shape (V,); 0 where nothing changed, NaN where skin may have moved
    that the camera does not see."""
    misfit: float
    """Root mean square of residual over noise [1]: 1 where the light explains the photograph."""
    noise_grey: float
    steps: int
    """Of the last fit."""
    seconds: float
    sight: Sight
    """What the pixels see of the moved skin."""
    contact: np.ndarray | None = None
    """Vertices that are surely pressed in, shape (V,), bool; None where displacement and deviation
    are all that is known."""


class Reader:
    """Reads photographs of one sensor."""

    def __init__(self, rest: Untouched) -> None:
        from scipy.sparse import csc_matrix, diags
        from threadpoolctl import ThreadpoolController

        self.rest = rest
        # Factors of a millisecond: threads that wait for each other on a busy machine took 80.
        self._libraries = ThreadpoolController()
        self._bent = csc_matrix(diags(np.sqrt(rest.skin.shares_mm2)) @ bending(rest.skin))
        self._neighbours = neighbours(rest.skin)

    @functools.cached_property
    def rest_maps(self) -> np.ndarray:
        """Depth, its deviation, contact and inward unit normal that the pixels see at rest, shape
        (N, 6), float32; NaN where they see no skin."""
        rest = self.rest
        sees = np.flatnonzero(rest.sees)
        found = np.full((len(rest.sees), 6), np.nan, np.float32)
        seen = rest.sight.blended(rest.skin.inward, rest.skin.faces, sees)
        found[sees, :3] = 0.0
        found[sees, 3:] = seen / np.linalg.norm(seen, axis=1, keepdims=True)
        return found

    def read(self, photo: np.ndarray, start: Touch | None = None) -> Touch:
        """What a photograph (H, W, 3) [grey] of the touched sensor says.

        Args:
            photo: Of the size of the one at rest.
            start: What an image just before it said: then only details are sought.
        """
        begun = time.perf_counter()
        seen = change(self.rest.idle, photo, self.rest.sees.reshape(self.rest.shape))
        free, calm = self._moving(seen, start)
        if np.count_nonzero(seen.certain) >= FEWEST_PIXELS and free.any():
            with self._libraries.limit(limits=1, user_api="blas"):
                found = self._touch(seen, (free, calm), start)
        else:
            found = self._untouched(seen)
        return dataclasses.replace(found, seconds=time.perf_counter() - begun)

    def _untouched(self, seen: Change) -> Touch:
        count = self.rest.skin.count
        return Touch(
            inward_mm=np.zeros(count),
            sigma_mm=np.zeros(count),
            misfit=0.0,
            noise_grey=seen.noise.grey,
            steps=0,
            seconds=0.0,
            sight=self.rest.sight,
            contact=np.zeros(count, dtype=bool),
        )

    def _touch(
        self, seen: Change, moving: tuple[np.ndarray, np.ndarray], start: Touch | None
    ) -> Touch:
        """What moved, of vertices that may and of those that look at rest, (V,) bool each."""
        free, calm = moving
        patch = Patch(self.rest.skin, free)
        chosen = patch.vertices[: patch.free]
        view = PhotoView(self.rest, patch, seen)
        fit = _Fit(patch=patch, priors=self._priors(chosen, calm), view=view, noise=seen.noise)
        found = self._fitted(fit, seen, start)
        by_noise_mm, by_light_mm = deviations_mm(
            found.linear, view.noise_errors(found.seen, seen.noise), view.light_errors(found.seen)
        )
        inward_mm, doubt_mm, sigma_mm = np.zeros((3, self.rest.skin.count))
        inward_mm[chosen] = found.inward_mm
        doubt_mm[chosen] = np.hypot(by_noise_mm, OWN_MM)
        growing_mm = np.hypot(by_light_mm, OWN_SHARE * found.inward_mm)
        left = 1.0 if self.rest.unit is None else LEFT
        sigma_mm[chosen] = left * np.hypot(doubt_mm[chosen], growing_mm)
        sight = found.seen.sight
        hidden = free & ~self.seen(sight)
        doubt_mm[hidden] = sigma_mm[hidden] = np.nan
        changed = (free & ~calm) | self._shown(sight, seen.certain)
        return Touch(
            inward_mm=inward_mm,
            sigma_mm=sigma_mm,
            misfit=found.misfit,
            noise_grey=seen.noise.grey,
            steps=found.steps,
            seconds=0.0,
            sight=sight,
            contact=self._contacts(inward_mm, doubt_mm, changed),
        )

    def displaced_mm(self, touch: Touch) -> np.ndarray:
        """Displacement of the vertices [mm], shape (V, 3)."""
        return touch.inward_mm[:, None] * self.rest.skin.inward

    def seen(self, sight: Sight) -> np.ndarray:
        """Vertices that some pixel sees, shape (V,), bool."""
        return self._shown(sight, np.ones_like(self.rest.sees))

    def _shown(self, sight: Sight, pixels: np.ndarray) -> np.ndarray:
        """Vertices that some of these pixels see, (V,), bool."""
        shown = np.zeros(self.rest.skin.count, dtype=bool)
        sees = self.rest.sees & (sight.face >= 0) & pixels.ravel()
        shown[self.rest.skin.faces[sight.face[sees]]] = True
        return shown

    def _contacts(
        self, inward_mm: np.ndarray, doubt_mm: np.ndarray, changed: np.ndarray
    ) -> np.ndarray:
        """Vertices that are surely pressed in, (V,), bool: patches of them whose colour changed.

        What grows with the depth read, as light that is off, makes no contact doubtful.
        """
        from scipy.sparse.csgraph import connected_components

        deep = np.flatnonzero(pressed(inward_mm, doubt_mm))
        _, patch = connected_components(self._neighbours[deep][:, deep], directed=False)
        surest = changed[deep] & (inward_mm[deep] > SUREST * doubt_mm[deep])
        found = np.zeros(len(inward_mm), dtype=bool)
        found[deep] = np.isin(patch, patch[surest])
        return found

    def _moving(self, seen: Change, start: Touch | None) -> tuple[np.ndarray, np.ndarray]:
        """Vertices that may move, and those that look at rest, (V,) bool each."""
        import cv2

        rest = self.rest
        corners = rest.skin.faces[np.maximum(rest.sight.face, 0)]
        free = np.zeros(rest.skin.count, dtype=bool)
        free[corners[rest.sees & seen.near.ravel()]] = True
        if start is not None:
            # Not all that may have moved then: in a video the patch would grow without end.
            free |= start.inward_mm > TOUCHED_MM
        free |= (self._neighbours @ free.astype(np.float64)) > 0.0
        wider = cv2.dilate(seen.certain.astype(np.uint8), np.ones((3, 3))) > 0
        calm = free.copy()
        calm[corners[rest.sees & wider.ravel()]] = False
        return free, calm

    def _priors(self, chosen: np.ndarray, calm: np.ndarray) -> Priors:
        """What is believed of the free vertices (m,)."""
        bent = self._bent[:, chosen]
        return Priors(
            bent=bent[np.unique(bent.indices)].tocsr(),
            area_mm2=self.rest.skin.shares_mm2[chosen],
            calm=calm[chosen],
        )

    def _fitted(self, fit: _Fit, seen: Change, start: Touch | None) -> Fitted:
        """The fit from the guess that explains most."""
        chosen = fit.patch.vertices[: fit.patch.free]
        nothing = fit.view.untouched().misfit(seen.noise)
        enough = max(EXPLAINED * nothing, PLAIN)
        if start is not None:
            # The patch was drawn at the end of the last reading, but for what is let go since.
            begun_mm = start.inward_mm[chosen]
            found = fit.from_seen(begun_mm, fit.view.seen(begun_mm, start.sight))
            if found.misfit < enough:
                return found
        dome = self._dome(seen, chosen)
        guesses: list[Fitted] = []
        for top_mm in STARTS_MM:
            guesses.append(fit.rough(top_mm * dome))
            if guesses[-1].misfit < enough:
                break
        tried: list[Fitted] = []
        for guess in sorted(guesses, key=lambda each: each.misfit):
            # What the light by tilt alone cannot tell apart, shadows may.
            tried.append(fit.fine(guess.inward_mm))
            if tried[-1].misfit < enough:
                break
        return min(tried, key=lambda each: each.misfit)

    def _dome(self, seen: Change, chosen: np.ndarray) -> np.ndarray:
        """A dome of height 1 over the changed pixels, shape (m,)."""
        import cv2

        rest = self.rest
        away_px = cv2.distanceTransform(seen.certain.astype(np.uint8), cv2.DIST_L2, 5)
        dome = (1.0 - (1.0 - away_px / max(float(away_px.max()), 1.0)) ** 2).astype(np.float32)
        dome = cv2.GaussianBlur(dome, (0, 0), START_BLUR_PX).ravel()
        at = rest.skin.faces[rest.sight.face[rest.sees]].ravel()
        total = np.bincount(at, np.repeat(dome[rest.sees], 3), minlength=rest.skin.count)
        return (total / np.maximum(np.bincount(at, minlength=rest.skin.count), 1))[chosen]


@dataclass(frozen=True, kw_only=True, slots=True)
class _Fit:
    """What is fitted to what."""

    patch: Patch
    priors: Priors
    view: PhotoView
    noise: Noise

    def rough(self, start_mm: np.ndarray) -> Fitted:
        """By the light of the tilts alone: smooth, forgiving, and quick."""
        return self._by(self.view.tabled, (start_mm, self.view.tabled(start_mm)), LEVELS[:-1])

    def fine(self, start_mm: np.ndarray) -> Fitted:
        """With the renderer in the loop: shadows, and what the camera sees of moved skin."""
        return self.from_seen(start_mm, self.view.rendered(start_mm))

    def from_seen(self, start_mm: np.ndarray, seen: Prediction) -> Fitted:
        """The same from a guess of which it is known what it shows."""
        return self._by(self.view.rendered, (start_mm, seen), LEVELS[-1:])

    def _by(
        self,
        predict: Callable[[np.ndarray], Prediction],
        start: tuple[np.ndarray, Prediction],
        levels: tuple[float, ...],
    ) -> Fitted:
        return fitted(self.patch, self.priors, predict, start, noise=self.noise, levels=levels)
