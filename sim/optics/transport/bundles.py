"""Arrays that travel together into the kernels of traced light, as one argument each."""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportCallIssue=false

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import taichi as ti
import taichi.math as tm

from sim.optics.light.kernel_types import Floats, Integers
from sim.optics.transport.scene import Scene
from sim.optics.transport.sources import Sources
from sim.optics.transport.tally import Tally

Points = ti.types.ndarray(dtype=tm.vec3, ndim=1)
Triples = ti.types.ndarray(dtype=tm.ivec3, ndim=1)
_Frames = ti.types.ndarray(dtype=tm.vec3, ndim=2)

SceneArrays = ti.types.argpack(
    points=Points, normals=Points, faces=Triples, skin_faces=ti.i32, optics=tm.vec4
)
"""Of a `Scene`; `optics` holds albedo, specular share and roughness of the coating, and the
refractive index."""
Lamps = ti.types.argpack(
    positions=Points, axes=Points, emission=Points, in_shell=Integers, power=Points
)
"""Of `Sources`."""
Books = ti.types.argpack(
    ledger=ti.types.ndarray(dtype=ti.i64, ndim=2),
    face_nodes=Triples,
    face_weights=_Frames,
    frames=_Frames,
    bins=ti.types.ndarray(dtype=ti.i64, ndim=4),
    lamps=ti.types.ndarray(dtype=ti.i64, ndim=3),
    to_camera=Points,
    radiance=ti.types.ndarray(dtype=ti.i64, ndim=2),
)
"""Of a `Tally`: tables that are read, and sums that grow."""
Boxes = ti.types.argpack(lower=Points, upper=Points, starts=Integers, order=Integers)
"""Of a `Tree`."""
Flight = ti.types.argpack(
    origins=Points, directions=Points, fluxes=Floats, marks=Integers, alive=Integers
)
"""Photons between two events, a row each; `marks` is fresh + 2 crossed, `alive` is written."""
Hits = ti.types.argpack(face=Integers, u=Floats, v=Floats)
"""What the rays of a flight meet; face -1 is nothing."""
SUMS = ("ledger", "bins", "lamps", "radiance")
"""What of `Books` grows."""

Place = Callable[..., Any]
"""Puts a NumPy array where a kernel reads it; `vector` is the length of its last axis."""


def as_it_is(array: np.ndarray, *, vector: int = 0) -> np.ndarray:
    """The array itself: kernels on a processor read NumPy's own memory."""
    return array


def scene_arrays(scene: Scene, place: Place = as_it_is) -> Any:
    """`SceneArrays` of a scene."""
    coating = scene.coating
    lobes = coating.albedo, coating.specular, coating.roughness
    return SceneArrays(
        points=place(scene.points_mm, vector=3),
        normals=place(scene.normals, vector=3),
        faces=place(scene.faces, vector=3),
        skin_faces=scene.skin_faces,
        optics=tm.vec4(*lobes, scene.refractive_index),
    )


def lamp_arrays(sources: Sources, place: Place = as_it_is) -> Any:
    """`Lamps` of lights."""
    return Lamps(
        positions=place(sources.position_mm, vector=3),
        axes=place(sources.axis, vector=3),
        emission=place(sources.emission, vector=3),
        in_shell=place(sources.in_shell),
        power=place(sources.power, vector=3),
    )


def books_of(tally: Tally, place: Place = as_it_is) -> tuple[Any, dict[str, Any]]:
    """`Books` of a tally, and its sums as they were placed, by name."""
    sums = {name: place(getattr(tally, name)) for name in SUMS}
    tables = {
        name: place(getattr(tally, name), vector=3)
        for name in ("face_nodes", "face_weights", "frames", "to_camera")
    }
    return Books(**sums, **tables), sums
