"""From what each pixel sees to its light, its ink and its grey levels.

image = background + (foreground deformed - foreground undeformed): `remainder` is the background
less the undeformed foreground, the foreground is vertex radiance interpolated and dimmed by the
walls. Pixels that see what they saw are the background, exactly.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti
import taichi.math as tm

from sim.optics.light.kernel_types import Bytes, Floats, Integers, VectorRows, Vectors
from sim.optics.raster.bundles import Eye, Picture, PrintedDots, Rays, Seen, Skin
from sim.optics.raster.raster_kernels import SAME


@ti.func
def blend(values: ti.template(), first, faces: ti.template(), face, weights):
    """A vertex quantity at weights (v, w) of a face's second and third corner."""
    total = values[first + faces[face, 0]] * (1.0 - weights.x - weights.y)
    total += values[first + faces[face, 1]] * weights.x
    return total + values[first + faces[face, 2]] * weights.y


@ti.func
def facing_way(at, first, way, seen: ti.template(), skin: ti.template(), turned: ti.template()):
    """The inward normal where a pixel looks, turned to face its line of sight; any length.

    `first` is the frame's first vertex of `turned`, the normals of the moved patch.
    """
    facing = tm.vec3(0.0)
    if seen.on_patch[at]:
        facing = -blend(turned, first, skin.faces, seen.triangle[at], seen.weights[at])
    else:
        facing = -blend(skin.normals, 0, skin.faces, seen.triangle[at], seen.weights[at])
    facing -= ti.max(facing.dot(way), 0.0) * way
    return facing


@ti.kernel
def describe(
    frames: ti.i32,
    seen: Seen,
    skin: Skin,
    turned: Vectors,
    rays: Rays,
    eye: Eye,
    normal: Vectors,
    depth: Floats,
):
    """Normals facing the camera and depth along its axis; NaN and 0 where there is no skin."""
    pixels, vertices = rays.direction.shape[0], skin.points.shape[0]
    for at in range(frames * pixels):
        face = seen.triangle[at]
        if face != SAME:
            frame, number = at // pixels, at % pixels
            facing, away = tm.vec3(0.0), tm.nan
            if face >= 0:
                way = rays.direction[number]
                facing = facing_way(at, frame * vertices, way, seen, skin, turned)
                facing /= ti.max(facing.norm(), 1e-12)
                place = rays.origin[number] + seen.away_mm[at] * way
                away = (place - eye.camera).dot(eye.axis)
            normal[at] = facing
            depth[at] = away


@ti.kernel
def spread_ink(
    frames: ti.i32,
    seen: Seen,
    skin: Skin,
    turned: Vectors,
    rays: Rays,
    eye: Eye,
    dots: PrintedDots,
    ink: Floats,
    marker: Integers,
):
    """Covered share of the pixels that changed, and the nearest dot; `markers.ink` is the twin."""
    pixels, vertices = rays.direction.shape[0], skin.points.shape[0]
    for at in range(frames * pixels):
        face = seen.triangle[at]
        if face != SAME:
            frame, number = at // pixels, at % pixels
            share, nearest, gap = 0.0, 0, 1e9
            if face >= 0 and dots.dot_start[face + 1] > dots.dot_start[face]:
                place = blend(skin.points, 0, skin.faces, face, seen.weights[at])
                for entry in range(dots.dot_start[face], dots.dot_start[face + 1]):
                    dot = dots.dot_of[entry]
                    distance = (dots.centres[dot] - place).norm()
                    if distance < gap:
                        gap, nearest = distance, dot
                way = rays.direction[number]
                facing = facing_way(at, frame * vertices, way, seen, skin, turned)
                cosine = -facing.dot(way) / ti.max(facing.norm(), 1e-12)
                line = rays.origin[number] + seen.away_mm[at] * way - eye.camera
                away = ti.abs(line.dot(eye.axis))
                if eye.angular:
                    away = (place - eye.camera).norm()
                footprint = away / eye.focal_px / ti.max(cosine, eye.least_cosine)
                step = tm.clamp((dots.radius - gap) / footprint + 0.5, 0.0, 1.0)
                share = step * step * (3.0 - 2.0 * step)
            ink[at] = share
            marker[at] = nearest


@ti.func
def light_of(frame, number, at, vertices, face, seen: ti.template(), picture: ti.template()):
    """Linear radiance of a pixel that changed."""
    arriving = tm.vec3(0.0)
    if face >= 0:
        if seen.on_patch[at]:
            arriving = blend(
                picture.radiance, frame * vertices, picture.faces, face, seen.weights[at]
            )
        else:
            arriving = blend(picture.undeformed, 0, picture.faces, face, seen.weights[at])
    arriving *= picture.transmittance[number]
    factor = 1.0
    if picture.has_dots:
        factor += (picture.ink_gain - 1.0) * picture.ink[at]
    kept = picture.remainder[number]
    if picture.inked_background:
        kept *= factor
    return ti.max(kept + factor * arriving, 0.0)


@ti.kernel
def expose(
    seen: Seen,
    picture: Picture,
    gain: tm.vec3,
    curve: Bytes,
    image: ti.types.ndarray(dtype=ti.u8, ndim=3),
):
    """Write the pixels that changed into images of the background; `image_sensor.develop` is the
    twin, of cameras without blur and noise.

    `image` has the shape (frames, N, 3).
    """
    pixels, vertices = image.shape[1], picture.undeformed.shape[0]
    for at in range(image.shape[0] * pixels):
        face = seen.triangle[at]
        if face != SAME:
            frame, number = at // pixels, at % pixels
            light = light_of(frame, number, at, vertices, face, seen, picture)
            light *= gain * picture.lens_share[number]
            for c in ti.static(range(3)):
                entry = tm.clamp(light[c], 0.0, float(curve.shape[0] - 1)) + 0.5
                image[frame, number, c] = curve[int(entry)]


@ti.kernel
def gather_light(seen: Seen, picture: Picture, linear: VectorRows):
    """The same with linear light, shape (frames, N)."""
    pixels, vertices = linear.shape[1], picture.undeformed.shape[0]
    for at in range(linear.shape[0] * pixels):
        face = seen.triangle[at]
        if face != SAME:
            frame, number = at // pixels, at % pixels
            linear[frame, number] = light_of(frame, number, at, vertices, face, seen, picture)
