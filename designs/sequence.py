"""What a family says of its moving parts: which lobes there are, and what they do with an object.

A lobe is a part whose far side is driven. It turns as a whole about an axis at its root, so that
the side toward the object stays free and gives way where it meets it.
"""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.press.actuation import Place
from workbench.core.press.indenter import IndenterKind


@dataclass(frozen=True, kw_only=True, slots=True)
class Lobe:
    """A part that closes."""

    region: str
    """Region that is driven, for example `actuator_0`."""
    root_mm: Place
    """A point of the axis [mm], sensor frame."""
    axis: Place
    """Direction of the axis; a right-handed turn about it closes the lobe."""
    outward: Place
    """Faces of the region whose normals point this way are driven: the lobe's back."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Sequence:
    """Press an object where the family aims, close the lobes on it, open them, lift it off."""

    title: str
    """Name for people."""
    lobes: tuple[Lobe, ...]
    close_deg: float
    """How far each lobe turns [degree]."""
    kind: IndenterKind
    """Object that suits the lobes."""
    size_mm: float
    """Its size [mm]."""
    depth_mm: float
    """How deep it is pressed before they close [mm]."""
    grid_mm: float
    """Grid of the contact solver that is fine enough for the thick lobes [mm]."""
