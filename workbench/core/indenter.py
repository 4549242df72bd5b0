"""The object that is pressed into the skin: its shape, and its elastomer where it is not rigid.

The paper presses 14 indenters, ten of which its networks saw in training. Source of the names and
of their split: SimTac, Fig. 6c (indenters 1-10 seen, 11-14 unseen), in the order of that figure as
far as it is known; the paper gives no dimensions: those in `sim.contact.objects.solids` are ours.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass, field

import numpy as np

from workbench.core.check import expect, within
from workbench.core.errors import DesignError
from workbench.core.soft_body import SoftBody
from workbench.core.texture import SMOOTH, Texture
from workbench.core.turning import AS_IT_CAME, FARTHEST_DEG, Angles, turn_matrix


class IndenterKind(enum.StrEnum):
    """Shapes; body +Z points away from the skin, the body origin is the shape's centre.

    `size_mm` is the largest width. Those called prisms stand on their end and are as high as wide.
    """

    SPHERE = "sphere"
    """A ball of diameter `size_mm`."""
    CYLINDER_END = "cylinder_end"
    """Axis along the approach: presses with its flat end."""
    CYLINDER_SIDE = "cylinder_side"
    """Axis along body +Y: presses with its side."""
    CUBE = "cube"
    """Edge length `size_mm`; presses with a face."""
    CONE = "cone"
    """Apex toward the skin, full apex angle 90 degrees."""
    CROSS = "cross"
    """The letter X: a prism of two bars `size_mm` long and 0.3 wide, at 45 degrees to X and Y."""
    TRIANGLE = "triangle"
    """An equilateral prism of side `size_mm`, a corner toward +Y."""
    PACMAN = "pacman"
    """A disc of diameter `size_mm` with a mouth of 60 degrees toward +X, extruded."""
    HEXAGON = "hexagon"
    """A regular prism, `size_mm` from corner to corner along X."""
    ELLIPSOID = "ellipsoid"
    """Axes of 1, 0.7 and 0.5 `size_mm` along X, Y and Z."""
    DOUBLE_CYLINDER = "double_cylinder"
    """Two upright cylinders of diameter 0.45 `size_mm` with 0.1 between them along X."""
    DIAMOND = "diamond"
    """A regular octahedron, `size_mm` from tip to tip; presses with a tip."""
    FLOWER = "flower"
    """Five round petals in a circle of diameter `size_mm`, one toward +X, extruded."""
    RING = "ring"
    """A tube of outer diameter `size_mm` and wall 0.25 `size_mm`; presses with its end."""
    RHOMBUS = "rhombus"
    """A prism with diagonals of 1 and 0.6 `size_mm` along X and Y."""
    TORUS = "torus"
    """Lies flat: outer diameter `size_mm`, tube diameter 0.3 `size_mm`."""
    MESH = "mesh"
    """A watertight triangle mesh (STL, OBJ or STEP); its -Z side meets the skin."""


SEEN = (
    IndenterKind.CROSS,
    IndenterKind.TRIANGLE,
    IndenterKind.PACMAN,
    IndenterKind.HEXAGON,
    IndenterKind.ELLIPSOID,
    IndenterKind.DOUBLE_CYLINDER,
    IndenterKind.CYLINDER_END,
    IndenterKind.CYLINDER_SIDE,
    IndenterKind.CUBE,
    IndenterKind.SPHERE,
)
"""The paper's indenters 1 to 10, with which its networks were trained."""
UNSEEN = (
    IndenterKind.DIAMOND,
    IndenterKind.FLOWER,
    IndenterKind.RING,
    IndenterKind.RHOMBUS,
)
"""The paper's indenters 11 to 14, kept for testing."""
EDGELESS = (
    IndenterKind.SPHERE,
    IndenterKind.ELLIPSOID,
    IndenterKind.TORUS,
    IndenterKind.MESH,
)
"""Kinds that take no edge radius; a mesh has `mesh_rounding_mm` instead."""

DEFAULT_SIZE_MM = 6.0
DEFAULT_EDGE_RADIUS_MM = 0.45
"""Rounding of edges [mm]: sharper than a grid cell cannot be resolved. Same as in the FEM."""
LARGEST_MM = 100.0
LARGEST_MESH_MM = 300.0
"""A screwdriver is 215 mm long."""
WIDEST_EDGE_SHARES = {
    IndenterKind.CROSS: 0.14,
    IndenterKind.TRIANGLE: 0.2,
    IndenterKind.PACMAN: 0.2,
    IndenterKind.DOUBLE_CYLINDER: 0.2,
    IndenterKind.FLOWER: 0.15,
    IndenterKind.RING: 0.12,
    IndenterKind.RHOMBUS: 0.2,
    IndenterKind.DIAMOND: 0.2,
}
"""Largest edge radius over `size_mm` that leaves something to round; 0.25 for the others."""


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


def widest_edge_mm(kind: IndenterKind, size_mm: float) -> float:
    """Largest edge radius that a kind takes at a size [mm]."""
    return WIDEST_EDGE_SHARES.get(kind, 0.25) * size_mm


@dataclass(frozen=True, kw_only=True, slots=True)
class Indenter:
    """An object, rigid unless it has an elastomer."""

    kind: IndenterKind = IndenterKind.SPHERE
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
        hint = "the default is 6 mm"
        at = "indenter.size_mm"
        largest = LARGEST_MESH_MM if self.kind is IndenterKind.MESH else LARGEST_MM
        within(self.size_mm, 0.5, largest, what="indenter size", unit="mm", at=at, hint=hint)
        at = "indenter.edge_radius_mm"
        if self.kind not in EDGELESS:
            widest = widest_edge_mm(self.kind, self.size_mm)
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
    def turned(self) -> bool:
        """Whether it stands otherwise than it came; a ball never does."""
        return any(self.turn_deg) and self.kind is not IndenterKind.SPHERE

    @property
    def standing_mesh(self) -> IndenterMesh | None:
        """Its mesh as it is turned, in the body frame."""
        if self.mesh is None or not self.turned:
            return self.mesh
        turned_mm = self.mesh.points_mm @ turn_matrix(self.turn_deg).T
        return IndenterMesh(points_mm=turned_mm, faces=self.mesh.faces, notice=self.mesh.notice)

    def _check_mesh(self) -> None:
        if (self.kind is IndenterKind.MESH) != (self.mesh is not None):
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
