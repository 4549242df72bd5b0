"""The lens as one curve: from the angle to the optical axis to the distance from the image centre.

With f in pixels, r the distance from the centre over f, and k1, k2, ... the radial coefficients:

    pinhole         r = t,                                        t = tan(theta)
    opencv          r = t (1 + k1 t^2 + k2 t^4 + k3 t^6),         t = tan(theta)
    equidistant     r = t,                                        t = theta
    opencv_fisheye  r = t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8),  t = theta

`opencv` adds the tangential terms 2 p1 x y + p2 (t^2 + 2 x^2) and p1 (t^2 + 2 y^2) + 2 p2 x y.
The horizontal field of view is the angle between the centres of the left and right image edge, so
f = (W / 2) / r(fov / 2); tangential terms do not enter it.

A distortion must be one to one over the image. Beyond the image every curve goes on along its
tangent, from `limit` on, so that points outside the image land outside it instead of folding back
into it, and pixels around the image have directions. The inverse starts from a table and takes
Newton's steps. Source: OpenCV, "Camera Calibration and 3D Reconstruction" and "Fisheye camera
model". Left out: OpenCV's rational, thin-prism and tilted-sensor terms.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.base.units import radians
from workbench.core.design.camera import Camera, LensModel

ANGULAR = (LensModel.EQUIDISTANT, LensModel.OPENCV_FISHEYE)
"""Lenses whose curve is over theta; the others are over tan(theta)."""
SLACK = 1.15
"""How far beyond the image's corner tangential terms are asked to be one to one [1]."""
KNOTS = 2048
"""Of the table that the inverse starts from: errs by less than 1e-5 before Newton's steps."""
STEPS = 3
"""Newton's steps on a table; each squares the error."""
STEPS_TANGENTIAL = 8
"""Newton's steps with tangential terms, which the table leaves out."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Lens:
    """The curve of one camera."""

    focal_px: float
    radial: tuple[float, ...]
    """Factors of t^2, t^4, ...; () for an ideal lens."""
    tangential: tuple[float, float]
    angular: bool
    limit: float
    """t from which the curve goes on along its tangent; inf for an ideal lens."""
    table: tuple[np.ndarray, np.ndarray]
    """t and r of the inverse's start, ascending."""

    def radius(self, t: np.ndarray) -> np.ndarray:
        """r at t >= 0, any shape."""
        if not self.radial:
            return t
        inner = np.minimum(t, self.limit)
        return _curve(self.radial, inner) + _slope(self.radial, inner) * (t - inner)

    def inverse(self, r: np.ndarray) -> np.ndarray:
        """t at r >= 0, any shape."""
        if not self.radial:
            return r
        knots, values = self.table
        inner = np.minimum(r, values[-1])
        t = np.interp(inner, values, knots)
        for _ in range(STEPS):
            t = t - (_curve(self.radial, t) - inner) / _slope(self.radial, t)
        return t + (r - inner) / _slope(self.radial, np.asarray(self.limit))

    def bend(self, ideal: np.ndarray) -> np.ndarray:
        """Distorted image points over f, shape (N, 2), from ideal ones."""
        if not self.radial:
            return ideal
        t = np.hypot(ideal[:, 0], ideal[:, 1])
        scale = np.divide(self.radius(t), t, out=np.ones_like(t), where=t > 0.0)
        return ideal * scale[:, None] + self._shift(ideal, t)

    def straighten(self, bent: np.ndarray) -> np.ndarray:
        """Inverse of `bend`, shape (N, 2)."""
        if not self.radial:
            return bent
        r = np.hypot(bent[:, 0], bent[:, 1])
        scale = np.divide(self.inverse(r), r, out=np.ones_like(r), where=r > 0.0)
        ideal = bent * scale[:, None]
        if any(self.tangential):
            for _ in range(STEPS_TANGENTIAL):
                ideal = ideal - _solve(self.jacobian(ideal), self.bend(ideal) - bent)
        return ideal

    def jacobian(self, ideal: np.ndarray) -> np.ndarray:
        """Derivative of `bend`, shape (N, 2, 2)."""
        t = np.maximum(np.hypot(ideal[:, 0], ideal[:, 1]), 1e-12)
        unit = ideal / t[:, None]
        along = _slope(self.radial, np.minimum(t, self.limit))
        across = self.radius(t) / t
        outer = unit[:, :, None] * unit[:, None, :]
        found = across[:, None, None] * np.eye(2) + (along - across)[:, None, None] * outer
        p1, p2 = self.tangential
        x, y = ideal.T
        derivative = np.empty_like(found)
        derivative[:, 0, 0] = 2.0 * p1 * y + 6.0 * p2 * x
        derivative[:, 0, 1] = derivative[:, 1, 0] = 2.0 * p1 * x + 2.0 * p2 * y
        derivative[:, 1, 1] = 6.0 * p1 * y + 2.0 * p2 * x
        # Beyond the limit the shift is T(u) (2 limit t - limit^2) in place of T(u) t^2: its slope
        # is b = limit / t of this one along the ray, b (2 - b) across it.
        b = np.minimum(1.0, self.limit / t)[:, None, None]
        along_ray = derivative @ unit[:, :, None] * unit[:, None, :]
        return found + b * (2.0 - b) * derivative - b * (1.0 - b) * along_ray

    def _shift(self, ideal: np.ndarray, t: np.ndarray) -> np.ndarray:
        p1, p2 = self.tangential
        if not any(self.tangential):
            return np.zeros_like(ideal)
        x, y = ideal.T
        square = t * t
        shift = np.column_stack(
            [
                2.0 * p1 * x * y + p2 * (square + 2.0 * x * x),
                p1 * (square + 2.0 * y * y) + 2.0 * p2 * x * y,
            ]
        )
        beyond = np.minimum(1.0, self.limit / np.maximum(t, 1e-12))
        return shift * (beyond * (2.0 - beyond))[:, None]


@functools.lru_cache(maxsize=64)
def lens_of(camera: Camera) -> Lens:
    """The curve of a camera's lens.

    Raises:
        DesignError: If the distortion is not one to one over the image, with the distance from
            the centre [px] at which the image folds.
    """
    angular = camera.lens in ANGULAR
    half = radians(camera.fov_x_deg) / 2.0
    edge = half if angular else math.tan(half)
    radial, tangential = _coefficients(camera)
    if not any(radial) and not any(tangential):
        return Lens(
            focal_px=camera.width_px / 2.0 / edge,
            radial=(),
            tangential=(0.0, 0.0),
            angular=angular,
            limit=math.inf,
            table=(np.zeros(0), np.zeros(0)),
        )
    fold = _fold(radial)
    if fold <= edge:
        raise _folds(camera, fold, edge, radial)
    reach = float(_curve(radial, np.asarray(edge)))
    corner = math.hypot(camera.width_px, camera.height_px) / camera.width_px * reach
    needed = corner * (SLACK if any(tangential) else 1.0)
    end = _first_reaching(radial, needed, edge, fold)
    if end is None:
        raise _folds(camera, fold, edge, radial)
    limit = min(0.5 * (end + fold), 1.5 * end)
    knots = np.linspace(0.0, limit, KNOTS)
    lens = Lens(
        focal_px=camera.width_px / 2.0 / reach,
        radial=radial,
        tangential=tangential,
        angular=angular,
        limit=limit,
        table=(knots, _curve(radial, knots)),
    )
    _check_tangential(camera, lens, end)
    return lens


def _coefficients(camera: Camera) -> tuple[tuple[float, ...], tuple[float, float]]:
    given = camera.distortion
    if camera.lens is LensModel.OPENCV and given:
        k1, k2, p1, p2, *rest = given
        return (k1, k2, *rest), (p1, p2)
    return given, (0.0, 0.0)


def _curve(radial: tuple[float, ...], t: np.ndarray) -> np.ndarray:
    return t * np.polynomial.polynomial.polyval(t * t, (1.0, *radial))


def _slope(radial: tuple[float, ...], t: np.ndarray) -> np.ndarray:
    powers = [(2 * number + 1) * k for number, k in enumerate((1.0, *radial))]
    return np.polynomial.polynomial.polyval(t * t, powers)


def _fold(radial: tuple[float, ...]) -> float:
    """Smallest t at which the curve turns back; inf if it never does."""
    powers = [(2 * number + 1) * k for number, k in enumerate((1.0, *radial))]
    squares = np.polynomial.polynomial.polyroots(np.trim_zeros(powers, "b"))
    real = squares.real[(np.abs(squares.imag) < 1e-9) & (squares.real > 0.0)]
    return float(np.sqrt(real.min())) if real.size else math.inf


def _first_reaching(radial: tuple[float, ...], r: float, start: float, fold: float) -> float | None:
    """t before the fold at which the curve is r, or None."""
    high = start
    while _curve(radial, np.asarray(high)) < r:
        if high >= fold:
            return None
        high = min(1.2 * high, fold)
    low = 0.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _curve(radial, np.asarray(middle)) < r else (low, middle)
    return high


def _check_tangential(camera: Camera, lens: Lens, end: float) -> None:
    if not any(lens.tangential):
        return
    around = np.linspace(0.0, 2.0 * np.pi, 96, endpoint=False)
    t = np.repeat(np.linspace(0.0, end, 64)[1:], len(around))
    rays = np.tile(np.column_stack([np.cos(around), np.sin(around)]), (63, 1))
    turned = np.linalg.det(lens.jacobian(t[:, None] * rays)) <= 0.0
    if turned.any():
        raise _refused(camera, float(lens.radius(t[turned].min()[None])[0]) * lens.focal_px)


def _folds(camera: Camera, fold: float, edge: float, radial: tuple[float, ...]) -> DesignError:
    # Where the curve turns back before the edge there is no focal length: give it with the
    # one of the ideal lens.
    reach = _curve(radial, np.asarray(edge)) if fold > edge else np.asarray(edge)
    at_px = float(_curve(radial, np.asarray(fold)) / reach) * camera.width_px / 2.0
    return _refused(camera, at_px)


def _refused(camera: Camera, fold_px: float) -> DesignError:
    corner_px = math.hypot(camera.width_px, camera.height_px) / 2.0
    return DesignError(
        f"the distortion {camera.distortion} folds the image {fold_px:.0f} px from its centre, "
        f"within the {corner_px:.0f} px to its corner",
        hint="use coefficients calibrated over the whole image, or a smaller fov_x_deg",
        at="optics.camera.distortion",
    )


def _solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    return np.linalg.solve(matrix, right[:, :, None])[:, :, 0]
