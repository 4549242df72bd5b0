"""Which triangle each pixel sees, by drawing only those that moved.

The undeformed skin was cast once; each pixel keeps the triangles along its ray, nearest first (its
layers). Per frame a moved triangle is drawn over the pixels that its corners' projections bound.
Each such pixel's own ray is intersected with the triangle, so that position and weights are those
of ray casting, perspective and refraction included; the projection only says where to look. A
pixel sees the nearer of what was drawn and the first of its layers that has not moved.

Pixels keep a 64-bit key, distance above face: an atomic minimum orders the triangles whatever the
order of threads. Rays are cast against the tree of moved triangles where projecting is not enough:
in folded pixels, and where a triangle moved away and nothing was drawn.
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
    Longs,
    Pairs,
    Vectors,
)
from sim.optics.raster.patch_kernels import face_moved
from sim.optics.raster.tree_kernels import NOTHING_MM, meet, nearest

UNTOUCHED = 0x7FFFFFFF
"""High word of the key of a pixel that sees what it saw."""
UNCOVERED = 0x7FFFFFFE
"""The same where its undeformed triangle moved and nothing has been drawn."""
MARGIN_PX = 0.75
"""How far a triangle may reach over the box of its corners [px]: refraction bends its edges."""
LARGEST_BOX = 0.25
"""Largest box of a triangle, as a share of the image [1]."""
SAME = -2
"""Instead of a face: a pixel that is as in the background. One that sees no skin has -1."""


@ti.func
def key_of(high, low):
    return (ti.cast(high, ti.i64) << 32) | ti.cast(low, ti.i64)


@ti.kernel
def draw(
    count: ti.i32,
    face_list: Integers,
    faces: IntegerRows,
    vertices: ti.i32,
    width: ti.i32,
    height: ti.i32,
    pad: ti.i32,
    placed: Vectors,
    pixel: Pairs,
    origin: Vectors,
    direction: Vectors,
    seen_start: Integers,
    seen_pixel: Integers,
    keys: Longs,
):
    """Uncover the pixels that saw the listed triangles, and draw these where they are now."""
    for entry in range(count):
        at = face_list[entry]
        frame, face = at // faces.shape[0], at % faces.shape[0]
        first_pixel = frame * width * height
        for place in range(seen_start[face], seen_start[face + 1]):
            ti.atomic_min(keys[first_pixel + seen_pixel[place]], key_of(UNCOVERED, 0))
        base = frame * vertices
        a, b, c = base + faces[face, 0], base + faces[face, 1], base + faces[face, 2]
        p, q, r = pixel[a], pixel[b], pixel[c]
        # Corners without a pixel have a negative one; the others still bound a part to draw.
        if p.x >= 0.0 or q.x >= 0.0 or r.x >= 0.0:
            least, most = tm.vec2(NOTHING_MM), tm.vec2(-NOTHING_MM)
            for corner in ti.static((p, q, r)):
                if corner.x >= 0.0:
                    least, most = ti.min(least, corner), ti.max(most, corner)
            left = ti.max(int(ti.ceil(least.x - MARGIN_PX)) - pad, 0)
            right = ti.min(int(ti.floor(most.x + MARGIN_PX)) - pad, width - 1)
            top = ti.max(int(ti.ceil(least.y - MARGIN_PX)) - pad, 0)
            bottom = ti.min(int(ti.floor(most.y + MARGIN_PX)) - pad, height - 1)
            # A corner projected amiss makes a box of half the image; such pixels are cast.
            if (right - left) * (bottom - top) > LARGEST_BOX * width * height:
                bottom = top - 1
            for row in range(top, bottom + 1):
                for column in range(left, right + 1):
                    number = row * width + column
                    distance, _v, _w = meet(
                        origin[number], direction[number], placed[a], placed[b], placed[c]
                    )
                    if distance >= 0.0:
                        high = ti.bit_cast(ti.cast(distance, ti.f32), ti.i32)
                        ti.atomic_min(keys[first_pixel + number], key_of(high, face))


@ti.kernel
def resolve(
    frames: ti.i32,
    vertices: ti.i32,
    pixels: ti.i32,
    keys: Longs,
    moved: Bytes,
    faces: IntegerRows,
    points: Vectors,
    normals: Vectors,
    placed: Vectors,
    origin: Vectors,
    direction: Vectors,
    some_folded: ti.i32,
    folded: Bytes,
    layer_start: Integers,
    layer_face: Integers,
    layer_mm: Floats,
    levels: ti.i32,
    boxes: ti.i32,
    level_start: Integers,
    level_count: Integers,
    list_start: Integers,
    face_list: Integers,
    low: Vectors,
    high: Vectors,
    normal_low: Vectors,
    normal_high: Vectors,
    seen_face: Integers,
    seen_weights: Pairs,
    seen_mm: Floats,
    on_patch: Bytes,
):
    """Decide what every pixel of every frame sees, and make the keys ready for the next frames."""
    for at in range(frames * pixels):
        key = keys[at]
        word = ti.cast(key >> 32, ti.i32)
        found = SAME
        number = at
        if frames > 1:
            number = at % pixels
        if word != UNTOUCHED or (some_folded and folded[number]):
            frame = at // pixels
            keys[at] = key_of(UNTOUCHED, 0)
            face, distance = -1, NOTHING_MM
            if word < UNCOVERED:
                face = ti.cast(key & ti.cast(0x7FFFFFFF, ti.i64), ti.i32)
                distance = ti.bit_cast(word, ti.f32)
            still, still_mm = -1, NOTHING_MM
            uncovered = False
            for layer in range(layer_start[number], layer_start[number + 1]):
                if still < 0:
                    behind = layer_face[layer]
                    if face_moved(moved, faces, frame * vertices, behind):
                        uncovered = uncovered or layer == layer_start[number]
                    else:
                        still, still_mm = behind, layer_mm[layer]
            if folded[number] or (face < 0 and still < 0):
                face, distance = nearest(
                    frame,
                    origin[number],
                    direction[number],
                    NOTHING_MM,
                    False,
                    levels,
                    boxes,
                    vertices,
                    level_start,
                    level_count,
                    list_start,
                    face_list,
                    faces,
                    normals,
                    placed,
                    low,
                    high,
                    normal_low,
                    normal_high,
                )
            patch = face >= 0 and distance < still_mm
            if patch or uncovered:
                found = face if patch else still
            if found >= 0:
                a, b, c = faces[found, 0], faces[found, 1], faces[found, 2]
                p, q, r = points[a], points[b], points[c]
                if patch:
                    base = frame * vertices
                    p, q, r = placed[base + a], placed[base + b], placed[base + c]
                _far, v, w = meet(origin[number], direction[number], p, q, r)
                v, w = tm.clamp(v, 0.0, 1.0), tm.clamp(w, 0.0, 1.0)
                excess = ti.max(v + w, 1.0)
                seen_weights[at] = tm.vec2(v / excess, w / excess)
                seen_mm[at] = distance if patch else still_mm
                on_patch[at] = ti.cast(patch, ti.u8)
        seen_face[at] = found
