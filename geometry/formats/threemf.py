"""3MF files: named parts in millimetres, as slicers read them.

Written by lib3mf, the reference library of the 3MF Consortium (BSD), which build123d brings along.
"""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Sequence
from typing import Any

import numpy as np

from workbench.core.result.fabrication import FabricationPart


def threemf_bytes(parts: Sequence[FabricationPart]) -> bytes:
    """One 3MF file with every part as an object of its own, in the assembled position."""
    wrapper = _wrapper()
    model = wrapper.CreateModel()
    model.SetUnit(_lib3mf().ModelUnit.MilliMeter)
    for part in parts:
        mesh = model.AddMeshObject()
        mesh.SetName(part.name)
        mesh.SetGeometry(*_geometry(part.points_mm, part.faces))
        model.AddBuildItem(mesh, wrapper.GetIdentityTransform())
    return bytes(model.QueryWriter("3mf").WriteToBuffer())


def _geometry(points_mm: np.ndarray, faces: np.ndarray) -> tuple[Any, Any]:
    """Arrays of lib3mf's own structures, filled as blocks of memory rather than one by one."""
    library = _lib3mf()
    vertices = (library.Position * len(points_mm))()
    triangles = (library.Triangle * len(faces))()
    points = np.ascontiguousarray(points_mm, dtype=np.float32)
    corners = np.ascontiguousarray(faces, dtype=np.uint32)
    ctypes.memmove(vertices, points.ctypes.data, points.nbytes)
    ctypes.memmove(triangles, corners.ctypes.data, corners.nbytes)
    return vertices, triangles


def _lib3mf() -> Any:
    from lib3mf import Lib3MF

    return Lib3MF


@functools.cache
def _wrapper() -> Any:
    from lib3mf import get_wrapper

    return get_wrapper()
