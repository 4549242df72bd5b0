"""Exact linear contact with an elastic layer bonded to a rigid base, by Fredholm equations.

A frictionless load of transform p(k) sinks the surface by 2 (1 - nu^2) / E L(k h) p(k) / k, with
q = 3 - 4 nu and

    L(x) = (2 q sinh 2x - 4x) / (2 q cosh 2x + 4x^2 + 1 + q^2),    L = 1 on a half-space.

Round contact of radius a: p(k) = int_0^a f(t) cos(k t) dt leaves no pressure outside, and f solves
f(x) + int_0^a K(x, t) f(t) dt = E / (pi (1 - nu^2)) d/dx int_0^x r w(r) / sqrt(x^2 - r^2) dr for a
surface pushed down by w, K = (2 / pi) int_0^inf (L(k h) - 1) cos(k x) cos(k t) dk; the force is
2 pi int f. Line contact is a sum of Chebyshev polynomials under the logarithmic kernel.
Sources: Lebedev and Ufliand, PMM 22 (1958) 442; Hayes, Keer, Herrmann and Mockros, J. Biomech. 5
(1972) 541; the kernel L: Alexandrov and Pozharskii, Three-Dimensional Contact Problems, 2001, 1.2.
Left out: friction, finite strain, the edge of the layer.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from workbench.core.design.design import Elastomer

ORDER = 64
"""Gauss points of the contact: 1e-6 for contacts up to some 5 thicknesses wide."""
WAVES = 600
"""Gauss points over wave numbers."""
LAST_WAVE = 24.0
"""Wave number, times the thickness, beyond which 1 - L is below 1e-17."""
WIDEST = 2.5
"""Contact radius over sqrt(R d) that no layer reaches: columns give 1.41, water 2."""
LINE_TERMS = 24
"""Chebyshev polynomials of a line's pressure."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LayerContact:
    """A solved contact with a layer."""

    force_N: float
    """Normal force; in line contact per mm of length [N/mm]."""
    radius_mm: float
    """Contact radius, or half the width of the contact line."""
    moment_radius_mm: float
    """sqrt(5/2 <r^2>) of the pressure: the radius of the Hertzian pressure as widely spread; in
    line contact 2 sqrt(<x^2>)."""


def layer_response(x: np.ndarray, poisson: float) -> np.ndarray:
    """L, the deflection of the layer over that of a half-space at wave number x / h."""
    q = 3.0 - 4.0 * poisson
    decay = np.exp(-2.0 * x)
    top = q * (1.0 - decay**2) - 4.0 * x * decay
    return top / (q * (1.0 + decay**2) + (4.0 * x**2 + 1.0 + q**2) * decay)


def ball_depth(radius_mm: float) -> Callable[[np.ndarray], np.ndarray]:
    """d/dx int_0^x r w / sqrt(x^2 - r^2) dr of a ball's surface w: x artanh(x / R)."""
    return lambda x: x * np.arctanh(x / radius_mm)


def rounded_end_depth(flat_mm: float, edge_mm: float) -> Callable[[np.ndarray], np.ndarray]:
    """The same of a flat end of radius `flat_mm` that goes on into a rounded edge.

    Integrated by parts it is x int_0^x w'(r) / sqrt(x^2 - r^2) dr, w' = y / sqrt(e^2 - y^2) with
    y = r - flat; r = x sin(angle).
    """
    nodes, weights = np.polynomial.legendre.leggauss(ORDER)

    def transformed(x: np.ndarray) -> np.ndarray:
        first = np.arcsin(np.minimum(flat_mm / x, 1.0))
        half = 0.5 * (0.5 * np.pi - first)
        angle = first[:, None] + half[:, None] * (1.0 + nodes)
        beyond = np.maximum(x[:, None] * np.sin(angle) - flat_mm, 0.0)
        slope = beyond / np.sqrt(np.maximum(edge_mm**2 - beyond**2, 1e-12 * edge_mm**2))
        return x * half * (slope @ weights)

    return transformed


def press_ball(
    material: Elastomer, *, radius_mm: float, height_mm: float, depth_mm: float
) -> LayerContact:
    """A ball on the layer; the contact radius follows from a pressure that ends smoothly."""
    profile = ball_depth(radius_mm)
    most_mm = min(0.8 * radius_mm, WIDEST * math.sqrt(radius_mm * depth_mm))
    return _press_profile(material, profile, most_mm, 0.0, height_mm, depth_mm)


def press_flat_end(
    material: Elastomer, *, radius_mm: float, edge_mm: float, height_mm: float, depth_mm: float
) -> LayerContact:
    """The flat end of a round punch with a rounded edge; without one the radius is given."""
    flat_mm = radius_mm - edge_mm
    if edge_mm == 0.0:
        x, weights, level, _ = _densities(material, None, radius_mm, height_mm)
        return _contact(x, weights, depth_mm * level)
    profile = rounded_end_depth(flat_mm, edge_mm)
    most_mm = flat_mm + 0.9 * edge_mm
    return _press_profile(material, profile, most_mm, flat_mm, height_mm, depth_mm)


def _press_profile(
    material: Elastomer,
    profile: Callable[[np.ndarray], np.ndarray],
    most_mm: float,
    least_mm: float,
    height_mm: float,
    depth_mm: float,
) -> LayerContact:
    """Look for the radius at which the depth, from f(a) = 0, is the one asked for."""

    def parts(radius_mm: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        return _densities(material, profile, radius_mm, height_mm)

    def excess_mm(radius_mm: float) -> float:
        _, _, level, shaped = parts(radius_mm)
        return float(shaped[-1] / level[-1]) - depth_mm

    least_mm = max(least_mm, 1e-6 * most_mm)
    x, weights, level, shaped = parts(_root(excess_mm, least_mm, most_mm))
    return _contact(x, weights, depth_mm * level - shaped)


def _root(excess_mm: Callable[[float], float], least_mm: float, most_mm: float) -> float:
    """Radius at which the excess of depth vanishes.

    Raises:
        ValueError: If the widest contact is not deep enough.
    """
    from scipy.optimize import brentq

    missing_mm = -excess_mm(most_mm)
    if missing_mm > 0.0:
        raise ValueError(f"a contact {most_mm} mm wide lacks {missing_mm} mm of the depth")
    return float(brentq(excess_mm, least_mm, most_mm, xtol=1e-10 * most_mm))  # pyright: ignore[reportArgumentType]


def _contact(x: np.ndarray, weights: np.ndarray, density: np.ndarray) -> LayerContact:
    """Integrals of f: F = 2 pi int f, and <r^2> = 2 int f t^2 / int f from p(k) at small k."""
    total = float(weights @ density[:-1])
    square_mm2 = 2.0 * float(weights @ (density * x**2)[:-1]) / total
    return LayerContact(
        force_N=2.0 * math.pi * total,
        radius_mm=float(x[-1]),
        moment_radius_mm=math.sqrt(2.5 * square_mm2),
    )


def _densities(
    material: Elastomer,
    profile: Callable[[np.ndarray], np.ndarray] | None,
    radius_mm: float,
    height_mm: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Places, weights, and f for a push of 1 mm and for the profile; the last entry is at a."""
    nodes, weights = np.polynomial.legendre.leggauss(ORDER)
    x = np.append(0.5 * radius_mm * (1.0 + nodes), radius_mm)
    weights = 0.5 * radius_mm * weights
    waves, wave_weights, response = _waves(material.poisson)
    waved = np.cos(np.outer(x / height_mm, waves))
    scaled = waved * ((2.0 / np.pi / height_mm) * wave_weights * (response - 1.0))
    kernel = scaled @ waved[:-1].T * weights
    matrix = np.eye(len(x))
    matrix[:, :-1] += kernel
    modulus = material.young_MPa / (math.pi * (1.0 - material.poisson**2))
    right = np.stack([np.ones(len(x)), np.zeros(len(x)) if profile is None else profile(x)], axis=1)
    level, shaped = np.linalg.solve(matrix, modulus * right).T
    return x, weights, level, shaped


@functools.cache
def _waves(poisson: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    nodes, weights = np.polynomial.legendre.leggauss(WAVES)
    waves = 0.5 * LAST_WAVE * (1.0 + nodes)
    return waves, 0.5 * LAST_WAVE * weights, layer_response(waves, poisson)


def press_line(
    material: Elastomer, *, radius_mm: float, height_mm: float, depth_mm: float
) -> LayerContact:
    """A long cylinder on the layer in plane strain; force per length.

    With p = sum b_n T_n(s) / sqrt(1 - s^2) and u = 2 (1 - nu^2) / (pi E) a int p N ds, the kernel
    N(y) = int_0^inf L(x) cos(x y) / x dx is -ln|y| and a smooth rest, and the logarithm turns T_n
    into (pi / n) T_n. A pressure that ends smoothly has sum b_n = 0, which gives the depth.
    """

    def excess_mm(half_mm: float) -> float:
        return _line_of_width(material, radius_mm, height_mm, half_mm)[1] - depth_mm

    most_mm = min(0.8 * radius_mm, WIDEST * math.sqrt(radius_mm * depth_mm))
    half_mm = _root(excess_mm, 1e-6 * most_mm, most_mm)
    terms, _ = _line_of_width(material, radius_mm, height_mm, half_mm)
    # int s^2 T_n / sqrt(1 - s^2) ds is pi / 2 for n = 0, pi / 4 for n = 2 and else nothing.
    square_mm2 = half_mm**2 * (0.5 + 0.25 * terms[1] / terms[0])
    return LayerContact(
        force_N=math.pi * half_mm * terms[0],
        radius_mm=half_mm,
        moment_radius_mm=2.0 * math.sqrt(square_mm2),
    )


def _line_of_width(
    material: Elastomer, radius_mm: float, height_mm: float, half_mm: float
) -> tuple[list[float], float]:
    """Coefficients b of the pressure [MPa] and depth [mm] of a contact of half width a."""
    count = 2 * LINE_TERMS
    angle = (np.arange(count) + 0.5) * np.pi / count
    s, orders = np.cos(angle), 2 * np.arange(LINE_TERMS)
    shapes = np.cos(np.outer(angle, orders))
    logarithm = np.where(orders > 0, np.pi / np.maximum(orders, 1), np.pi * math.log(2.0))
    waves, weights, response = _waves(material.poisson)
    # cos(x y) of a difference is a sum of products; the odd ones vanish by symmetry.
    waved = np.cos(np.outer(s * half_mm / height_mm, waves))
    rest = (waved * (weights * (response - 1.0) / waves)) @ waved.T
    # The divergence at small waves, cos / x, is cancelled by exp(-x) / x of the logarithm.
    constant = float(weights @ (np.exp(-waves) / waves))
    rest = rest + constant + math.log(height_mm / half_mm)
    compliance = 2.0 * (1.0 - material.poisson**2) / (math.pi * material.young_MPa) * half_mm
    matrix = compliance * (shapes * logarithm + rest @ shapes * (np.pi / count))
    across = radius_mm - np.sqrt(radius_mm**2 - (s * half_mm) ** 2)
    # Unknowns: the coefficients and the depth; the last row is the smooth end.
    system = np.vstack(
        [np.hstack([matrix, -np.ones((count, 1))]), np.append(np.ones(LINE_TERMS), 0.0)]
    )
    solution, *_ = np.linalg.lstsq(system, np.append(-across, 0.0), rcond=None)
    return solution[:-1].tolist(), float(solution[-1])


def dimitriadis_ball_N(
    material: Elastomer, *, radius_mm: float, height_mm: float, depth_mm: float
) -> float:
    """Force of a frictionless ball on a bonded layer, by Dimitriadis' series.

    F = 4 E / (3 (1 - nu^2)) sqrt(R) d^(3/2) [1 - 2 a chi / pi + 4 a^2 chi^2 / pi^2
    - (8 / pi^3)(a^3 + 4 pi^2 b / 15) chi^3 + (16 a / pi^4)(a^3 + 3 pi^2 b / 5) chi^4],
    chi = sqrt(R d) / h. Source: Dimitriadis and others, Determination of elastic moduli of thin
    layers of soft material using the atomic force microscope, Biophys. J. 82 (2002), eq. 11 with
    the bonded coefficients.
    """
    nu = material.poisson
    a = -(1.2876 - 1.4678 * nu + 1.3442 * nu**2) / (1.0 - nu)
    b = (0.6387 - 1.0277 * nu + 1.5164 * nu**2) / (1.0 - nu)
    chi = math.sqrt(radius_mm * depth_mm) / height_mm
    pi = math.pi
    series = 1.0 - 2.0 * a * chi / pi + 4.0 * (a * chi / pi) ** 2
    series -= 8.0 / pi**3 * (a**3 + 4.0 * pi**2 / 15.0 * b) * chi**3
    series += 16.0 * a / pi**4 * (a**3 + 3.0 * pi**2 / 5.0 * b) * chi**4
    return hertz_ball_N(material, radius_mm=radius_mm, depth_mm=depth_mm) * series


def hertz_ball_N(material: Elastomer, *, radius_mm: float, depth_mm: float) -> float:
    """Force of a ball on a half-space: 4 E / (3 (1 - nu^2)) sqrt(R) d^(3/2) [N]."""
    modulus = 4.0 * material.young_MPa / (3.0 * (1.0 - material.poisson**2))
    return modulus * math.sqrt(radius_mm) * depth_mm**1.5
