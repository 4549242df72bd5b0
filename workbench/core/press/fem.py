"""Numerical choices of the finite-element solver."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.check import within

QUALITY_MM = 0.45
"""Edge of a hexahedron for results to be trusted [mm]; finer under the contact. Forces of a ball
and of a cone on the tip of the finger are within 1 % of the converged ones from 0.2 mm on."""
DRAFT_MM = 0.9
"""The published spacing [mm], for a first look: within 5 % from 0.3 mm on."""
HALVINGS = 3
"""Halvings under a contact, at most: to 0.06 mm under a cone, 0.22 mm under a ball of 6 mm."""
FIELD_RADIUS_MM = 12.0
"""Radius of a submodel whose fields are good to 3e-3 mm [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class FemSettings:
    """How a press is solved by finite elements."""

    hex_mm: float = QUALITY_MM
    """Edge of a hexahedron [mm]: `QUALITY_MM`, or `DRAFT_MM` for a first look."""
    halvings: int = HALVINGS
    """How often hexahedra under the contact are halved, at most; 0: all stay as meshed."""
    error: bool = True
    """Whether the error of the force is estimated, by a second mesh halved once less."""
    radius_mm: float = FIELD_RADIUS_MM
    """Cells within this distance of the target take part [mm]; 0: all of the membrane."""
    increment_mm: float = 0.1
    """Longest way of the object in one increment [mm]. Source: SimTac, Supplementary."""
    tolerance: float = 1e-6
    """Largest residual over the largest nodal force at which an increment has converged [1]."""
    sampling_mm: float = 0.1
    """Distance of the samples of objects whose distance is sampled [mm]."""

    def __post_init__(self) -> None:
        at = "fem.hex_mm"
        hint = "0.45 mm is to be trusted, 0.9 mm is a draft, within 5 %"
        within(self.hex_mm, 0.2, 3.0, what="FEM mesh spacing", unit="mm", at=at, hint=hint)
        within(self.halvings, 0, 5, what="number of halvings", unit="", at="fem.halvings")
        at = "fem.radius_mm"
        if self.radius_mm != 0.0:
            hint = "12 mm is good for fields, 9 mm for totals; 0 takes all of the membrane"
            within(self.radius_mm, 4.0, 200.0, what="FEM radius", unit="mm", at=at, hint=hint)
        at = "fem.increment_mm"
        within(self.increment_mm, 0.005, 1.0, what="FEM increment", unit="mm", at=at)
        within(self.tolerance, 1e-10, 1e-3, what="FEM tolerance", unit="", at="fem.tolerance")
        at = "fem.sampling_mm"
        within(self.sampling_mm, 0.02, 1.0, what="sample spacing", unit="mm", at=at)
