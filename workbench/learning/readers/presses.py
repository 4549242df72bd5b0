"""The presses that a reader learns from: all over the skin, by objects of every kind and size.

Two data sets of one design: one is learned from, the other, at other places, judges. Both hold what
the contact solver finds and no images: how a press looks is drawn later, for many built sensors.
"""

from __future__ import annotations

from workbench.core.design.design import SensorDesign
from workbench.core.press.indenter import IndenterKind
from workbench.learning.dataset.positions import Pattern
from workbench.learning.dataset.recipe import Recipe, Solvers
from workbench.learning.dataset.recipes import CLASSES
from workbench.learning.dataset.variation import Vary

PLACES = 240
"""Places all over the skin, each some 2 to 3 mm from the next."""
DEPTH_MM, WALL_SHARE = 1.2, 0.6
"""Depth of the presses: so much, or this share of a thinner wall."""
STEPS = 4
"""Frames down to it."""
SHEAR_MM, SHEAR_STEP_MM = 0.6, 0.3
SIZE_MM = (3.0, 12.0)
FRICTION = (0.2, 0.6)
YOUNG = (0.85, 1.15)
"""Of the design's Young's modulus: batches of silicone differ."""
FINEST_MM = 0.2
"""Spacing of a data set's mesh, at least [mm]."""


def press_recipe(design: SensorDesign, *, judged: bool, seed: int = 0) -> Recipe:
    """The recipe of one of the two data sets.

    Args:
        design: The sensor.
        judged: For the presses that judge, at other places, instead of those that are learned from.
        seed: Of both.
    """
    young_MPa = design.material.young_MPa
    depth_mm = min(DEPTH_MM, WALL_SHARE * design.layers.elastomer_mm)
    return Recipe(
        design=design,
        pattern=Pattern.SPREAD,
        points=PLACES,
        indenters=tuple(IndenterKind(name) for name in CLASSES),
        depth_mm=depth_mm,
        depth_step_mm=depth_mm / STEPS,
        shear_mm=SHEAR_MM,
        shear_step_mm=SHEAR_STEP_MM,
        solvers=Solvers.MPM,
        hex_mm=max(design.meshing.hex_mm, FINEST_MM),
        images=False,
        vary=Vary(
            size_mm=SIZE_MM,
            spin_deg=(-180.0, 180.0),
            friction=FRICTION,
            young_MPa=(YOUNG[0] * young_MPa, YOUNG[1] * young_MPa),
        ),
        hold_out=False,
        shares=(1, 0, 0),
        seed=2 * seed + int(judged),
    )
