"""Arrays that travel together into the kernels of images, as one argument each.

V vertices, F faces, N pixels. Arrays "of all frames" are flat: entry frame * V + vertex, or
frame * N + pixel. Names of members differ between all bundles of a kernel, whose variables may not
be called so either: Taichi 1.7 loses one of two arrays that are called alike. Making a bundle takes
a third of a millisecond, putting a new array into one nothing, so they are made with what holds
them and kept.
"""

import taichi as ti
import taichi.math as tm

from sim.optics.light.kernel_types import (
    Bytes,
    FloatRows,
    Floats,
    FloatTables,
    FourRows,
    IntegerRows,
    Integers,
    NormalTables,
    Pairs,
    VectorRows,
    Vectors,
)

Skin = ti.types.argpack(points=Vectors, normals=Vectors, faces=IntegerRows)
"""At rest: places [mm] and outward unit normals, shape (V,); corners in the order of the tree,
(F, 3)."""
Fans = ti.types.argpack(area=Vectors, face_start=Integers, face_of=Integers)
"""Triangles around each vertex at rest: sum of their area vectors [mm2], shape (V,), and their
numbers from `face_start[vertex]` on."""
Sights = ti.types.argpack(
    start_pixel=Pairs, outward_to_camera=Vectors, foot_map=VectorRows, way_map=VectorRows
)
"""Where the camera sees vertices at rest, shape (V,), as in `SkinView`, and its map of rays."""
Posed = ti.types.argpack(placed=Vectors, turned=Vectors, to_camera=Vectors)
"""Vertices of all frames: place [mm], outward unit normal, unit vector to the camera. Only those
on a list are filled."""
Rays = ti.types.argpack(origin=Vectors, direction=Vectors, width=ti.i32, height=ti.i32, pad=ti.i32)
"""Of an image's pixels, shape (N,): where they enter the cavity [mm], and unit directions. The map
of rays reaches over the image by `pad` pixels on each side."""
Layers = ti.types.argpack(
    some_folded=ti.i32,
    folded=Bytes,
    layer_start=Integers,
    layer_face=Integers,
    layer_mm=Floats,
)
"""Triangles along each pixel's ray at rest, nearest first, and the pixels that must be cast."""
Tree = ti.types.argpack(
    levels=ti.i32,
    level_start=Integers,
    boxes=VectorRows,
    list_start=Integers,
    face_list=Integers,
)
"""Over the triangles that moved: how many levels a frame's tree has, where they begin among its
boxes (and, as the last number, how many boxes there are), corners of the boxes of all frames of
places [mm] and of normals, shape (-1, 4), and the list, with where each frame's begins. Lists and
boxes may be longer than what is used."""
Seen = ti.types.argpack(triangle=Integers, weights=Pairs, away_mm=Floats, on_patch=Bytes)
"""What pixels of all frames see: a triangle, -1 for none, `raster_kernels.SAME` for what they saw
at rest; weights of its second and third corner; length of the ray; whether it moved. Filled where
there is a triangle."""
Eye = ti.types.argpack(
    camera=tm.vec3, axis=tm.vec3, angular=ti.i32, focal_px=ti.f32, least_cosine=ti.f32
)
"""The camera's place [mm], unit axis and lens, as in `Backdrop`."""
PrintedDots = ti.types.argpack(dot_start=Integers, dot_of=Integers, centres=Vectors, radius=ti.f32)
"""Dots that each face can hold, from `dot_start[face]` on, their centres and radius [mm]."""
Picture = ti.types.argpack(
    faces=IntegerRows,
    radiance=Vectors,
    undeformed=Vectors,
    transmittance=Floats,
    lens_share=Floats,
    remainder=Vectors,
    ink=Floats,
    has_dots=ti.i32,
    ink_gain=ti.f32,
    inked_background=ti.i32,
)
"""What an image is composed of: `Skin.faces`, radiance of vertices of all frames and at rest, and
as in `Backdrop`; `ink` is the covered share of pixels of all frames, where there are dots."""
Lights = ti.types.argpack(
    light=FourRows,
    led=Vectors,
    led_axis=Vectors,
    led_rgb=Vectors,
    led_shape=Pairs,
    led_radius=Floats,
)
"""Light as it was baked, shape (V, L), and its L LEDs, as in `VertexLight`."""
ScatteredLight = ti.types.argpack(
    table=NormalTables, nodes=IntegerRows, weights=FloatRows, node_frames=FloatTables
)
"""Radiance by the tilt of the normal, as `look_up` takes it."""
Law = ti.types.argpack(
    way_of_lighting=ti.i32,
    diffuse=ti.f32,
    specular=ti.f32,
    gloss=ti.f32,
    ambient=tm.vec3,
    least_mm=ti.f32,
    full_shadow_mm=ti.f32,
    finest_shadow=ti.f32,
)
"""How light becomes radiance: the light model, the coating (`gloss` is Phong's exponent or GGX's
roughness), the radiance that ambient light adds, the displacements between which shadows fade in
[mm], and the least radius of a light over its distance that the mesh can show the shadow of [1]."""
Spots = ti.types.argpack(corners=IntegerRows, shares=FloatRows, smooth=Vectors, tilted=Vectors)
"""Points of the skin, shape (P,): vertices of their triangles and weights, shape (P, 3), and two
inward unit normals."""
