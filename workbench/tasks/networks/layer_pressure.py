"""Pressure under a dent by linear elasticity: a soft layer on a hard ground, pushed in from above.

In wavenumbers k of a layer of thickness h that is bonded to its ground and pressed without friction
displacement u and pressure p go with each other by

    u(k) = 2 f(k h) / (E* k) p(k),   E* = E / (1 - nu^2),   c = 3 - 4 nu,
    f(x) = (2 c sinh 2x - 4 x) / (2 c cosh 2x + 4 x^2 + 1 + c^2)

so a dent that was read tells the pressure over the modulus. It holds for slight slopes; large or
sharp dents that press deep into a thin layer are told too soft.
Source: Carbone and Mangialardi, Analysis of the adhesive contact of confined layers by using a
Green's function approach, 2008; f goes to 1 of a half space and to (1 - 2 nu) x / 2 (1 - nu)^2, the
confined compression of a thin layer.
"""

from __future__ import annotations

import functools

import numpy as np

from workbench.tasks.networks.patch import MM_PER_PX

THICK_MM, POISSON = 2.0, 0.45
"""Of the layer, as most membranes have it. Under objects of some millimetres the level of pressures
hardly goes with it: renders of a layer of 4 mm are told as well by 2 mm as by 3."""
STEEPEST = 30.0
"""Of x, beyond which f is 1 to the last digit, and its terms overflow."""


def layer_compliance(x: np.ndarray, poisson: float = POISSON) -> np.ndarray:
    """f of the module, for x = k h >= 0, of any shape."""
    c, x = 3.0 - 4.0 * poisson, np.minimum(x, STEEPEST)
    top = 2.0 * c * np.sinh(2.0 * x) - 4.0 * x
    return top / (2.0 * c * np.cosh(2.0 * x) + 4.0 * x**2 + 1.0 + c**2)


def disc_pressure(inward_mm: np.ndarray, disc_mm: float, thick_mm: float = THICK_MM) -> np.ndarray:
    """Mean pressure on a disc about each pixel over E*, shape (S, S), of a dent (S, S) [mm].

    Args:
        inward_mm: Inward displacement of a square, `MM_PER_PX` for a pixel; 0 counts around it.
        disc_mm: Diameter of the disc [mm].
        thick_mm: Of the layer [mm].
    """
    size = len(inward_mm)
    moved = np.fft.rfft2(inward_mm, (2 * size, 2 * size))
    found = np.fft.irfft2(moved * _stiffness(2 * size, disc_mm, thick_mm), (2 * size, 2 * size))
    return found[:size, :size]


@functools.lru_cache(maxsize=8)
def _stiffness(size: int, disc_mm: float, thick_mm: float) -> np.ndarray:
    """Mean pressure on a disc over E* and displacement, by wavenumber [1/mm]."""
    down = 2.0 * np.pi * np.fft.fftfreq(size, MM_PER_PX)
    across = 2.0 * np.pi * np.fft.rfftfreq(size, MM_PER_PX)
    wave = np.hypot(down[:, None], across)
    # At rest as a whole the layer is compressed between its grounds: the limit of k / f.
    still = 1e-6 / thick_mm
    wave = np.maximum(wave, still)
    at_mm = np.fft.fftfreq(size, 1.0 / size) * MM_PER_PX
    disc = (np.hypot(at_mm[:, None], at_mm) <= 0.5 * disc_mm).astype(float)
    mean = np.fft.rfft2(disc / disc.sum()).real
    return 0.5 * wave / layer_compliance(wave * thick_mm) * mean
