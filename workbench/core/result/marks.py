"""Parts of a body's surface with a label of their own, and what else a family marks on it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from workbench.core.result.results import Label

Field = Callable[[np.ndarray], np.ndarray]
"""Points (N, 3) [mm] to signed distances (N,) [mm], negative inside; exact near 0 only."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Region:
    """A part of the surface with a label of its own: an actuator or a pin."""

    label: Label
    """ACTUATOR, PIN or BACKED."""
    number: int
    """Counts from 0 within the label; ignored for BACKED."""
    within: Label
    """OUTER or INNER: only faces there are looked at."""
    inside: Field
    """Positive at points of the region; its zero set is the boundary."""
    imprint: bool = False
    """Cut triangles along the boundary; False where the boundary is an edge of the body anyway."""
    borders: tuple[Field, ...] = ()
    """What triangles are cut along one after the other, if other than the zero set of `inside`:
    a boundary with corners, or one of which a part is an edge of the body anyway."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Marks:
    """What both kinds of bodies have in common."""

    regions: tuple[Region, ...] = ()
    tips_mm: tuple[tuple[float, float, float], ...] = ()
    """Centres of the tips of internal pins [mm], in the order of their numbers."""
    tip_radius_mm: float = 0.0
    backing_mm: float = 0.0
    """Gap between backed inner faces and the support [mm]."""


NO_MARKS = Marks()
"""Nothing marked: the whole surface is outer, inner or base."""
