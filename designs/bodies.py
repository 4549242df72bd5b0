"""The B-rep bodies that a family builds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


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
