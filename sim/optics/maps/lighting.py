"""How the skin is lit: by each LED, in all, and from how many distinct directions.

Light of LED l at a vertex: E_l max(N . L_l, 0), the irradiance of unscattered light [1/mm2 per
unit of power]. In all, per colour: sum of E_l rgb_l max(N . L_l, 0) plus what the bins of traced
light hold. The light vector of a colour is m_c = sum of E L rgb_c over everything that arrives;
with unit vectors m_r, m_g, m_b as rows the separability is |det|: 1 for three colours from
directions at right angles, 0 where two of them come from one direction or all lie in one plane, so
that colour cannot tell which way the skin is tilted.
"""

from __future__ import annotations

import numpy as np

from sim.optics.field.table import bin_directions
from workbench.core.result.light import AZIMUTHS, SINES, LightField, Scattered

LEAST = 1e-12
"""Light vectors shorter than this times the longest are dark."""


def light_of_each(light: LightField, inward: np.ndarray) -> np.ndarray:
    """Unscattered light of each LED at each vertex [1/mm2 per unit of power], (L, V), float32."""
    cosine = np.einsum("lvi,vi->lv", light.direction, inward.astype(np.float32))
    return np.maximum(cosine, 0.0) * light.irradiance


def light_in_all(light: LightField, inward: np.ndarray) -> np.ndarray:
    """Irradiance of each vertex per colour [1/mm2], scattered light included, (V, 3), float32."""
    total = np.einsum("lv,lc->vc", light_of_each(light, inward), light.led_rgb.astype(np.float32))
    if light.scattered is None:
        return total
    cosine = _gathered_from()[:, 2]
    return total + _spread(light.scattered, light.scattered.rest @ cosine)


def light_vectors(light: LightField) -> np.ndarray:
    """Sum of light by direction for each colour [1/mm2], shape (V, 3 colours, 3), float32."""
    weighted = light.irradiance[..., None] * light.direction
    total = np.einsum("lvi,lc->vci", weighted, light.led_rgb.astype(np.float32))
    if light.scattered is None:
        return total
    local = light.scattered.rest @ _gathered_from()
    world = np.einsum("nci,nij->ncj", local, light.scattered.frame)
    return total + _spread(light.scattered, world)


def separability(light: LightField) -> np.ndarray:
    """|det| of the three colours' unit light vectors, shape (V,), float32 in [0, 1]."""
    vectors = light_vectors(light).astype(np.float64)
    size = np.linalg.norm(vectors, axis=2, keepdims=True)
    floor = LEAST * max(float(size.max(initial=0.0)), LEAST)
    return np.abs(np.linalg.det(vectors / np.maximum(size, floor))).astype(np.float32)


def _gathered_from() -> np.ndarray:
    """Unit directions of the bins of traced light in the node's frame t, b, n, (B, 3), float32."""
    return bin_directions()[: AZIMUTHS * (len(SINES) - 1)].astype(np.float32)


def _spread(scattered: Scattered, values: np.ndarray) -> np.ndarray:
    """Values of the nodes, shape (N, ...), at the vertices, shape (V, ...)."""
    corners = values[scattered.nodes]
    return np.einsum("vk,vk...->v...", scattered.weights, corners)
