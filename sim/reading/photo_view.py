"""One photograph's pixels about one patch of the skin: what it shows, and what it would show."""

from __future__ import annotations

import numpy as np

from sim.optics.raster.display import shown
from sim.reading.block_errors import BlockErrors
from sim.reading.changed import Change
from sim.reading.fit import Prediction
from sim.reading.noise import Noise
from sim.reading.patch import Patch, Posed
from sim.reading.pixels import Slopes
from sim.reading.sight import Sight, moved
from sim.reading.untouched import Untouched

BLOCKS = 4.0
"""Blocks of pixels for each free vertex, at most; larger images are fitted by means of blocks."""
BLACK_GREY, WHITE_GREY = 0.5, 253.5
"""Grey levels that say nothing more."""
LIGHT_STEP = 1e-3
"""Of the slope of the display's curve."""
LEAST_LIGHT = 1e-4
"""Of a prediction: at none the curve of a sensor with a gamma has no slope."""


class PhotoView:
    """p pixels in P blocks; what a block shows is the mean of its pixels."""

    def __init__(self, rest: Untouched, patch: Patch, seen: Change) -> None:
        """Choose the pixels.

        Args:
            rest: The untouched sensor.
            patch: What may move.
            seen: How the photograph differs.
        """
        self._rest, self._patch = rest, patch
        self._local = np.full(len(rest.skin.faces) + 1, -1)
        self._local[patch.triangles] = np.arange(len(patch.triangles))
        # Every pixel that sees a free vertex must speak: a rim that no pixel holds sinks, and takes
        # the dent with it.
        self._pixels = np.flatnonzero(rest.sees & (self._local[rest.sight.face] >= 0))
        edge = max(1, int(np.sqrt(len(self._pixels) / (BLOCKS * max(patch.free, 1)))))
        row, column = np.divmod(self._pixels, rest.shape[1])
        block = (row // edge) * rest.shape[1] + column // edge
        _, lead, self._block = np.unique(block, return_index=True, return_inverse=True)
        photo = seen.photo.reshape(-1, 3)[self._pixels]
        self._trusted = ((photo > BLACK_GREY) & (photo < WHITE_GREY)).astype(np.float64)
        self._lead = self._pixels[lead]
        """First pixel of each block, shape (P,)."""
        self._errors = BlockErrors(row[lead] // edge, column[lead] // edge, edge)
        self._told = self._summed(self._trusted)
        self._photo = self._mean(photo)
        self._idle = self._mean(rest.idle.reshape(-1, 3)[self._pixels])
        self._idle_light = self._mean(rest.idle_light[self._pixels])
        self._exposure = rest.exposure[self._pixels]
        level = np.zeros((patch.count, 2))
        self._level_light = rest.light.at(patch.vertices, level)
        """Of the vertices at rest, by the light of the tilts, shape (n, 3)."""

    def noise_errors(self, seen: Prediction, noise: Noise) -> np.ndarray:
        """Draws of what blocks are off by, whatever they show [grey], shape (P, 3, DRAWS)."""
        return self._errors.noise(seen.residual, self._told, noise)

    def light_errors(self, seen: Prediction) -> np.ndarray:
        """Draws of what blocks are off by as far as they changed [grey], shape (P, 3, DRAWS)."""
        changed = self._photo - seen.residual - self._idle
        return self._errors.light(changed, self._rest.light_error)

    def untouched(self) -> Prediction:
        """What the patch shows at rest."""
        still = self._patch.posed(np.zeros(self._patch.free))
        return self._prediction(still, self._rest.sight, np.zeros_like(self._photo))

    def rendered(self, inward_mm: np.ndarray) -> Prediction:
        """What the renderer shows of the patch moved by (m,) [mm]."""
        rest, patch = self._rest, self._patch
        displacement_mm = np.zeros((rest.skin.count, 3))
        chosen = patch.vertices[: patch.free]
        displacement_mm[chosen] = inward_mm[:, None] * patch.inward[: patch.free]
        return self.seen(inward_mm, moved(rest.studio, rest.sight, displacement_mm))

    def seen(self, inward_mm: np.ndarray, sight: Sight) -> Prediction:
        """The same of a patch that the renderer has drawn: what the pixels see of it is known."""
        pixels = self._pixels
        change = self._exposure * (sight.light[pixels] - self._rest.sight.light[pixels])
        return self._prediction(self._patch.posed(inward_mm), sight, self._mean(change))

    def tabled(self, inward_mm: np.ndarray) -> Prediction:
        """What the light by tilt makes of it, where the pixels look at rest."""
        rest, patch, lead = self._rest, self._patch, self._lead
        sight, light, posed = rest.sight, rest.light, patch.posed(inward_mm)
        brought = light.at(patch.vertices, posed.tilts) - self._level_light
        corners = patch.faces[self._local[sight.face[lead]]]
        change = np.einsum("pk,pkc->pc", sight.weights[lead], brought[corners])
        shown_there = rest.exposure[lead] * rest.through[lead, None]
        return self._prediction(posed, sight, change * shown_there)

    def _prediction(self, posed: Posed, sight: Sight, change: np.ndarray) -> Prediction:
        """From the change of display light (P, 3)."""
        light = np.clip(self._idle_light + change, LEAST_LIGHT, 1.0)
        grey = 255.0 * shown(light, self._rest.sensor) + self._unit_grey(sight, posed.normals)
        left = np.where(self._told > 0.0, self._photo - grey, 0.0)
        return Prediction(
            residual=left,
            told=self._told,
            posed=posed,
            sight=sight,
            slopes=lambda: self._slopes(posed, sight, light),
        )

    def _slopes(self, posed: Posed, sight: Sight, light: np.ndarray) -> Slopes:
        rest, patch, lead = self._rest, self._patch, self._lead
        ahead = 255.0 * shown(light + LIGHT_STEP, rest.sensor)
        behind = 255.0 * shown(light - LIGHT_STEP, rest.sensor)
        curve = (ahead - behind) / (2.0 * LIGHT_STEP)
        return Slopes(
            faces=patch.faces,
            triangles=self._local[sight.face[lead]],
            corner_weights=sight.weights[lead],
            grey=curve * rest.exposure[lead] * rest.through[lead, None],
            light=rest.light.slopes(patch.vertices, posed.tilts),
        )

    def _unit_grey(self, sight: Sight, normals: np.ndarray) -> np.ndarray:
        """What the unit adds at the blocks, shape (P, 3), for inward normals (n, 3)."""
        rest = self._rest
        if rest.unit is None:
            return np.zeros((len(self._lead), 3))
        inward = rest.skin.inward.copy()
        at_rest = rest.sight.blended(inward, rest.skin.faces, self._lead)
        inward[self._patch.vertices] = normals
        now = sight.blended(inward, rest.skin.faces, self._lead)
        return rest.unit_change(self._lead, _unit_vectors(now), _unit_vectors(at_rest))

    def _mean(self, values: np.ndarray) -> np.ndarray:
        """Means of pixels that say something, (p, 3), over blocks, (P, 3)."""
        return self._summed(self._trusted * values) / np.maximum(self._told, 1.0)

    def _summed(self, values: np.ndarray) -> np.ndarray:
        """Values of pixels, (p, 3), summed over blocks, (P, 3)."""
        count = len(self._lead)
        return np.stack(
            [np.bincount(self._block, values[:, c], minlength=count) for c in range(3)], axis=1
        )


def _unit_vectors(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12)
