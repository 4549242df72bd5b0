"""Powers of a ring's LEDs for even light on the skin, by least squares: no trials.

Light is linear in the powers: with a_lv the light of LED l alone at vertex v, and w_v its area,

    min over p >= 0 of  sum over v of w_v (sum over l of p_l a_lv - 1)^2

The figure is the 5th over the 95th percentile, which does not see what lies beyond these. So rounds
follow in which the places beyond have no weight, and the best of all rounds is climbed from by the
figure itself, on the light that is known (simplex of Nelder and Mead 1965): the squares come near
its top, not onto it.

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
PLACES = 4000
"""Of the skin that the climb looks at, evenly among all."""
CLIMB = 400
"""Evaluations of the figure in the climb."""
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
    weight = np.sqrt(areas_mm2 / areas_mm2.sum())
    kept = np.ones(len(weight), dtype=bool)
    found = [np.ones(len(light))]
    for _ in range(ROUNDS):
        scale = weight * kept
        powers, _ = nnls(light.T / level * scale[:, None], scale * (1.0 - given / level))
        found.append(powers)
        total = powers @ light + given
        low, high = _percentiles(total, areas_mm2)
        kept = (total >= low) & (total <= high)

    def by_figure(each: np.ndarray) -> float:
        return evenness(each @ light + given, areas_mm2)

    best = max(found, key=by_figure)
    return max((best, _climbed(best, light, areas_mm2, given)), key=by_figure)


def _climbed(
    powers: np.ndarray, light: np.ndarray, areas_mm2: np.ndarray, given: np.ndarray
) -> np.ndarray:
    """Powers from which no small step makes the light more even on `PLACES`."""
    from scipy.optimize import minimize

    some = np.s_[:: -(-light.shape[1] // PLACES)]
    seen, around, weight = light[:, some], given[some], areas_mm2[some]

    def uneven(tried: np.ndarray) -> float:
        return -evenness(np.abs(tried) @ seen + around, weight)

    # The simplex begins with steps of a share of each power, so none may be 0.
    start = np.maximum(powers, 1e-2 * powers.max())
    return np.abs(minimize(uneven, start, method="Nelder-Mead", options={"maxfev": CLIMB}).x)


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
