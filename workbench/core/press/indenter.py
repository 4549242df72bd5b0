"""The object that is pressed into the skin: its shape, and its elastomer where it is not rigid.

The paper presses 14 indenters, ten of which its networks saw in training. Source of the names and
of their split: SimTac, Fig. 6c (indenters 1-10 seen, 11-14 unseen), in the order of that figure as
far as it is known; the paper gives no dimensions: those of the kinds are ours.
"""

from __future__ import annotations

import enum
from dataclasses import KW_ONLY, dataclass, field

import numpy as np

from workbench.core.base.check import expect, within
from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.core.design.turning import AS_IT_CAME, FARTHEST_DEG, Angles, turn_matrix
from workbench.core.objects.kind import Group, Kind, Shape, kind_of, kinds
from workbench.core.press.soft_body import SoftBody
from workbench.core.press.texture import SMOOTH, Texture


class IndenterKind(enum.StrEnum):
    """Shapes: the files of `workbench.core.objects.kinds`, and the heads that were released.

    Body +Z points away from the skin, the body origin is the shape's centre. `size_mm` is the
    largest width. Prisms stand on their end and are as high as wide.
    """

    _ignore_ = "kind"
    for kind in kinds():
        vars()[kind.upper()] = kind


def _group(group: Group) -> tuple[IndenterKind, ...]:
    return tuple(IndenterKind(name) for name, kind in kinds().items() if kind.group is group)


SEEN = _group(Group.SEEN)
"""The paper's indenters 1 to 10, with which its networks were trained."""
UNSEEN = _group(Group.UNSEEN)
"""The paper's indenters 11 to 14, kept for testing."""
OF_TRIANGLES = next(IndenterKind(name) for name, kind in kinds().items() if kind.of_triangles)
"""The kind whose shape is a mesh of the designer's own."""
BALL = IndenterKind("sphere")
"""What presses where nothing is said."""

DEFAULT_SIZE_MM = 6.0
DEFAULT_EDGE_RADIUS_MM = 0.45
"""Rounding of edges [mm]: sharper than a grid cell cannot be resolved. Same as in the FEM."""
LARGEST_MM = 100.0
LARGEST_MESH_MM = 300.0
"""A screwdriver is 215 mm long."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class IndenterMesh:
    """A closed triangle mesh in the indenter's body frame; compared by identity."""

    points_mm: np.ndarray
    """Vertices [mm], shape (N, 3), float64, centred on the bounding box."""
    faces: np.ndarray
    """Triangles, shape (M, 3), int32, counter-clockwise from outside."""
    notice: str = field(default="", metadata={"cosmetic": True})
    """What was done to the file, for people."""

    def __post_init__(self) -> None:
        expect(self.points_mm, "N 3", name="indenter points")
        expect(self.faces, "M 3", name="indenter faces")


def widest_edge_mm(kind: IndenterKind, size_mm: float) -> float | None:
    """Largest edge radius that a kind takes at a size [mm]; None where it has no edges."""
    share = kind_of(kind).edge_share
    return None if share is None else share * size_mm


@dataclass(frozen=True, slots=True)
class Indenter:
    """An object, rigid unless it has an elastomer."""

    kind: IndenterKind = BALL
    """Its shape; a plain name such as "sphere" does as well."""
    _: KW_ONLY
    size_mm: float = DEFAULT_SIZE_MM
    """Diameter, else the largest width [mm]."""
    edge_radius_mm: float = DEFAULT_EDGE_RADIUS_MM
    """Rounding radius of edges and tips [mm]; kinds without edges and a mesh ignore it."""
    mesh: IndenterMesh | None = None
    mesh_rounding_mm: float = 0.0
    """Rounds the convex edges of a mesh [mm]; parts thinner than twice this vanish. 0: as it is."""
    texture: Texture = SMOOTH
    """Pattern on the side that meets the skin."""
    soft: SoftBody | None = None
    """Its elastomer; None: rigid."""
    turn_deg: Angles = field(default=AS_IT_CAME, metadata={"later": True})
    """Turn about the fixed X, then Y, then Z before the press [degree]: its side that is -Z then
    meets the skin. Texture and what is held of a soft object stay where they are: on the touching
    side, and away from it."""

    def __post_init__(self) -> None:
        kinds = [kind.value for kind in IndenterKind]
        if self.kind not in kinds:
            hint = f"{suggest(str(self.kind), kinds)}; `choose_indenter` also takes files"
            raise DesignError(
                f"there is no indenter {shown(self.kind)}", hint=hint, at="indenter.kind"
            )
        object.__setattr__(self, "kind", IndenterKind(self.kind))
        hint = "the default is 6 mm"
        at = "indenter.size_mm"
        largest = LARGEST_MESH_MM if self.record.of_triangles else LARGEST_MM
        within(self.size_mm, 0.5, largest, what="indenter size", unit="mm", at=at, hint=hint)
        at = "indenter.edge_radius_mm"
        widest = widest_edge_mm(self.kind, self.size_mm)
        if widest is not None:
            within(self.edge_radius_mm, 0.0, widest, what="edge radius", unit="mm", at=at)
        self._check_mesh()
        at = "indenter.turn_deg"
        # Whole numbers are the same turn, and must be the same key.
        object.__setattr__(self, "turn_deg", tuple(float(angle) for angle in self.turn_deg))
        for angle in self.turn_deg:
            within(angle, -FARTHEST_DEG, FARTHEST_DEG, what="turn", unit="degree", at=at)
        at = "indenter.texture.height_mm"
        # The upper half of the body takes the displacement up, so it must be thicker than that.
        tallest = self.size_mm / 10
        if self.texture.raised:
            within(self.texture.height_mm, 0.0, tallest, what="texture height", unit="mm", at=at)

    @property
    def record(self) -> Kind:
        """What its kind says of itself."""
        return kind_of(self.kind)

    @property
    def turned(self) -> bool:
        """Whether it stands otherwise than it came; a ball never does."""
        return any(self.turn_deg) and self.record.shape is not Shape.SPHERE

    @property
    def standing_mesh(self) -> IndenterMesh | None:
        """Its mesh as it is turned, in the body frame."""
        if self.mesh is None or not self.turned:
            return self.mesh
        turned_mm = self.mesh.points_mm @ turn_matrix(self.turn_deg).T
        return IndenterMesh(points_mm=turned_mm, faces=self.mesh.faces, notice=self.mesh.notice)

    def _check_mesh(self) -> None:
        if self.record.of_triangles != (self.mesh is not None):
            raise DesignError(
                f"indenter kind {self.kind} {'needs a' if self.mesh is None else 'takes no'} mesh",
                hint="load an STL, OBJ or STEP file, or choose a primitive",
                at="indenter.mesh",
            )
        at = "indenter.mesh_rounding_mm"
        widest = self.size_mm / 4 if self.mesh is not None else 0.0
        hint = "" if self.mesh is not None else "other kinds than a mesh have edge_radius_mm"
        rounding = self.mesh_rounding_mm
        within(rounding, 0.0, widest, what="mesh rounding", unit="mm", at=at, hint=hint)
