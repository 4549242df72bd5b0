"""A ball fitted to a photograph as a model: place, radius and depth whose image it would be.

The ball presses an elastic layer (`layer_law`): the skin under it lies on it, pressure is nowhere
negative, and elsewhere the skin follows the pressure. The moved skin is rendered, and Gauss-Newton
with finite differences finds the four numbers that leave least of the photograph unexplained; the
depth read before is where it begins. Stiffness does not matter to the shape.
A dent is rounder at its rim than the ball, so spheres laid through a read surface come out too
large or too small by the noise; a model knows the rim.
Source of the contact: Johnson, Contact Mechanics, 1985, section 5.8.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sim.reading.changed import change
from sim.reading.fit import Prediction
from sim.reading.layer_law import Layer, influence_mm_per_MPa
from sim.reading.noise import Noise
from sim.reading.patch import Patch
from sim.reading.photo_view import PhotoView
from sim.reading.reader import Reader, Touch

RADII_MM = (0.3, 100.0)
MOST_STEPS = 12
STEPS = (0.02, 0.02, 0.02, 0.02)
"""Of finite differences: place across, twice [mm], radius [share], depth [mm]."""
FARTHEST = (0.5, 0.5, 0.4, 0.3)
"""Largest change of a step, likewise."""
DAMPING, SHORTER, LONGER = 1e-3, 10.0, 0.2
WORTH = 1e-3
"""A step that gains a smaller share of the squares is the last."""
ILL_POSED = 1e12
"""Condition of the equations from which the photograph does not tell a ball."""
ROUNDS = 30
"""In which the contact is found."""
MOST_PLACES = 900
"""Vertices that carry pressure or follow it, of which the nearest to the ball are taken."""


@dataclass(frozen=True, kw_only=True, slots=True)
class FittedBall:
    """A ball that presses the skin."""

    place_mm: np.ndarray
    """Of the skin at rest under its middle, shape (3,)."""
    radius_mm: float
    radius_sigma_mm: float
    """Standard deviation, by what is left unexplained."""
    depth_mm: float
    """Of its lowest point below the skin at rest."""
    misfit: float
    """Root mean square of residual over noise [1]."""


def fit_ball(
    reader: Reader, photo: np.ndarray, touch: Touch, layer: Layer, radius_mm: float
) -> FittedBall | None:
    """Fit a ball to the photograph of a touch; None where nothing was touched.

    Args:
        reader: That read it.
        photo: Shape (H, W, 3) [grey].
        touch: What it read.
        layer: The wall under the touch; its stiffness does not matter.
        radius_mm: Where to begin.
    """
    rest = reader.rest
    seen = change(rest.idle, photo, rest.sees.reshape(rest.shape))
    free = touch.sigma_mm != 0.0
    if not free.any() or not seen.certain.any():
        return None
    patch = Patch(rest.skin, free)
    view = PhotoView(rest, patch, seen)
    dent = _Dent(reader, patch, touch, layer)
    unknown = np.array([0.0, 0.0, np.log(radius_mm), float(touch.inward_mm.max())])
    return _fitted(dent, view, unknown, seen.noise)


def _fitted(dent: _Dent, view: PhotoView, unknown: np.ndarray, noise: Noise) -> FittedBall | None:
    """Gauss-Newton from a first guess (4,)."""

    def told(of: np.ndarray) -> np.ndarray:
        return _residual(view.rendered(dent.inward_mm(of)), noise)

    now, damping = told(unknown), DAMPING
    slopes = _slopes(told, unknown, now)
    for _ in range(MOST_STEPS):
        square = slopes.T @ slopes
        step = -np.linalg.solve(square + damping * np.diag(np.diag(square)), slopes.T @ now)
        tried = dent.kept(unknown + np.clip(step, np.negative(FARTHEST), FARTHEST))
        then = told(tried)
        gain = 1.0 - (then @ then) / (now @ now)
        if gain <= 0.0:
            damping *= SHORTER
            continue
        unknown, now, damping = tried, then, damping * LONGER
        if gain < WORTH:
            break
        slopes = _slopes(told, unknown, now)
    misfit = float(np.sqrt(now @ now / max(len(now), 1)))
    square = slopes.T @ slopes
    if np.linalg.cond(square) > ILL_POSED:
        return None
    sigma = np.sqrt(np.diag(np.linalg.inv(square))) * max(1.0, misfit)
    radius_mm = float(np.exp(unknown[2]))
    return FittedBall(
        place_mm=dent.place_mm(unknown),
        radius_mm=radius_mm,
        radius_sigma_mm=radius_mm * float(sigma[2]),
        depth_mm=float(unknown[3]),
        misfit=misfit,
    )


def _residual(seen: Prediction, noise: Noise) -> np.ndarray:
    """Residuals over noise of the blocks and colours that say something."""
    return (seen.residual / np.sqrt(noise.of_block(seen.told))).ravel()


def _slopes(
    told: Callable[[np.ndarray], np.ndarray], unknown: np.ndarray, now: np.ndarray
) -> np.ndarray:
    """Derivatives of residuals by the unknowns, shape (P, 4)."""
    columns = []
    for number, step in enumerate(STEPS):
        moved = unknown.copy()
        moved[number] += step
        columns.append((told(moved) - now) / step)
    return np.stack(columns, axis=1)


class _Dent:
    """The dents that balls make in a patch around a touch."""

    def __init__(self, reader: Reader, patch: Patch, touch: Touch, layer: Layer) -> None:
        skin = reader.rest.skin
        chosen = patch.vertices[: patch.free]
        depth_mm = np.maximum(touch.inward_mm[chosen], 0.0)
        weight = depth_mm**2 * skin.shares_mm2[chosen]
        middle = np.average(skin.points_mm[chosen], axis=0, weights=weight)
        deepest = int(np.argmin(np.linalg.norm(skin.points_mm[chosen] - middle, axis=1)))
        self._free = patch.free
        self._origin = skin.points_mm[chosen[deepest]]
        self._inward = skin.inward[chosen[deepest]]
        self._one, self._two = skin.one[chosen[deepest]], skin.two[chosen[deepest]]
        away_mm = np.linalg.norm(skin.points_mm[chosen] - self._origin, axis=1)
        near = np.argsort(away_mm)[:MOST_PLACES]
        self._near = near
        self._points_mm = skin.points_mm[chosen[near]]
        self._normals = skin.inward[chosen[near]]
        area_mm2 = skin.shares_mm2[chosen[near]]
        self._moved = influence_mm_per_MPa(layer, self._points_mm, area_mm2)
        """Displacement by pressure [mm/MPa], shape (n, n)."""
        self._largest_mm = float(away_mm.max())

    def kept(self, unknown: np.ndarray) -> np.ndarray:
        """The unknowns within what makes sense."""
        across = np.clip(unknown[:2], -self._largest_mm, self._largest_mm)
        radius = np.clip(unknown[2], *np.log(RADII_MM))
        return np.array([*across, radius, max(float(unknown[3]), 0.01)])

    def place_mm(self, unknown: np.ndarray) -> np.ndarray:
        """Of the skin at rest under the middle of a ball, shape (3,)."""
        aimed = self._origin + unknown[0] * self._one + unknown[1] * self._two
        nearest = int(np.argmin(np.linalg.norm(self._points_mm - aimed, axis=1)))
        # On a curved skin the place across lies beside the skin by its height there.
        height_mm = (self._points_mm[nearest] - aimed) @ self._inward
        return aimed + height_mm * self._inward

    def inward_mm(self, unknown: np.ndarray) -> np.ndarray:
        """Displacement of the patch's free vertices under a ball, shape (m,)."""
        radius_mm = float(np.exp(unknown[2]))
        place_mm = self.place_mm(unknown)
        nearest = int(np.argmin(np.linalg.norm(self._points_mm - place_mm, axis=1)))
        centre = place_mm - (radius_mm - unknown[3]) * self._normals[nearest]
        found = np.zeros(self._free)
        found[self._near] = touching_mm(
            self._moved, depth_in_ball_mm(self._points_mm, self._normals, centre, radius_mm)
        )
        return found


def depth_in_ball_mm(
    points_mm: np.ndarray, inward: np.ndarray, centre_mm: np.ndarray, radius_mm: float
) -> np.ndarray:
    """How far points (n, 3) must go along unit vectors (n, 3) to leave a ball behind, shape (n,).

    0 where their line does not meet it, or leaves it before the point.
    """
    off = points_mm - centre_mm
    along = np.einsum("nc,nc->n", off, inward)
    inside = along**2 - np.einsum("nc,nc->n", off, off) + radius_mm**2
    through = -along + np.sqrt(np.maximum(inside, 0.0))
    return np.where(inside > 0.0, np.maximum(through, 0.0), 0.0)


def touching_mm(moved: np.ndarray, wanted_mm: np.ndarray) -> np.ndarray:
    """Displacement of a layer under a rigid object, shape (n,): contact without adhesion.

    Args:
        moved: Displacement by pressure, shape (n, n).
        wanted_mm: Least displacement of each place, shape (n,).
    """
    touches = wanted_mm > 0.0
    displaced = np.zeros(len(wanted_mm))
    for _ in range(ROUNDS):
        if not touches.any():
            return np.zeros(len(wanted_mm))
        at = np.flatnonzero(touches)
        pressure = np.linalg.solve(moved[np.ix_(at, at)], wanted_mm[at])
        displaced = moved[:, at] @ pressure
        now = np.zeros(len(wanted_mm), dtype=bool)
        now[at[pressure > 0.0]] = True
        now |= (displaced < wanted_mm - 1e-9) & ~touches
        if (now == touches).all():
            break
        touches = now
    return displaced
