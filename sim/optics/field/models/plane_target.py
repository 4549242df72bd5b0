"""Along the skin: in the plane of light, target and the target's normal, as the paper's text says.

With P = n_T x L the tangent toward the light is the part of L tangential to the skin,
(L - (L . n_T) n_T) / |...|.
"""

from __future__ import annotations

from sim.optics.field.directions import baked_directions
from sim.optics.field.lines import tangential
from sim.optics.field.model import Baked, Lights, Model, Shading
from workbench.core.base.monitor import Monitor


def bake(lights: Lights, monitor: Monitor) -> Baked:
    """Tangents toward the light."""
    normals = lights.mesh.seen.normals
    return baked_directions(lights, monitor, lambda straight, _: tangential(straight, normals))


MODEL = Model(
    place=1,
    hint="along the skin, in the plane of the target's normal; the paper's",
    shading=Shading.FIELD,
    bake=bake,
    quick=True,
)
