"""How thick the elastomer is under a place of the skin, where the rigid support lies behind it."""

from __future__ import annotations

import numpy as np

from workbench.core.result.results import Solid
from workbench.view.scene_shapes import first_hit

LIFT_MM = 1.0
"""A place may lie so far below the skin by its rounding."""
INSIDE_MM = 0.01
"""How far inside the skin the way to its other side begins."""
BONDED_MM = 0.1
"""Farther than this behind the elastomer the support does not carry it."""


def wall_under_mm(solid: Solid, place_mm: np.ndarray, outward: np.ndarray) -> float | None:
    """Thickness of the elastomer along the normal [mm].

    Args:
        solid: The body at rest.
        place_mm: On its outer skin, shape (3,).
        outward: Unit normal there, shape (3,).

    Returns:
        None where the ray meets no skin, or no support lies on the elastomer's other side.
    """
    skin = solid.membrane.points_mm, solid.membrane.faces
    outer = first_hit(*skin, place_mm + LIFT_MM * outward, -outward)
    if outer is None:
        return None
    begin = outer[1] - INSIDE_MM * outward
    inner = first_hit(*skin, begin, -outward, both_sides=True)
    support = solid.support.points_mm, solid.support.faces
    behind = first_hit(*support, begin, -outward, both_sides=True)
    if inner is None or behind is None:
        return None
    if np.linalg.norm(behind[1] - inner[1]) > BONDED_MM:
        return None
    return float(np.linalg.norm(inner[1] - outer[1]))
