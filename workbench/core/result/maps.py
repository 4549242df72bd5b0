"""Maps of what a sensor can see and feel, on the skin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

PERCENTILES = (0.0, 5.0, 25.0, 50.0, 75.0, 95.0, 100.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class SkinMap:
    """One quantity on the vertices of the seen skin."""

    name: str
    """Name in files, for example `mm_per_pixel`."""
    label: str
    """What people read."""
    unit: str
    values: np.ndarray
    """At each vertex, shape (V,), float32; NaN where the quantity does not exist."""
    percentiles: np.ndarray
    """`PERCENTILES` over the seen skin, weighted by area, shape (7,), float64; NaN if empty."""
    score_name: str
    """Name of its scalar on the score card; ends in its unit."""
    score: float
    better: str
    """`more` or `less` is better."""
    meaning: str
    """One sentence for the designer."""


@dataclass(frozen=True, kw_only=True, slots=True)
class DesignerMaps:
    """All maps of one design."""

    maps: tuple[SkinMap, ...]

    def named(self, name: str) -> SkinMap:
        """One map by its name.

        Raises:
            KeyError: If there is none.
        """
        for found in self.maps:
            if found.name == name:
                return found
        raise KeyError(name)
