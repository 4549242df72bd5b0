"""Where an object is pressed into the skin, how far, and how that is computed."""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass

from workbench.core.actuation import Actuation
from workbench.core.check import within
from workbench.core.errors import DesignError


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
    actuations: tuple[Actuation, ...] = ()
    """Regions of the membrane that are driven meanwhile; each lasts until its last key."""

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
        driven = max((actuation.last_frame for actuation in self.actuations), default=0)
        return max(self.frames * (2 if self.sliding else 1), driven)


class Extent(enum.StrEnum):
    """How much of the membrane takes part."""

    ACTIVE = "active"
    """The region around the contact."""
    FULL = "full"
    """All of it."""


class Method(enum.StrEnum):
    """How the contact is computed."""

    LATTICE = "lattice"
    """Total-Lagrangian B-spline MPM with penalty contact: the workbench's own."""
    PARTICLES = "particles"
    """The published way, for comparison: updated-Lagrangian MPM, the indenter made of particles."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactSettings:
    """Numerical choices of the contact solver."""

    grid_mm: float = 0.5
    """Edge of a background grid cell [mm]; a quarter of a 2 mm wall."""
    active_radius_mm: float = 0.0
    """Cells within this distance of the target take part [mm]; 0 lets patch and wall decide."""
    region_error: float = 3e-3
    """Error of the force that the automatic radius may cost, relative [1]."""
    extent: Extent = Extent.ACTIVE
    method: Method = Method.LATTICE
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
        at = "contact.region_error"
        within(self.region_error, 1e-5, 0.05, what="error of the region", unit="", at=at)
        within(self.penalty, 1.0, 1e4, what="contact penalty", unit="", at="contact.penalty")
        within(self.tolerance, 1e-6, 0.1, what="tolerance", unit="", at="contact.tolerance")
        at = "contact.max_substeps"
        within(self.max_substeps, 10, 1_000_000, what="substep limit", unit="", at=at)
