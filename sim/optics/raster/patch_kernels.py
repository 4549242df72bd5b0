"""What moved in each frame: its triangles and vertices as lists, and where the vertices are now.

Arrays over frames are flat: entry frame * V + vertex. Lists hold frame * F + face (or * V + vertex)
in ascending order, found by counting in chunks, so that they do not depend on the threads. Faces
are numbered in the order of the tree (`tree.order_of_faces`).
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti

from sim.optics.camera.projection_kernels import project
from sim.optics.light.kernel_types import (
    Bytes,
    IntegerRows,
    Integers,
    Longs,
    Pairs,
    VectorRows,
    Vectors,
)
from sim.optics.raster.bundles import Fans, Posed, Sights, Skin

CHUNK = 256
"""Entries that one thread counts; fixed, so that lists are the same on every machine."""


@ti.func
def face_moved(moved: ti.template(), faces: ti.template(), first_vertex, face):
    """Whether a corner of the face moved in the frame whose vertices begin at `first_vertex`."""
    return (
        moved[first_vertex + faces[face, 0]]
        | moved[first_vertex + faces[face, 1]]
        | moved[first_vertex + faces[face, 2]]
    )


@ti.kernel
def find_moved(
    displacement: VectorRows,
    faces: IntegerRows,
    least_square: ti.f32,
    moved: Bytes,
    used: Bytes,
    face_counts: Integers,
    vertex_counts: Integers,
):
    """Mark displaced vertices, and the corners of their triangles; count both per chunk."""
    frames, vertices = displacement.shape[0], displacement.shape[1]
    face_chunks = (faces.shape[0] + CHUNK - 1) // CHUNK
    vertex_chunks = (vertices + CHUNK - 1) // CHUNK
    for frame, vertex in ti.ndrange(frames, vertices):
        far = displacement[frame, vertex].norm_sqr() > least_square
        moved[frame * vertices + vertex] = ti.cast(far, ti.u8)
        used[frame * vertices + vertex] = ti.cast(0, ti.u8)
    for chunk in range(frames * face_chunks):
        frame, first = chunk // face_chunks, (chunk % face_chunks) * CHUNK
        count = 0
        for face in range(first, ti.min(first + CHUNK, faces.shape[0])):
            if face_moved(moved, faces, frame * vertices, face):
                count += 1
                for corner in ti.static(range(3)):
                    # Every thread that writes here writes the same.
                    used[frame * vertices + faces[face, corner]] = ti.cast(1, ti.u8)
        face_counts[chunk] = count
    for chunk in range(frames * vertex_chunks):
        frame, first = chunk // vertex_chunks, (chunk % vertex_chunks) * CHUNK
        count = 0
        for vertex in range(first, ti.min(first + CHUNK, vertices)):
            count += ti.cast(used[frame * vertices + vertex], ti.i32)
        vertex_counts[chunk] = count


@ti.kernel
def list_moved(
    frames: ti.i32,
    vertices: ti.i32,
    faces: IntegerRows,
    moved: Bytes,
    used: Bytes,
    face_starts: Integers,
    vertex_starts: Integers,
    face_list: Integers,
    vertex_list: Integers,
):
    """Write the lists; `starts` are where each chunk's entries begin."""
    face_chunks = (faces.shape[0] + CHUNK - 1) // CHUNK
    vertex_chunks = (vertices + CHUNK - 1) // CHUNK
    for chunk in range(frames * face_chunks):
        frame, first = chunk // face_chunks, (chunk % face_chunks) * CHUNK
        place = face_starts[chunk]
        for face in range(first, ti.min(first + CHUNK, faces.shape[0])):
            if face_moved(moved, faces, frame * vertices, face):
                face_list[place] = frame * faces.shape[0] + face
                place += 1
    for chunk in range(frames * vertex_chunks):
        frame, first = chunk // vertex_chunks, (chunk % vertex_chunks) * CHUNK
        place = vertex_starts[chunk]
        for vertex in range(first, ti.min(first + CHUNK, vertices)):
            if used[frame * vertices + vertex]:
                vertex_list[place] = frame * vertices + vertex
                place += 1


@ti.func
def area_of(places: ti.template(), first, faces: ti.template(), face):
    """Area vector of a face whose vertices' places begin at `first`."""
    a = places[first + faces[face, 0]]
    b, c = places[first + faces[face, 1]], places[first + faces[face, 2]]
    return 0.5 * (b - a).cross(c - a)


@ti.kernel
def place_vertices(
    count: ti.i32,
    vertex_list: Integers,
    displacement: VectorRows,
    moved: Bytes,
    skin: Skin,
    fans: Fans,
    sights: Sights,
    posed: Posed,
    pixel: Pairs,
):
    """Position, normal, pixel and direction to the camera of every vertex on the list.

    n' = unit(|A| n + A' - A) with A the sum of the area vectors of a vertex's triangles: equal to n
    where nothing moved, so that no seam shows.
    """
    vertices = skin.points.shape[0]
    for entry in range(count):
        at = vertex_list[entry]
        frame, vertex = at // vertices, at % vertices
        posed.placed[at] = skin.points[vertex]
        if moved[at]:
            posed.placed[at] += displacement[frame, vertex]
    for entry in range(count):
        at = vertex_list[entry]
        frame, vertex = at // vertices, at % vertices
        first = frame * vertices
        change = ti.Vector([0.0, 0.0, 0.0])
        for number in range(fans.face_start[vertex], fans.face_start[vertex + 1]):
            face = fans.face_of[number]
            if face_moved(moved, skin.faces, first, face):
                change += area_of(posed.placed, first, skin.faces, face)
                change -= area_of(skin.points, 0, skin.faces, face)
        normal = fans.area[vertex].norm() * skin.normals[vertex] + change
        posed.turned[at] = normal / ti.max(normal.norm(), 1e-12)
        pixel[at] = sights.start_pixel[vertex]
        posed.to_camera[at] = sights.outward_to_camera[vertex]
        if moved[at] and sights.start_pixel[vertex].x >= 0.0:
            place, way = project(
                posed.placed[at], sights.start_pixel[vertex], sights.foot_map, sights.way_map
            )
            pixel[at] = place
            posed.to_camera[at] = -way


@ti.kernel
def fill_keys(keys: Longs, high: ti.i32):
    """Give every pixel of every frame the same key."""
    for at in range(keys.shape[0]):
        keys[at] = ti.cast(high, ti.i64) << 32


@ti.kernel
def copy_rows(source: Vectors, target: Vectors):
    """Copy to the front of a longer array."""
    for at in range(source.shape[0]):
        target[at] = source[at]
