"""Along the skin, as coded: in the plane of light, target and the way from axis to light.

The paper sets up a plane by the normal P = n x L of light S, target T and the skin's normal n at
the target, L = S - T, and takes the tangent at T of the curve in which it cuts the skin ("Offline
light field generation"; `plane_target`). The released code takes n_S = (x_S, y_S, 0) in place of
n, the way from the sensor's axis to the light: P = n_S x (T - S), and along n_T x P. On a finger
that is nearly the skin's normal at the light (`plane_normal`), on a paw or a pad it is not. A light
on the axis has no such way, and its field is straight.
The code leaves the sense of the tangent to the order of its product, which points away from the
light in 5 to 46 % of the pixels of paw and thumb; here it is toward the light everywhere.
"""

from __future__ import annotations

import numpy as np

from sim.optics.field.directions import baked_directions
from sim.optics.field.lines import from_axis, tangential_from
from sim.optics.field.model import Baked, Lights, Model, Shading
from workbench.core.base.monitor import Monitor


def bake(lights: Lights, monitor: Monitor) -> Baked:
    """Tangents on the side of the light."""
    normals = lights.mesh.seen.normals

    def turn(straight: np.ndarray, place_mm: np.ndarray) -> np.ndarray:
        return tangential_from(straight, normals, from_axis(place_mm))

    return baked_directions(lights, monitor, turn)


MODEL = Model(
    place=2,
    hint="along the skin, in the plane of the way from axis to light; the paper's code",
    shading=Shading.FIELD,
    bake=bake,
    quick=True,
)
