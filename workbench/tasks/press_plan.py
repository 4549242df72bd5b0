"""What the tasks press into a design: patterns, depths and how fine, for any membrane.

The paper's patterns go with the families that they are made for; any other membrane is pressed at
places spread evenly over it. A membrane thinner than the paper's is pressed less deep, in as many
steps.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypedDict, Unpack

from workbench.core.design.design import SensorDesign
from workbench.core.press.indenter import SEEN, UNSEEN, IndenterKind
from workbench.learning.dataset.algorithms import BASE_MM
from workbench.learning.dataset.positions import Pattern
from workbench.learning.dataset.recipe import Recipe, Solvers
from workbench.learning.dataset.variation import Looks, Vary
from workbench.tasks.task import Size

DEEPEST_SHARE = 0.4
"""Of the elastomer's thickness that a press goes in at most [1]: the paper's, .8 of 2 mm."""
COARSE_MM = 0.8
"""Grid of the contact solver in small sets [mm]: a press takes half the time of one on .5 mm."""
COARSE_HEX_MM = 0.6
"""Edge of the mesh in small sets [mm]."""
WIDTH_PX = 320
"""Of images: with half of it a dent reads so coarsely that of objects a twentieth less is told."""
LOOKS = {Size.SMALL: 3, Size.PAPER: 8}
"""Built sensors that see the presses."""
POINTS = 40
"""Places on a membrane without a pattern of its own."""
FRICTION = (0.2, 0.6)
OBJECTS = tuple(kind for kind in (*SEEN, *UNSEEN) if kind.value not in ("ring", "rhombus"))
"""The 12 objects of the paper's classification. Source: class names in its released script."""
DEPTH_MM = 0.8
"""Way in that is wanted [mm]; a thin membrane is pressed less deep."""
SHEAR_MM = 0.6
"""Way aside of a press that is dragged [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Amount:
    """How many presses, of which objects, in how many frames."""

    cases: int
    size_mm: tuple[float, float]
    """Least and largest object [mm]."""
    steps: int
    """Frames of a press."""
    shear_steps: int = 0
    """Frames of a drag aside; 0: straight presses."""


STRAIGHT: Mapping[Size, Amount] = {
    Size.SMALL: Amount(cases=144, size_mm=(7.0, 9.0), steps=2),
    Size.PAPER: Amount(cases=1002, size_mm=(3.0, 12.0), steps=8),
}
"""Straight presses: what tells objects and places apart. At size `paper` they are as many images as
the paper has."""


class Pressed(TypedDict, total=False):
    """What a task's presses are besides: fields of a recipe."""

    indenters: tuple[IndenterKind, ...]
    shear_mm: float
    shear_step_mm: float
    shear_directions: int
    sequences: int


def pattern_of(design: SensorDesign, *, side: bool = False) -> Pattern:
    """The paper's pattern for a design's family where it has one, else `spread`.

    Args:
        design: Whose membrane is pressed.
        side: Only where a finger holds what it grasps.
    """
    from designs.family import resolve_shape

    if design.family == Pattern.FINGER.value:
        shape: Any = resolve_shape(design.family, design.shape)
        if shape.cylinder_mm > BASE_MM[-1]:
            return Pattern.SIDE if side else Pattern.FINGER
    if design.family == Pattern.PAD.value and not side:
        return Pattern.PAD
    return Pattern.SPREAD


def all_over(
    design: SensorDesign,
    size: Size,
    amounts: Mapping[Size, Amount],
    depth_mm: float = DEPTH_MM,
    indenters: tuple[IndenterKind, ...] = OBJECTS,
) -> Recipe:
    """Presses of all objects, all over a membrane, turned at random about the way of the press.

    Args:
        design: What is pressed.
        size: Which of the amounts.
        amounts: How many presses at each size.
        depth_mm: Way in that is wanted [mm].
        indenters: The objects.
    """
    amount = amounts[size]
    more = Pressed(indenters=indenters, shear_directions=0)
    if amount.shear_steps:
        step_mm = SHEAR_MM / amount.shear_steps
        more = Pressed(indenters=indenters, shear_mm=SHEAR_MM, shear_step_mm=step_mm)
    made = pressed(
        design,
        size,
        pattern_of(design),
        (depth_mm, amount.steps),
        amount.size_mm,
        **more,
    )
    return dataclasses.replace(made, cases=amount.cases)


def pressed(
    design: SensorDesign,
    size: Size,
    pattern: Pattern,
    depth: tuple[float, int],
    size_mm: tuple[float, float],
    **more: Unpack[Pressed],
) -> Recipe:
    """A recipe of presses by the contact solver, seen by several built sensors.

    Args:
        design: What is pressed.
        size: Small sets are pressed on a coarser grid.
        pattern: Where.
        depth: Wanted way in [mm], and its steps.
        size_mm: Least and largest object [mm].
        more: As of a recipe.
    """
    wanted_mm, steps = depth
    depth_mm = min(wanted_mm, DEEPEST_SHARE * design.layers.elastomer_mm)
    step_mm = math.floor(1e4 * depth_mm / steps + 1e-6) / 1e4
    made = Recipe(
        design=design,
        pattern=pattern,
        points=POINTS,
        depth_mm=round(step_mm * steps, 4),
        depth_step_mm=step_mm,
        solvers=Solvers.MPM,
        image_width_px=WIDTH_PX,
        hold_out=False,
        vary=Vary(
            size_mm=size_mm,
            spin_deg=(-180.0, 180.0),
            friction=FRICTION,
            looks=Looks(count=LOOKS[size]),
        ),
        **more,
    )
    if size is Size.SMALL:
        return dataclasses.replace(made, grid_mm=COARSE_MM, hex_mm=COARSE_HEX_MM)
    return made
