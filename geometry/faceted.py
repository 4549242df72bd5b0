"""Triangles as a B-rep solid of planar facets, so that every part has a STEP file.

Used where a body exists only as triangles (signed-distance fallback, imported STL, tapered cores).
The triangles are first thinned out within a tolerance that grows until they are few enough, because
a STEP file takes about 2.4 kB a triangle.
"""

# OCP has no type stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from typing import Any

import numpy as np

from geometry.csg_brep import translated
from geometry.csg_mesh import arrays, closed
from workbench.core.errors import GeometryError

MOST_FACETS = 8000
"""Facets of a part: 19 MB of STEP and 2 s to write."""
FIRST_MM = 0.01
"""First tolerance of thinning out [mm]; it doubles until the facets are few enough."""
LAST_MM = 0.64


def faceted(points_mm: np.ndarray, faces: np.ndarray, *, what: str) -> Any:
    """One build123d solid of planar triangles.

    Raises:
        GeometryError: If even a tolerance of 0.64 mm leaves more than `MOST_FACETS` triangles, or
            the kernel made no valid solid of the same volume.
    """
    solid, tolerance_mm = closed(what, points_mm, faces), FIRST_MM
    wanted_mm3 = float(solid.volume())
    reason = ""
    while tolerance_mm <= LAST_MM:
        if solid.num_tri() <= MOST_FACETS:
            body = _on_mesh(*arrays(solid))
            if body is not None and _as_wanted(body, wanted_mm3):
                return body
            reason = "the CAD kernel makes no valid solid of them"
        # Also where the kernel failed: it refuses facets that are slivers.
        solid, tolerance_mm = solid.simplify(tolerance_mm), 2.0 * tolerance_mm
    raise GeometryError(
        f"{what} has {solid.num_tri()} facets after thinning out to {LAST_MM} mm: "
        f"{reason or f'more than the {MOST_FACETS} of a STEP file'}",
        hint="use its STL or 3MF file",
        at="mould",
    )


def _as_wanted(body: Any, wanted_mm3: float) -> bool:
    return abs(body.volume - wanted_mm3) <= 0.01 * wanted_mm3 and body.is_valid


def _on_mesh(points_mm: np.ndarray, faces: np.ndarray) -> Any | None:
    """The solid, or None where the kernel gives up."""
    from build123d.topology import Shape
    from OCP.BRep import BRep_Builder
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeShapeOnMesh
    from OCP.gp import gp_Pnt
    from OCP.Poly import Poly_Triangle, Poly_Triangulation
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS_Shell, TopoDS_Solid

    mesh = Poly_Triangulation(len(points_mm), len(faces), False)
    for number, point in enumerate(points_mm.tolist(), 1):
        mesh.SetNode(number, gp_Pnt(*point))
    for number, corners in enumerate((faces + 1).tolist(), 1):
        mesh.SetTriangle(number, Poly_Triangle(*corners))
    maker = BRepBuilderAPI_MakeShapeOnMesh(mesh)
    try:
        translated(maker.Build)
    except GeometryError:
        return None
    builder, shell, solid = BRep_Builder(), TopoDS_Shell(), TopoDS_Solid()
    builder.MakeShell(shell)
    explorer = TopExp_Explorer(maker.Shape(), TopAbs_ShapeEnum.TopAbs_FACE)
    while explorer.More():
        builder.Add(shell, explorer.Current())
        explorer.Next()
    shell.Closed(True)
    builder.MakeSolid(solid)
    builder.Add(solid, shell)
    return Shape.cast(solid)
