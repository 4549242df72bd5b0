"""Descriptions to B-rep bodies by build123d, for STEP files.

Every boolean is checked by `workbench.core.base.booleans`. Tools are subtracted in one operation:
the kernel then intersects each pair of faces once. The result is accepted only if its volume is
that of the triangles, because a kernel that lost a feature says nothing.

The kernel's own errors become ours in `translated`, the one place that knows their kinds.
"""

# OCP has no type stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, TypeVar

from geometry.body import csg
from geometry.body.solid import part_from_brep
from workbench.core.base.booleans import cut, fuse, intersect
from workbench.core.base.errors import GeometryError

Built = TypeVar("Built")

SAME_VOLUME = 0.003
"""Largest relative difference of B-rep and triangles: chords of 0.02 mm cost up to 0.16 %."""


def translated(built: Callable[[], Built], *, what: str = "") -> Built:
    """What is built; errors of the CAD kernel and its wrapper become ours.

    Args:
        what: Name of the part, for the message.

    Raises:
        GeometryError: If the kernel refused.
    """
    try:
        return built()
    # OCP's errors have no base of their own: `StdFail_NotDone` and sixty others stand beside
    # `Standard_Failure`, each straight below Exception. Their module alone tells them.
    except Exception as error:
        if not of_kernel(error):
            raise
        raise GeometryError(
            f"{what}{': ' if what else ''}the CAD kernel failed: "
            f"{str(error).strip() or type(error).__name__}",
            hint="change the last shape parameter a little",
            at="shape",
        ) from error


def of_kernel(error: Exception) -> bool:
    """Whether OCP or build123d raised it; build123d raises plain ValueError and RuntimeError."""
    return isinstance(error, ValueError | RuntimeError) or type(error).__module__.startswith("OCP.")


def has_brep(node: csg.Node) -> bool:
    """Whether every cast body of the description has a B-rep."""
    return all(body.brep.size for body in csg.bodies(node))


def checked(node: csg.Node, volume_mm3: float, *, what: str) -> Any:
    """The one solid of a description, if it has the volume of its triangles.

    Raises:
        GeometryError: If the kernel failed, or the volume differs by more than 0.3 %.
    """

    def measured() -> tuple[list[Any], float]:
        solid = evaluate(node, what=what)
        return solid.solids(), float(solid.volume)

    found, made_mm3 = translated(measured, what=what)
    if len(found) != 1 or abs(made_mm3 - volume_mm3) > SAME_VOLUME * volume_mm3:
        raise GeometryError(
            f"{what} by the CAD kernel has {len(found)} solids and {made_mm3:.6g} mm3, "
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
