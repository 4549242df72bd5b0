"""What a family builds: B-rep bodies, or the same sensor as signed distance fields.

Both carry the same marks, so whoever turns them into triangles labels them in one way.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from workbench.core.result.marks import NO_MARKS, Field, Marks

WALL_SHARE = 0.5
"""Least wall over its nominal thickness, in every family."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Bodies:
    """build123d parts in the sensor frame: base plane z = 0, tip toward +Z [mm]."""

    membrane: Any
    """The elastomer: outer minus core."""
    outer: Any
    """The outer body before hollowing."""
    core: Any
    """The body that hollows it: support and cavity together."""
    support: Any
    """The rigid transparent shell inside the core."""
    base: Any
    """The rigid foot below z = 0 that carries camera and LEDs."""
    marks: Marks = NO_MARKS


@dataclass(frozen=True, kw_only=True, slots=True)
class Fields:
    """The same sensor as signed distance fields: what is meshed when the CAD kernel fails."""

    outer: Field
    core: Field
    cavity: Field
    """Air inside the support: the support is the core outside it."""
    base: Any
    """The foot as a build123d part: plain enough never to fail."""
    low_mm: tuple[float, float, float]
    high_mm: tuple[float, float, float]
    """Box around the outer body [mm]; z = 0 is the base plane, which the fields need not cut."""
    marks: Marks = NO_MARKS
    wall_mm: float = 0.0
    """Thickness that the elastomer has at its thinnest by design [mm]; 0 where it runs out to an
    edge, as a slab does."""
