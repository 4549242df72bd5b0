"""Light at a smooth wall between two clear media: Snell's law and Fresnel's transmittance.

Source: Born and Wolf, Principles of Optics, section 1.5. Absorption is left out.
"""

from __future__ import annotations

import numpy as np


def refract(
    direction: np.ndarray, normal: np.ndarray, *, index_from: float, index_to: float
) -> tuple[np.ndarray, np.ndarray]:
    """Refracted unit directions and the unpolarised transmittance [1].

    Snell: n1 sin(a) = n2 sin(b). Fresnel, with ca = cos(a) and cb = cos(b):
    Rs = ((n1 ca - n2 cb) / (n1 ca + n2 cb))^2, Rp = ((n2 ca - n1 cb) / (n2 ca + n1 cb))^2,
    T = 1 - (Rs + Rp) / 2. Beyond the critical angle T is 0 and the direction runs along the wall.

    Args:
        direction: Unit directions of travel, shape (N, 3).
        normal: Unit normals, shape (N, 3), pointing to the side the light goes to.
        index_from: Refractive index on the side of the source [1].
        index_to: Refractive index on the other side [1].

    Returns:
        Directions, shape (N, 3), and transmittances, shape (N,).
    """
    cos_in = np.clip(np.einsum("ij,ij->i", direction, normal), 0.0, 1.0)
    ratio = index_from / index_to
    cos_out_squared = 1.0 - ratio**2 * (1.0 - cos_in**2)
    cos_out = np.sqrt(np.maximum(cos_out_squared, 0.0))
    bent = ratio * direction + (cos_out - ratio * cos_in)[:, None] * normal
    bent /= np.linalg.norm(bent, axis=1, keepdims=True)
    transmittance = _fresnel(cos_in, cos_out, index_from, index_to)
    return bent, np.where(cos_out_squared > 0.0, transmittance, 0.0)


def _fresnel(
    cos_in: np.ndarray, cos_out: np.ndarray, index_from: float, index_to: float
) -> np.ndarray:
    # The floor only guards 0 / 0 where both cosines vanish; the caller masks that case.
    across = np.maximum(index_from * cos_in + index_to * cos_out, 1e-12)
    along = np.maximum(index_to * cos_in + index_from * cos_out, 1e-12)
    reflect_s = ((index_from * cos_in - index_to * cos_out) / across) ** 2
    reflect_p = ((index_to * cos_in - index_from * cos_out) / along) ** 2
    return 1.0 - 0.5 * (reflect_s + reflect_p)
