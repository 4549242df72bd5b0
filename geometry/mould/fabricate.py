"""A description to one printable part: triangles as a slicer will see them, and a B-rep if it can.

STL keeps float32 and no vertex numbers, so a part is judged after such a round trip. Edges shorter
than the rounding would tear it; they are collapsed first.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from geometry.body import csg
from geometry.body.csg_mesh import arrays, evaluate
from geometry.body.solid import part_from_brep
from geometry.formats.stl import welded
from geometry.mould.castability import Worst
from geometry.surface.surface import is_watertight, pieces, vertex_normals
from workbench.core.base.errors import GeometryError
from workbench.core.result.fabrication import FabricationPart, PartGroup

NO_BREP = np.zeros(0, dtype=np.uint8)
SHORTEST_MM = (0.0, 1e-5, 1e-4, 1e-3)
"""Edges collapsed in turn until the part survives an STL file [mm]; float32 resolves 4e-6 at 50."""
APART_MM = 2e-3
"""How far a vertex draws back from another in the same place [mm]: no printer sees it."""
TRIVIAL_SHARE = 1e-9
CRUMB_MM3 = 1e-6
"""A piece with less volume is rounding: a cube of a hundredth of a millimetre [mm3]."""
GIVEN_SHARE = 0.01
"""Largest relative difference of a part's triangles from the B-rep that the design has of it:
chords of 0.05 mm cost a thin shell 0.5 %."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PartPlan:
    """A printable part before it is made."""

    name: str
    """File name without ending: letters, digits, underscores."""
    node: csg.Node
    """Its body, in the assembled position."""
    group: PartGroup
    explode: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Where it stands in the exploded view, from its assembled place [mm]."""
    process: str = "3D print"
    """How it is made, for the build sheet."""
    brep: np.ndarray | None = None
    """Its B-rep where the design already has it, see `FabricationPart`; empty when there is none,
    None: it is made from the body."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Made:
    """A part and what its making has cost it."""

    part: FabricationPart
    reason: str
    """Why it has no exact B-rep; empty when it has."""
    lost: Worst
    """Share of its volume in loose pieces that were left away, and the middle of the largest."""


def fabricate(plan: PartPlan, *, keep_largest: bool = False) -> Made:
    """The part, as one closed body.

    Args:
        plan: What it is to be.
        keep_largest: Leave crumbs that cuts have separated away, instead of refusing the part; how
            much that was is told, for the caller to judge.

    Raises:
        GeometryError: If the part is empty or falls into pieces.
    """
    name, group = plan.name, plan.group
    solid = without_crumbs(evaluate(plan.node))
    lost = Worst(0.0, (0.0, 0.0, 0.0))
    if keep_largest:
        solid, lost = largest(solid)
    points, faces, closed = durable(solid)
    count = int(pieces(faces).max()) + 1 if len(faces) else 0
    if count != 1:
        raise GeometryError(
            f"part {name} falls into {count} pieces",
            hint="raise mould.wall_mm or housing.wall_mm, or lower mould.gate_diameter_mm",
            at="mould" if group is PartGroup.MOULD else "housing",
        )
    volume_mm3 = float(solid.volume())
    if lost.value > 0.0:
        reason = f"{name} had loose pieces, {100 * lost.value:.2g} % of it, which are left away"
        brep = NO_BREP
    else:
        brep, reason, volume_mm3 = _brep(plan, volume_mm3)
    if not closed:
        touching = f"{name} touches itself: its STL file is not closed where it does"
        reason = "; ".join(words for words in (reason, touching) if words)
    part = FabricationPart(
        name=name,
        group=group,
        points_mm=points,
        faces=faces,
        brep=brep,
        volume_mm3=volume_mm3,
        watertight=closed,
        explode=plan.explode,
        process=plan.process,
    )
    return Made(part=part, reason=reason, lost=lost)


def without_crumbs(solid: Any) -> Any:
    """A manifold without pieces of no volume, which cuts leave where two faces nearly coincide."""
    pieces_of = solid.decompose()
    if len(pieces_of) < 2:
        return solid
    import manifold3d

    kept = [piece for piece in pieces_of if float(piece.volume()) > CRUMB_MM3]
    return manifold3d.Manifold.compose(kept)


def largest(solid: Any) -> tuple[Any, Worst]:
    """The largest piece of a manifold, and what the others are of the whole."""
    loose = sorted(solid.decompose(), key=lambda piece: piece.volume(), reverse=True)
    if len(loose) < 2:
        return solid, Worst(0.0, (0.0, 0.0, 0.0))
    share = 1.0 - float(loose[0].volume()) / sum(float(piece.volume()) for piece in loose)
    box = np.array(loose[1].bounding_box())
    x, y, z = (float(value) for value in (box[:3] + box[3:]) / 2)
    # Crumbs may have no volume at all; that they were there is told all the same.
    return loose[0], Worst(max(share, TRIVIAL_SHARE), (x, y, z))


def durable(solid: Any) -> tuple[np.ndarray, np.ndarray, bool]:
    """Points (N, 3) [mm], faces (M, 3), and whether they stay closed through an STL file."""
    points, faces, closed = *arrays(solid), False
    for shortest_mm in SHORTEST_MM:
        points, faces = arrays(solid.simplify(shortest_mm) if shortest_mm else solid)
        for tried in (points, apart(points, faces)):
            closed = is_watertight(welded(stl_points(tried)[faces])[1])
            if closed:
                return tried, faces, closed
    return points, faces, closed


def apart(points_mm: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Vertices of which no two are in one place: where a body touches itself, both sides draw back.

    Along such an edge four triangles meet in a file that only knows places.
    """
    _, place, count = np.unique(
        stl_points(points_mm), axis=0, return_inverse=True, return_counts=True
    )
    touching = count[place.reshape(-1)] > 1
    if not touching.any():
        return points_mm
    normals = vertex_normals(points_mm, faces)
    return np.where(touching[:, None], points_mm - APART_MM * normals, points_mm)


def stl_points(points_mm: np.ndarray) -> np.ndarray:
    """Vertices as an STL file holds them [mm]: multiples of a nanometre in float32.

    float32 alone keeps 0 and 1e-17 apart, which other programs weld.
    """
    return (np.round(points_mm, 6) + 0.0).astype(np.float32)


def _brep(plan: PartPlan, volume_mm3: float) -> tuple[np.ndarray, str, float]:
    """The exact body, why there is none, and the best volume there is [mm3]."""
    from geometry.body.csg_brep import checked, has_brep, translated
    from geometry.body.solid import brep_bytes

    name, node, given = plan.name, plan.node, plan.brep
    if not (has_brep(node) if given is None else given.size):
        return NO_BREP, f"{name} has no exact CAD body: its STEP file has flat facets", volume_mm3

    def exact() -> tuple[np.ndarray, float]:
        if given is None:
            body = checked(node, volume_mm3, what=name)
            return brep_bytes(body), float(body.volume)
        return given, _same(float(part_from_brep(given).volume), volume_mm3)

    try:
        brep, exact_mm3 = translated(exact)
    except GeometryError as error:
        return NO_BREP, f"{name}: its STEP file has flat facets ({error.message})", volume_mm3
    return brep, "", exact_mm3


def _same(brep_mm3: float, volume_mm3: float) -> float:
    """The volume of a B-rep that was not made from the part's description, if it is the part's."""
    if abs(brep_mm3 - volume_mm3) > GIVEN_SHARE * volume_mm3:
        raise GeometryError(
            f"the CAD body has {brep_mm3:.6g} mm3, its triangles {volume_mm3:.6g} mm3",
            hint="change the last shape parameter a little",
            at="shape",
        )
    return brep_mm3
