"""Which trained networks predict the forces of a press."""

from __future__ import annotations

from dataclasses import dataclass, field

SHIPPED = ""
"""Stands for the network that comes with the workbench."""
NONE = "none"
"""Stands for no network: the displacement is that of the contact solver."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LearnedSettings:
    """Networks by the path of their file of weights, or `SHIPPED`."""

    weights: str = SHIPPED
    """Of the network that predicts forces."""
    displacement: str = SHIPPED
    """Of the network that predicts displacements, or `NONE`."""


@dataclass(frozen=True, kw_only=True, slots=True)
class WeightsFile:
    """A file of weights. Its name ends in the hash of its content, so the name is all of a key."""

    name: str
    path: str = field(default="", metadata={"cosmetic": True})
    """Where it lies here."""
