"""The rigid object that is pressed into the skin."""

from __future__ import annotations

import enum
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
