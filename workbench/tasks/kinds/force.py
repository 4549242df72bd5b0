"""Tell the force of an object on the skin, along the axes of the sensor [N].

Objects are pressed in and dragged a little, so that forces have all directions; markers are seen,
as shear shows in little else.
"""

from __future__ import annotations

import dataclasses

from workbench.core.design.design import SensorDesign
from workbench.learning.dataset.photo_labels import FORCE
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.dataset.variation import Vary
from workbench.tasks.press_plan import FRICTION, OBJECTS, pattern_of, pressed
from workbench.tasks.task import Look, Null, Size, Task, Told

CASES = {Size.SMALL: 84, Size.PAPER: 1000}
SIZES_MM = {Size.SMALL: (5.0, 8.0), Size.PAPER: (3.0, 12.0)}
STEPS = {Size.SMALL: 2, Size.PAPER: 8}
SHEAR_MM, SHEAR_STEPS = 0.6, {Size.SMALL: 2, Size.PAPER: 6}


def recipe(design: SensorDesign, size: Size) -> Recipe:
    """Presses of twelve objects that are then dragged, all over the membrane."""
    vary = Vary(size_mm=SIZES_MM[size], spin_deg=(-180.0, 180.0), friction=FRICTION)
    made = pressed(
        design,
        size,
        pattern_of(design),
        (0.8, STEPS[size]),
        vary,
        indenters=OBJECTS,
        shear_mm=SHEAR_MM,
        shear_step_mm=SHEAR_MM / SHEAR_STEPS[size],
    )
    return dataclasses.replace(made, cases=CASES[size])


TASK = Task(
    purpose="the force of an object on the skin",
    recipe=recipe,
    look=Look.MARKED,
    told=Told.VALUES,
    columns=FORCE,
    metric="mae_force",
    null=Null.MEAN,
)
