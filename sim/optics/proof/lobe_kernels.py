"""The coating as the device computes it, for many directions at once: what `lobe_checks` asks."""

# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti

from sim.optics.light.coating_kernels import reflected
from sim.optics.light.kernel_types import Floats, Vectors


@ti.kernel
def reflect_all(
    found: Floats,
    light: Vectors,
    view: Vectors,
    normal: Vectors,
    albedo: ti.f32,
    specular: ti.f32,
    roughness: ti.f32,
):
    """Radiance per perpendicular irradiance [1/sr] of each pair of directions."""
    for number in range(light.shape[0]):
        found[number] = reflected(
            light[number], view[number], normal[number], albedo, specular, roughness
        )
