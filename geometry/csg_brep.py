"""Descriptions to B-rep bodies by build123d, for STEP files.

Every boolean is checked by `workbench.core.booleans`. Tools are subtracted in one operation: the
kernel then intersects each pair of faces once. The result is accepted only if its volume is that
of the triangles, because a kernel that lost a feature says nothing.
"""

# OCP has no type stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import functools
from typing import Any

from geometry import csg
from geometry.solid import part_from_brep
from workbench.core.booleans import cut, fuse, intersect
from workbench.core.errors import GeometryError

SAME_VOLUME = 0.003
"""Largest relative difference of B-rep and triangles: chords of 0.02 mm cost up to 0.16 %."""


def has_brep(node: csg.Node) -> bool:
    """Whether every cast body of the description has a B-rep."""
    return all(body.brep.size for body in csg.bodies(node))


def checked(node: csg.Node, volume_mm3: float, *, what: str) -> Any:
    """The one solid of a description, if it has the volume of its triangles.

    Raises:
        GeometryError: If the kernel failed, or the volume differs by more than 0.3 %.
    """
    solid = evaluate(node, what=what)
    found = solid.solids()
    if len(found) != 1 or abs(solid.volume - volume_mm3) > SAME_VOLUME * volume_mm3:
        raise GeometryError(
            f"{what} by the CAD kernel has {len(found)} solids and {solid.volume:.6g} mm3, "
            f"its triangles {volume_mm3:.6g} mm3",
            hint="change the last shape parameter a little",
            at="shape",
        )
    return found[0]


def evaluate(node: csg.Node, *, what: str) -> Any:
    """The build123d body of a description.

    Raises:
        GeometryError: If a boolean did not do what it should.
    """
    from build123d import Plane, Polyline, Pos, Solid, extrude, make_face

    match node:
        case csg.Box():
            x, y, z = (high - low for low, high in zip(node.low_mm, node.high_mm, strict=True))
            return Pos(*node.low_mm) * Solid.make_box(x, y, z)
        case csg.Cone():
            height = node.high_mm - node.low_mm
            plane = Plane(origin=(0, 0, node.low_mm))
            low, high = node.low_radius_mm, node.high_radius_mm
            if low == high:
                return Solid.make_cylinder(low, height, plane)
            return Solid.make_cone(low, high, height, plane)
        case csg.Prism():
            corners = [(float(x), float(y), node.low_mm) for x, y in node.polygon_mm]
            face = make_face(Polyline(*corners, close=True))
            return extrude(face, node.high_mm - node.low_mm, (0, 0, 1)).solid()
        case csg.Body():
            return part_from_brep(node.brep)
        case csg.Union():
            bodies = (evaluate(part, what=what) for part in node.parts)
            return functools.reduce(lambda one, other: fuse(one, other, what=what), bodies)
        case csg.Difference():
            tools = [evaluate(tool, what=what) for tool in node.tools]
            return cut(evaluate(node.body, what=what), tools, what=what)
        case csg.Intersection():
            pair = (evaluate(node.body, what=what), evaluate(node.other, what=what))
            return intersect(*pair, what=what)
        case csg.Placed():
            return _placed(evaluate(node.body, what=what), node)


def _placed(body: Any, node: csg.Placed) -> Any:
    from build123d.topology import Shape
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
    from OCP.gp import gp_Trsf

    move = gp_Trsf()
    move.SetValues(*(float(value) for value in node.matrix.ravel()))
    return Shape.cast(BRepBuilderAPI_Transform(body.wrapped, move, True).Shape())
