"""Tell which of twelve objects presses: the paper's classification.

Objects are as large as the paper's by our guess, turned at random about the way of the press.
Source of task and scores: SimTac, *Sim2Real transfer of contact perception*.
"""

from __future__ import annotations

import dataclasses

from workbench.core.design.design import SensorDesign
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.dataset.variation import Vary
from workbench.tasks.press_plan import FRICTION, OBJECTS, pattern_of, pressed
from workbench.tasks.task import Look, Null, Published, Size, Task, Told

CASES = {Size.SMALL: 144, Size.PAPER: 1002}
SIZES_MM = {Size.SMALL: (7.0, 9.0), Size.PAPER: (3.0, 12.0)}
STEPS = {Size.SMALL: 2, Size.PAPER: 8}


def recipe(design: SensorDesign, size: Size) -> Recipe:
    """Straight presses of twelve objects, all over the membrane."""
    vary = Vary(size_mm=SIZES_MM[size], spin_deg=(-180.0, 180.0), friction=FRICTION)
    made = pressed(
        design,
        size,
        pattern_of(design),
        (0.8, STEPS[size]),
        vary,
        indenters=OBJECTS,
        shear_directions=0,
    )
    return dataclasses.replace(made, cases=CASES[size])


TASK = Task(
    purpose="which of twelve objects presses",
    recipe=recipe,
    look=Look.PLAIN,
    told=Told.CLASS,
    columns=("object",),
    metric="accuracy",
    null=Null.MAJORITY,
    published=(Published(metric="accuracy", sim=1.0, real=0.913),),
)
