"""A description to one printable part: triangles as a slicer will see them, and a B-rep if it can.

STL keeps float32 and no vertex numbers, so a part is judged after such a round trip. Edges shorter
than the rounding would tear it; they are collapsed first.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from geometry import csg
from geometry.csg_mesh import arrays, evaluate
from geometry.solid import part_from_brep
from geometry.stl import welded
from geometry.surface import is_watertight, pieces
from workbench.core.errors import GeometryError
from workbench.core.fabrication import FabricationPart, PartGroup

NO_BREP = np.zeros(0, dtype=np.uint8)
SHORTEST_MM = (0.0, 1e-5, 1e-4, 1e-3)
"""Edges collapsed in turn until the part survives an STL file [mm]; float32 resolves 4e-6 at 50."""


def fabricate(
    name: str,
    node: csg.Node,
    *,
    group: PartGroup,
    explode: tuple[float, float, float],
    pull: tuple[float, float, float] = (0.0, 0.0, 0.0),
    process: str = "3D print",
    keep_largest: bool = False,
    brep: np.ndarray | None = None,
) -> tuple[FabricationPart, str]:
    """The part, and why it has no exact B-rep (empty when it has).

    Args:
        keep_largest: Leave crumbs that cuts have separated away, instead of refusing the part.
        brep: The part's B-rep where the design already has it; empty when it has none.

    Raises:
        GeometryError: If the part is empty or falls into pieces.
    """
    solid = evaluate(node)
    pieces_of = solid.decompose() if keep_largest else [solid]
    whole = len(pieces_of) == 1
    if not whole:
        solid = max(pieces_of, key=lambda piece: piece.volume(), default=solid)
    points, faces, closed = durable(solid)
    count = int(pieces(faces).max()) + 1 if len(faces) else 0
    if count != 1:
        raise GeometryError(
            f"part {name} falls into {count} pieces",
            hint="raise mould.wall_mm or housing.wall_mm, or lower mould.gate_diameter_mm",
            at="mould" if group is PartGroup.MOULD else "housing",
        )
    reason, volume_mm3 = "", float(solid.volume())
    if brep is None and whole:
        brep, reason, volume_mm3 = _brep(node, volume_mm3, name)
    elif brep is None:
        brep, reason = NO_BREP, f"{name} had loose pieces, which are left away"
    elif brep.size:
        volume_mm3 = float(part_from_brep(brep).volume)
    part = FabricationPart(
        name=name,
        group=group,
        points_mm=points,
        faces=faces,
        brep=brep,
        volume_mm3=volume_mm3,
        watertight=closed,
        explode=explode,
        pull=pull,
        process=process,
    )
    return part, reason


def durable(solid: Any) -> tuple[np.ndarray, np.ndarray, bool]:
    """Points (N, 3) [mm], faces (M, 3), and whether they stay closed through an STL file."""
    points, faces, closed = *arrays(solid), False
    for shortest_mm in SHORTEST_MM:
        points, faces = arrays(solid.simplify(shortest_mm) if shortest_mm else solid)
        closed = is_watertight(welded(stl_points(points)[faces])[1])
        if closed:
            break
    return points, faces, closed


def stl_points(points_mm: np.ndarray) -> np.ndarray:
    """Vertices as an STL file holds them [mm]: multiples of a nanometre in float32.

    float32 alone keeps 0 and 1e-17 apart, which other programs weld.
    """
    return (np.round(points_mm, 6) + 0.0).astype(np.float32)


def _brep(node: csg.Node, volume_mm3: float, name: str) -> tuple[np.ndarray, str, float]:
    """The exact body, why there is none, and the best volume there is [mm3]."""
    from geometry.csg_brep import checked, has_brep
    from geometry.solid import brep_bytes

    if not has_brep(node):
        return NO_BREP, f"{name} has no exact CAD body: its STEP file has flat facets", volume_mm3
    try:
        body = checked(node, volume_mm3, what=name)
    except GeometryError as error:
        return NO_BREP, f"{name}: its STEP file has flat facets ({error.message})", volume_mm3
    return brep_bytes(body), "", float(body.volume)
