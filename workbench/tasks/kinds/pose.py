"""Tell where the skin is touched, and how deep.

Columns `pose_*` are numbers of any name; of renders they are the point of the skin that the object
touches first [mm]. Each is a row of its own, and so is the depth.
"""

from __future__ import annotations

import dataclasses

from workbench.core.design.design import SensorDesign
from workbench.learning.dataset.photo_labels import DEPTH, POSE
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.dataset.variation import Vary
from workbench.tasks.press_plan import FRICTION, OBJECTS, pattern_of, pressed
from workbench.tasks.task import Look, Null, Size, Task, Told

CASES = {Size.SMALL: 96, Size.PAPER: 1002}
SIZES_MM = {Size.SMALL: (5.0, 8.0), Size.PAPER: (3.0, 12.0)}
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
    purpose="where the skin is touched, and how deep",
    recipe=recipe,
    look=Look.PLAIN,
    told=Told.VALUES,
    columns=(POSE, DEPTH),
    metric="mae_pose",
    null=Null.MEAN,
)
