"""Along the skin, by normals: in the plane of light, target and the normal at the light.

P = n_S x (T - S), with n_S the normal of the skin nearest to the light: like `plane_source`, for a
body that is not round about its axis.
"""

from __future__ import annotations

import numpy as np

from sim.optics.field.directions import baked_directions
from sim.optics.field.lines import normal_at, tangential_from
from sim.optics.field.model import Baked, Lights, Model, Shading
from workbench.core.base.monitor import Monitor


def bake(lights: Lights, monitor: Monitor) -> Baked:
    """Tangents on the side of the light."""
    skin = lights.mesh.seen

    def turn(straight: np.ndarray, place_mm: np.ndarray) -> np.ndarray:
        return tangential_from(straight, skin.normals, normal_at(skin, place_mm))

    return baked_directions(lights, monitor, turn)


MODEL = Model(
    place=3,
    hint="along the skin, in the plane of the light's normal; ours after the paper's",
    shading=Shading.FIELD,
    bake=bake,
    quick=True,
)
