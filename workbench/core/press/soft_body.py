"""An object that gives way: its elastomer, and how it is held."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.check import within


@dataclass(frozen=True, kw_only=True, slots=True)
class SoftBody:
    """A neo-Hookean object glued to a rigid holder that follows the path."""

    young_MPa: float = 0.145
    """Young's modulus [MPa]."""
    poisson: float = 0.45
    held_share: float = 0.25
    """Share of the object's height, from its top, that is glued to the holder."""

    def __post_init__(self) -> None:
        at = "indenter.soft.young_MPa"
        hint = "from 0.005 MPa, a soft gel, to 1000 MPa; leave the object rigid beyond that"
        within(
            self.young_MPa, 5e-3, 1e3, what="modulus of the object", unit="MPa", at=at, hint=hint
        )
        at = "indenter.soft.poisson"
        within(self.poisson, 0.0, 0.495, what="Poisson's ratio of the object", unit="", at=at)
        at = "indenter.soft.held_share"
        within(self.held_share, 0.05, 0.8, what="held share of the object", unit="", at=at)
