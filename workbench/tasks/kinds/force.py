"""Tell the force of an object on the skin, along the axes of the sensor [N].

Objects are pressed in and dragged a little, so that forces have all directions; markers are seen,
as shear shows in little else.
"""

from __future__ import annotations

from workbench.core.design.design import SensorDesign
from workbench.learning.dataset.photo_labels import FORCE
from workbench.learning.dataset.recipe import Recipe
from workbench.tasks.press_plan import Amount, all_over
from workbench.tasks.task import Look, Null, Size, Task, Told

DRAGGED = {
    Size.SMALL: Amount(cases=60, size_mm=(5.0, 8.0), steps=2, shear_steps=2),
    Size.PAPER: Amount(cases=1000, size_mm=(3.0, 12.0), steps=8, shear_steps=6),
}


def recipe(design: SensorDesign, size: Size) -> Recipe:
    """Presses of twelve objects that are then dragged, all over the membrane."""
    return all_over(design, size, DRAGGED)


TASK = Task(
    purpose="the force of an object on the skin",
    recipe=recipe,
    look=Look.MARKED,
    told=Told.VALUES,
    columns=FORCE,
    metric="mae_force",
    null=Null.MEAN,
)
