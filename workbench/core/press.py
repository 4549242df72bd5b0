"""What is pressed into the skin, where and how far."""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass

import numpy as np

from workbench.core.check import expect, within
from workbench.core.errors import DesignError


class IndenterKind(enum.StrEnum):
    """Rigid shapes; body +Z points away from the skin, the body origin is the shape's centre."""

    SPHERE = "sphere"
    CYLINDER_END = "cylinder_end"
    """Axis along the approach: presses with its flat end."""
    CYLINDER_SIDE = "cylinder_side"
    """Axis along body +Y: presses with its side."""
    CUBE = "cube"
    CONE = "cone"
    """Apex toward the skin, full apex angle 90 degrees."""
    MESH = "mesh"
    """A watertight triangle mesh (an STL file); its -Z side meets the skin."""


DEFAULT_SIZE_MM = 6.0
DEFAULT_EDGE_RADIUS_MM = 0.45
"""Rounding of edges [mm]: sharper than a grid cell cannot be resolved. Same as in the FEM."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class IndenterMesh:
    """A closed triangle mesh in the indenter's body frame; compared by identity."""

    points_mm: np.ndarray
    """Vertices [mm], shape (N, 3), float64, centred on the bounding box."""
    faces: np.ndarray
    """Triangles, shape (M, 3), int32, counter-clockwise from outside."""

    def __post_init__(self) -> None:
        expect(self.points_mm, "N 3", name="indenter points")
        expect(self.faces, "M 3", name="indenter faces")


@dataclass(frozen=True, kw_only=True, slots=True)
class Indenter:
    """A rigid object."""

    kind: IndenterKind = IndenterKind.SPHERE
    size_mm: float = DEFAULT_SIZE_MM
    """Diameter, else the largest width [mm]."""
    edge_radius_mm: float = DEFAULT_EDGE_RADIUS_MM
    """Rounding radius of edges and of the cone's apex [mm]; a sphere and a mesh ignore it."""
    mesh: IndenterMesh | None = None

    def __post_init__(self) -> None:
        hint = "the default is 6 mm"
        at = "indenter.size_mm"
        within(self.size_mm, 0.5, 100.0, what="indenter size", unit="mm", at=at, hint=hint)
        widest = self.size_mm / 4
        at = "indenter.edge_radius_mm"
        if self.kind not in (IndenterKind.SPHERE, IndenterKind.MESH):
            within(self.edge_radius_mm, 0.0, widest, what="edge radius", unit="mm", at=at)
        if (self.kind is IndenterKind.MESH) != (self.mesh is not None):
            raise DesignError(
                f"indenter kind {self.kind} {'needs a' if self.mesh is None else 'takes no'} mesh",
                hint="load an STL file, or choose a primitive",
                at="indenter.mesh",
            )


@dataclass(frozen=True, kw_only=True, slots=True)
class Press:
    """One press path: straight in, then shear and twist at full depth."""

    target_mm: tuple[float, float, float] = (0.0, 10.0, 35.0)
    """Point near the skin [mm], sensor frame; projected onto the outer surface."""
    depth_mm: float = 1.0
    """Depth from first touch along the inward normal [mm]."""
    shear_mm: tuple[float, float] = (0.0, 0.0)
    """Displacement along U and V in the tangent plane [mm]; U is +Z projected, V = n x U."""
    twist_deg: float = 0.0
    """Rotation about the outward normal at full depth [degree]."""
    frames: int = 10
    """Frames of the approach; as many again follow when there is shear or twist."""

    def __post_init__(self) -> None:
        if not all(math.isfinite(x) for x in (*self.target_mm, *self.shear_mm)):
            raise DesignError(
                f"target {self.target_mm} or shear {self.shear_mm} is not finite",
                hint="give three numbers in mm for the target and two for the shear",
                at="press.target_mm",
            )
        hint = "depth counts inward from first touch; 1 mm is typical for a 2 mm wall"
        at = "press.depth_mm"
        within(self.depth_mm, 0.0, 50.0, what="press depth", unit="mm", at=at, hint=hint)
        at = "press.shear_mm"
        for shear in self.shear_mm:
            within(shear, -20.0, 20.0, what="shear", unit="mm", at=at)
        at = "press.twist_deg"
        within(self.twist_deg, -90.0, 90.0, what="twist", unit="degree", at=at)
        within(self.frames, 1, 500, what="frame count", unit="", at="press.frames")

    @property
    def sliding(self) -> bool:
        """Whether shear or twist frames follow the approach."""
        return any(self.shear_mm) or bool(self.twist_deg)

    @property
    def frame_count(self) -> int:
        """Frames in all."""
        return self.frames * (2 if self.sliding else 1)


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactSettings:
    """Numerical choices of the contact solver."""

    grid_mm: float = 0.5
    """Edge of a background grid cell [mm]; a quarter of a 2 mm wall."""
    active_radius_mm: float = 0.0
    """Cells within this distance of the target take part [mm]; 0 lets patch and wall decide."""
    penalty: float = 100.0
    """Contact stiffness per area in units of E / grid_mm [1]."""
    tolerance: float = 1e-3
    """Out-of-balance force over the reaction at which a frame counts as settled [1]."""
    max_substeps: int = 6000
    """Substeps of relaxation per frame before giving up."""

    def __post_init__(self) -> None:
        at = "contact.grid_mm"
        within(self.grid_mm, 0.1, 3.0, what="grid spacing", unit="mm", at=at)
        at = "contact.active_radius_mm"
        if self.active_radius_mm != 0.0:
            hint = "or 0, and the contact patch and the wall decide"
            radius_mm = self.active_radius_mm
            within(radius_mm, 3.0, 200.0, what="active radius", unit="mm", at=at, hint=hint)
        within(self.penalty, 1.0, 1e4, what="contact penalty", unit="", at="contact.penalty")
        within(self.tolerance, 1e-6, 0.1, what="tolerance", unit="", at="contact.tolerance")
        at = "contact.max_substeps"
        within(self.max_substeps, 10, 1_000_000, what="substep limit", unit="", at=at)
