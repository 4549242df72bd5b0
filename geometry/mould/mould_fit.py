"""Whether the finished parts of a mould fit: what they overlap, and what they leave to be cast.

Both are volumes of triangle meshes by manifold3d, of the parts as they will be printed. What the
parts leave free of a box around the cast is found once; the cast must lie in it. Asking what of the
cast lies outside compares faces that look the same way, which is several times faster than
intersecting each part with the cast: there every face meets its own reverse. An overlap is refused
where it is more than a thousandth of a millimetre on all that touches: less is rounding.

Source: Lalish, manifold, https://github.com/elalish/manifold (guaranteed manifold output).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from geometry.body.csg import Body, Node
from geometry.body.csg_mesh import SLIVER_MM3, arrays, closed, evaluate, overlaps_mm3
from geometry.mould.cast import Cast
from geometry.mould.sweeping import LEAST_MM3, TOLERANCE_MM, tolerance_mm3
from workbench.core.base.errors import GeometryError
from workbench.core.result.fabrication import FabricationPart


class Fit(NamedTuple):
    """What was measured on the closed mould."""

    overlap_mm3: float
    """Largest overlap of two parts, or of the cast with all parts together [mm3]."""
    cavity_mm3: float
    """Silicone that the mould holds, gate and vents not counted [mm3]."""


def measure_fit(parts: Sequence[FabricationPart], cast: Cast, holes: Sequence[Node]) -> Fit:
    """Overlap and cavity of finished parts: a fault in a part shows here.

    Args:
        holes: Vents through the core, which lie inside the outer body but are no cavity.

    Raises:
        GeometryError: If parts overlap.
    """
    import manifold3d

    solids = {part.name: closed(part.name, part.points_mm, part.faces) for part in parts}
    low, high = cast.corners_mm
    room = manifold3d.Manifold.cube(high - low).translate(low)
    subtract = manifold3d.OpType.Subtract
    free = manifold3d.Manifold.batch_boolean([room, *solids.values()], subtract)
    shared = overlaps_mm3(solids)
    for (one, other), found_mm3 in shared.items():
        if found_mm3 > LEAST_MM3:
            _check(f"{one} and {other}", found_mm3, tolerance_mm3(solids[one], solids[other]))
    outside_mm3 = _outside_mm3(cast, free)
    # All of the cast's surface touches the parts.
    area_mm2 = sum(float(body.surface_area()) for body in map(evaluate, _bodies(cast)))
    _check("the cast and its mould", outside_mm3, max(LEAST_MM3, TOLERANCE_MM * area_mm2))
    cavity = manifold3d.Manifold.batch_boolean([free, *map(evaluate, holes)], subtract)
    # Vents through outer parts reach into the box around the cast; they are not the cavity.
    return Fit(max(*shared.values(), outside_mm3), float((cavity ^ evaluate(cast.outer)).volume()))


def _check(what: str, overlap_mm3: float, limit_mm3: float) -> None:
    """Refuse an overlap that is more than the rounding of faces that touch."""
    if overlap_mm3 > limit_mm3:
        raise GeometryError(
            f"mould parts overlap by {overlap_mm3:.3g} mm3, more than {limit_mm3:.3g} mm3: {what}",
            hint="raise mould.clearance_mm, or change the last shape parameter a little",
            at="mould",
        )


def _bodies(cast: Cast) -> list[Body]:
    return [cast.outer] if cast.core is None else [cast.outer, cast.core]


def _outside_mm3(cast: Cast, free: Any) -> float:
    """Volume of the cast that is not in the free room [mm3].

    Found as what is left of the cast and, where that is not nothing, as what its share lacks: where
    faces coincide, either may hold slivers of 1e-4 mm3 of nothing; a true overlap is in both.
    """
    body = evaluate(cast.outer)
    if cast.core is not None:
        body = body - evaluate(cast.core)
    # Through arrays like the parts: with another history, slivers of 1e-4 mm3 appear.
    body = closed("cast", *arrays(body))
    left = float((body - free).volume())
    lacking = float(body.volume() - (body ^ free).volume()) if left > SLIVER_MM3 else left
    return max(0.0, min(left, lacking))
