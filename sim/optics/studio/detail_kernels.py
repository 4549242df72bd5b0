"""Radiance of single points of the skin for two normals: what a tilt changes, on the device.

A point in a triangle takes the light of the three corners: each corner is shaded with the point's
normal, by the same functions as vertices are, and the three are weighed. So tilted and untilted
normal see exactly the same light, and equal normals differ by nothing. Shadows are left to the
caller. The plain twins are those of `shade_kernels`: `shading.shade`, `shading.relight` and
`table.look_up`, corner by corner.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti
import taichi.math as tm

from sim.optics.light.kernel_types import Vectors
from sim.optics.raster.bundles import Law, Lights, Posed, ScatteredLight, Skin, Spots
from sim.optics.raster.shade_kernels import HYBRID, TABLE, arriving, returned_share, scattered_to


@ti.kernel
def shade_points(
    spots: Spots,
    skin: Skin,
    posed: Posed,
    lights: Lights,
    scattered: ScatteredLight,
    law: Law,
    before: Vectors,
    after: Vectors,
):
    """Fill `before` and `after` with the radiance for the smooth and the tilted normals."""
    for entry in range(spots.corners.shape[0]):
        old_normal, new_normal = spots.smooth[entry], spots.tilted[entry]
        old, new = tm.vec3(0.0), tm.vec3(0.0)
        for corner in range(3):
            vertex, share = spots.corners[entry, corner], spots.shares[entry, corner]
            here, was, view = posed.placed[vertex], skin.points[vertex], posed.to_camera[vertex]
            if law.way_of_lighting >= HYBRID:
                old += share * scattered_to(vertex, old_normal, scattered)
                new += share * scattered_to(vertex, new_normal, scattered)
            if law.way_of_lighting < TABLE:
                for number in range(lights.led.shape[0]):
                    if lights.light[vertex, number].w > 0.0:
                        way, _reach, received = arriving(
                            law.way_of_lighting, was, here, vertex, number, lights
                        )
                        strength = share * received * lights.led_rgb[number]
                        old += strength * returned_share(way, view, old_normal, law)
                        new += strength * returned_share(way, view, new_normal, law)
        before[entry] = old
        after[entry] = new
