"""Powers of a ring's LEDs for even light on the skin, by least squares: no trials.

Light is linear in the powers: with a_lv the light of LED l alone at vertex v, the light is
sum over l of p_l a_lv, and

    min over p >= 0 of  sum over v of w_v (sum over l of p_l a_lv - 1)^2

with w_v the area of v, makes it as even as these LEDs can. The figure is the 5th over the 95th
percentile, which does not see what lies beyond these; so rounds follow in which the light that
lies there has no weight, and the best round by the figure counts.

Left out: light that the skin scatters onto itself, which depends on the powers too, but is
smoother than what comes straight. The figures of the trial have it all the same.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from workbench.core.design.lighting import LedRing, LightModel
from workbench.core.result.results import MembraneMesh

POWERS = "design.optics.ring.powers"
ROUNDS = 12
LOW, HIGH = 5.0, 95.0
"""Percentiles of the figure `light_evenness_p5_over_p95_1`."""


def evened(ring: LedRing, light: np.ndarray, areas_mm2: np.ndarray) -> LedRing:
    """The ring with the powers that make light even; the strongest is 1.

    Args:
        ring: The LEDs.
        light: Of each LED alone with a factor of 1, shape (L, V); further lights follow.
        areas_mm2: Of the vertices [mm2], shape (V,).
    """
    if ring.count < 2:
        return ring
    powers = even_powers(light[: ring.count], areas_mm2, given=light[ring.count :].sum(axis=0))
    factors = tuple(round(float(p), 4) for p in powers / max(float(powers.max()), 1e-12))
    return dataclasses.replace(ring, powers=factors) if any(factors) else ring


def even_powers(light: np.ndarray, areas_mm2: np.ndarray, *, given: np.ndarray) -> np.ndarray:
    """Non-negative powers of L lights for even light, shape (L,).

    Args:
        light: Of each light alone, shape (L, V).
        areas_mm2: Weights of the V places, shape (V,).
        given: Light that is there besides, shape (V,).
    """
    from scipy.optimize import nnls

    level = float(light.mean()) * len(light)
    rows = light.T / level
    weight = np.sqrt(areas_mm2 / areas_mm2.sum())
    kept = np.ones(len(weight), dtype=bool)
    best, most = np.ones(len(light)), evenness(light.sum(axis=0) + given, areas_mm2)
    for _ in range(ROUNDS):
        scale = (weight * kept)[:, None]
        powers, _ = nnls(rows * scale, scale[:, 0] * (1.0 - given / level))
        total = powers @ light + given
        found = evenness(total, areas_mm2)
        if found > most:
            best, most = powers, found
        low, high = _percentiles(total, areas_mm2)
        inside = (total >= low) & (total <= high)
        if (inside == kept).all():
            break
        kept = inside
    return best


def evenness(light: np.ndarray, areas_mm2: np.ndarray) -> float:
    """The 5th over the 95th percentile, weighted by area."""
    low, high = _percentiles(light, areas_mm2)
    return low / high if high > 0.0 else 0.0


def _percentiles(light: np.ndarray, areas_mm2: np.ndarray) -> tuple[float, float]:
    from sim.optics.maps.judging import PERCENTILES, weighted_percentiles

    marks = weighted_percentiles(light.astype(np.float64), areas_mm2.astype(np.float64))
    return float(marks[PERCENTILES.index(LOW)]), float(marks[PERCENTILES.index(HIGH)])


def light_of_leds(mesh: MembraneMesh, ring: LedRing, lamps: tuple) -> np.ndarray:
    """Direct light of each LED with a factor of 1, then of the lamps, (L, V), mean of colours."""
    from sim.optics.field.bake import bake_light
    from sim.optics.maps.lighting import light_of_each

    bare = dataclasses.replace(ring, powers=())
    light = bake_light(mesh, bare, lamps, model=_straight())
    each = light_of_each(light, -mesh.seen.normals)
    return each * light.led_rgb.mean(axis=1)[:, None]


def _straight() -> LightModel:
    from sim.optics.field.model import quick_model

    return quick_model()
