"""From what each pixel sees to its light, its ink and its grey levels.

image = background + (foreground deformed - foreground undeformed): `remainder` is the background
less the undeformed foreground, the foreground is vertex radiance interpolated and dimmed by the
walls. Pixels that see what they saw are the background, exactly.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti
import taichi.math as tm

from sim.optics.light.kernel_types import (
    Bytes,
    Floats,
    IntegerRows,
    Integers,
    Pairs,
    VectorRows,
    Vectors,
)
from sim.optics.raster.raster_kernels import SAME


@ti.func
def blend(values: ti.template(), first, faces: ti.template(), face, weights):
    """A vertex quantity at weights (v, w) of a face's second and third corner."""
    total = values[first + faces[face, 0]] * (1.0 - weights.x - weights.y)
    total += values[first + faces[face, 1]] * weights.x
    return total + values[first + faces[face, 2]] * weights.y


@ti.func
def facing_way(
    way,
    turned: ti.template(),
    normals: ti.template(),
    first,
    at,
    face,
    seen_weights: ti.template(),
    on_patch: ti.template(),
    faces: ti.template(),
):
    """The inward normal where a pixel looks, turned to face its line of sight; any length.

    `first` is the frame's first vertex of `turned`, the normals of the moved patch.
    """
    facing = tm.vec3(0.0)
    if on_patch[at]:
        facing = -blend(turned, first, faces, face, seen_weights[at])
    else:
        facing = -blend(normals, 0, faces, face, seen_weights[at])
    facing -= ti.max(facing.dot(way), 0.0) * way
    return facing


@ti.kernel
def describe(
    frames: ti.i32,
    pixels: ti.i32,
    vertices: ti.i32,
    seen_face: Integers,
    seen_weights: Pairs,
    seen_mm: Floats,
    on_patch: Bytes,
    faces: IntegerRows,
    normals: Vectors,
    turned: Vectors,
    origin: Vectors,
    direction: Vectors,
    camera: tm.vec3,
    axis: tm.vec3,
    normal: Vectors,
    depth: Floats,
):
    """Normals facing the camera and depth along its axis; NaN and 0 where there is no skin."""
    for at in range(frames * pixels):
        face = seen_face[at]
        if face != SAME:
            frame, number = at // pixels, at % pixels
            facing, away = tm.vec3(0.0), tm.nan
            if face >= 0:
                way = direction[number]
                first = frame * vertices
                facing = facing_way(
                    way, turned, normals, first, at, face, seen_weights, on_patch, faces
                )
                facing /= ti.max(facing.norm(), 1e-12)
                away = (origin[number] + seen_mm[at] * way - camera).dot(axis)
            normal[at] = facing
            depth[at] = away


@ti.kernel
def spread_ink(
    frames: ti.i32,
    pixels: ti.i32,
    vertices: ti.i32,
    seen_face: Integers,
    seen_weights: Pairs,
    on_patch: Bytes,
    faces: IntegerRows,
    points: Vectors,
    normals: Vectors,
    turned: Vectors,
    origin: Vectors,
    direction: Vectors,
    seen_mm: Floats,
    camera: tm.vec3,
    axis: tm.vec3,
    angular: ti.i32,
    focal_px: ti.f32,
    least_cosine: ti.f32,
    radius: ti.f32,
    dot_start: Integers,
    dot_of: Integers,
    centres: Vectors,
    ink: Floats,
    marker: Integers,
):
    """Covered share of the pixels that changed, and the nearest dot; `markers.ink` is the twin."""
    for at in range(frames * pixels):
        face = seen_face[at]
        if face != SAME:
            frame, number = at // pixels, at % pixels
            share, nearest, gap = 0.0, 0, 1e9
            if face >= 0 and dot_start[face + 1] > dot_start[face]:
                place = blend(points, 0, faces, face, seen_weights[at])
                for entry in range(dot_start[face], dot_start[face + 1]):
                    distance = (centres[dot_of[entry]] - place).norm()
                    if distance < gap:
                        gap, nearest = distance, dot_of[entry]
                way = direction[number]
                first = frame * vertices
                facing = facing_way(
                    way, turned, normals, first, at, face, seen_weights, on_patch, faces
                )
                cosine = -facing.dot(way) / ti.max(facing.norm(), 1e-12)
                away = ti.abs((origin[number] + seen_mm[at] * way - camera).dot(axis))
                if angular:
                    away = (place - camera).norm()
                footprint = away / focal_px / ti.max(cosine, least_cosine)
                step = tm.clamp((radius - gap) / footprint + 0.5, 0.0, 1.0)
                share = step * step * (3.0 - 2.0 * step)
            ink[at] = share
            marker[at] = nearest


@ti.func
def light_of(
    frame,
    number,
    at,
    vertices,
    face,
    seen_weights: ti.template(),
    on_patch: ti.template(),
    faces: ti.template(),
    radiance: ti.template(),
    undeformed: ti.template(),
    transmittance: ti.template(),
    remainder: ti.template(),
    ink: ti.template(),
    has_dots,
    ink_gain,
    inked_background,
):
    """Linear radiance of a pixel that changed."""
    arriving = tm.vec3(0.0)
    if face >= 0:
        if on_patch[at]:
            arriving = blend(radiance, frame * vertices, faces, face, seen_weights[at])
        else:
            arriving = blend(undeformed, 0, faces, face, seen_weights[at])
    arriving *= transmittance[number]
    factor = 1.0
    if has_dots:
        factor += (ink_gain - 1.0) * ink[at]
    kept = remainder[number]
    if inked_background:
        kept *= factor
    return ti.max(kept + factor * arriving, 0.0)


@ti.kernel
def expose(
    frames: ti.i32,
    pixels: ti.i32,
    vertices: ti.i32,
    seen_face: Integers,
    seen_weights: Pairs,
    on_patch: Bytes,
    faces: IntegerRows,
    radiance: Vectors,
    undeformed: Vectors,
    transmittance: Floats,
    remainder: Vectors,
    ink: Floats,
    has_dots: ti.i32,
    ink_gain: ti.f32,
    inked_background: ti.i32,
    gain: ti.f32,
    curve: Bytes,
    image: ti.types.ndarray(dtype=ti.u8, ndim=3),
):
    """Write the pixels that changed into images of the background; `display.encode` is the twin."""
    for at in range(frames * pixels):
        face = seen_face[at]
        if face != SAME:
            frame, number = at // pixels, at % pixels
            light = light_of(
                frame,
                number,
                at,
                vertices,
                face,
                seen_weights,
                on_patch,
                faces,
                radiance,
                undeformed,
                transmittance,
                remainder,
                ink,
                has_dots,
                ink_gain,
                inked_background,
            )
            for c in ti.static(range(3)):
                entry = tm.clamp(light[c] * gain, 0.0, float(curve.shape[0] - 1)) + 0.5
                image[frame, number, c] = curve[int(entry)]


@ti.kernel
def gather_light(
    frames: ti.i32,
    pixels: ti.i32,
    vertices: ti.i32,
    seen_face: Integers,
    seen_weights: Pairs,
    on_patch: Bytes,
    faces: IntegerRows,
    radiance: Vectors,
    undeformed: Vectors,
    transmittance: Floats,
    remainder: Vectors,
    ink: Floats,
    has_dots: ti.i32,
    ink_gain: ti.f32,
    inked_background: ti.i32,
    linear: VectorRows,
):
    """The same with linear light, shape (frames, pixels)."""
    for at in range(frames * pixels):
        face = seen_face[at]
        if face != SAME:
            frame, number = at // pixels, at % pixels
            linear[frame, number] = light_of(
                frame,
                number,
                at,
                vertices,
                face,
                seen_weights,
                on_patch,
                faces,
                radiance,
                undeformed,
                transmittance,
                remainder,
                ink,
                has_dots,
                ink_gain,
                inked_background,
            )
