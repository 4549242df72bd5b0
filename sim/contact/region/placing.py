"""The object where it meets the skin: a large one is sampled finely only there.

A mug of 80 mm cannot be sampled at 0.2 mm as a whole. Its coarse distance says which part of it the
path brings near the skin; that window is then sampled finely, and the path planned with it anew.
"""

from __future__ import annotations

import numpy as np

from sim.contact.motion.approach import Approach, plan_approach
from sim.contact.objects.collider import make_collider
from sim.contact.objects.samples import Window
from sim.contact.objects.sampling import SAMPLES_PER_CELL
from sim.contact.region.refinement import path_samples
from workbench.core.objects.kind import Shape
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import Press
from workbench.core.result.results import Skin
from workbench.core.result.sampled import SampledDistance

COARSER = 1.05
"""Samples farther apart than asked for by this factor call for a window."""
NEAR_CELLS = 3.0
"""Gap to the skin at which a part of the object may still be met, in cells."""
PADDING_CELLS = 3.0
"""Room around the window, in cells."""


def place_object(
    outer: Skin,
    indenter: Indenter,
    press: Press,
    *,
    grid_mm: float,
    sampled: SampledDistance | None = None,
) -> Approach:
    """The object on its path.

    Args:
        outer: The skin.
        indenter: The object.
        press: What is asked for.
        grid_mm: Edge of a cell of the contact grid.
        sampled: The whole object's distance on this grid where a store has it.

    Raises:
        DesignError: If the object cannot be made, or its path does not reach the skin soundly.
        SolveError: If the first touch cannot be found.
    """
    collider = make_collider(indenter, grid_mm=grid_mm, whole=sampled)
    approach = plan_approach(outer, collider, press)
    if collider.shape is not Shape.GRID:
        return approach
    spacing_mm = 1.0 / float(collider.size[3])
    if spacing_mm <= COARSER * grid_mm / SAMPLES_PER_CELL:
        return approach
    window_mm = near_window_mm(outer, approach, grid_mm=grid_mm)
    collider = make_collider(indenter, grid_mm=grid_mm, window_mm=window_mm, whole=sampled)
    return plan_approach(outer, collider, press)


def near_window_mm(outer: Skin, approach: Approach, *, grid_mm: float) -> Window:
    """Lower and upper corner [mm], body frame, of what comes near the skin on the path."""
    collider = approach.collider
    spacing_mm = 1.0 / float(collider.size[3])
    near_mm = NEAR_CELLS * grid_mm + 2.0 * spacing_mm
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for progress in path_samples(approach):
        origin, rotation = approach.pose(float(progress))
        places = (outer.points_mm - origin) @ rotation
        places = places[collider.distance(places)[0] < near_mm]
        if len(places):
            low, high = np.minimum(low, places.min(axis=0)), np.maximum(high, places.max(axis=0))
    padding_mm = PADDING_CELLS * grid_mm
    return low - padding_mm, high + padding_mm
