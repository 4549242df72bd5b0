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

from sim.optics.light.kernel_types import Bytes, Integers, Longs, Pairs, Vectors
from sim.optics.raster.bundles import Layers, Rays, Seen, Skin, Tree
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
    skin: Skin,
    placed: Vectors,
    pixel: Pairs,
    rays: Rays,
    seen_start: Integers,
    seen_pixel: Integers,
    keys: Longs,
):
    """Uncover the pixels that saw the listed triangles, and draw these where they are now."""
    vertices = skin.points.shape[0]
    for entry in range(count):
        at = face_list[entry]
        frame, face = at // skin.faces.shape[0], at % skin.faces.shape[0]
        first_pixel = frame * rays.width * rays.height
        for place in range(seen_start[face], seen_start[face + 1]):
            ti.atomic_min(keys[first_pixel + seen_pixel[place]], key_of(UNCOVERED, 0))
        base = frame * vertices
        a, b, c = base + skin.faces[face, 0], base + skin.faces[face, 1], base + skin.faces[face, 2]
        p, q, r = pixel[a], pixel[b], pixel[c]
        # Corners without a pixel have a negative one; the others still bound a part to draw.
        if p.x >= 0.0 or q.x >= 0.0 or r.x >= 0.0:
            least, most = tm.vec2(NOTHING_MM), tm.vec2(-NOTHING_MM)
            for corner in ti.static((p, q, r)):
                if corner.x >= 0.0:
                    least, most = ti.min(least, corner), ti.max(most, corner)
            left = ti.max(int(ti.ceil(least.x - MARGIN_PX)) - rays.pad, 0)
            right = ti.min(int(ti.floor(most.x + MARGIN_PX)) - rays.pad, rays.width - 1)
            top = ti.max(int(ti.ceil(least.y - MARGIN_PX)) - rays.pad, 0)
            bottom = ti.min(int(ti.floor(most.y + MARGIN_PX)) - rays.pad, rays.height - 1)
            # A corner projected amiss makes a box of half the image; such pixels are cast.
            if (right - left) * (bottom - top) > LARGEST_BOX * rays.width * rays.height:
                bottom = top - 1
            for row in range(top, bottom + 1):
                for column in range(left, right + 1):
                    number = row * rays.width + column
                    start, way = rays.origin[number], rays.direction[number]
                    distance, _v, _w = meet(start, way, placed[a], placed[b], placed[c])
                    if distance >= 0.0:
                        high = ti.bit_cast(ti.cast(distance, ti.f32), ti.i32)
                        ti.atomic_min(keys[first_pixel + number], key_of(high, face))


@ti.kernel
def resolve(
    frames: ti.i32,
    keys: Longs,
    moved: Bytes,
    skin: Skin,
    placed: Vectors,
    rays: Rays,
    layers: Layers,
    tree: Tree,
    seen: Seen,
):
    """Decide what every pixel of every frame sees, and make the keys ready for the next frames."""
    pixels, vertices = rays.direction.shape[0], skin.points.shape[0]
    for at in range(frames * pixels):
        key = keys[at]
        word = ti.cast(key >> 32, ti.i32)
        found = SAME
        number = at
        if frames > 1:
            number = at % pixels
        if word != UNTOUCHED or (layers.some_folded and layers.folded[number]):
            frame = at // pixels
            keys[at] = key_of(UNTOUCHED, 0)
            face, distance = -1, NOTHING_MM
            if word < UNCOVERED:
                face = ti.cast(key & ti.cast(0x7FFFFFFF, ti.i64), ti.i32)
                distance = ti.bit_cast(word, ti.f32)
            still, still_mm = -1, NOTHING_MM
            uncovered = False
            first = layers.layer_start[number]
            for layer in range(first, layers.layer_start[number + 1]):
                if still < 0:
                    behind = layers.layer_face[layer]
                    if face_moved(moved, skin.faces, frame * vertices, behind):
                        uncovered = uncovered or layer == first
                    else:
                        still, still_mm = behind, layers.layer_mm[layer]
            if layers.folded[number] or (face < 0 and still < 0):
                start, way = rays.origin[number], rays.direction[number]
                face, distance = nearest(frame, start, way, NOTHING_MM, False, tree, skin, placed)
            patch = face >= 0 and distance < still_mm
            if patch or uncovered:
                found = face if patch else still
            if found >= 0:
                a, b, c = skin.faces[found, 0], skin.faces[found, 1], skin.faces[found, 2]
                p, q, r = skin.points[a], skin.points[b], skin.points[c]
                if patch:
                    base = frame * vertices
                    p, q, r = placed[base + a], placed[base + b], placed[base + c]
                _far, v, w = meet(rays.origin[number], rays.direction[number], p, q, r)
                v, w = tm.clamp(v, 0.0, 1.0), tm.clamp(w, 0.0, 1.0)
                excess = ti.max(v + w, 1.0)
                seen.weights[at] = tm.vec2(v / excess, w / excess)
                seen.away_mm[at] = distance if patch else still_mm
                seen.on_patch[at] = ti.cast(patch, ti.u8)
        seen.triangle[at] = found
