"""Tell which of twelve objects presses: the paper's classification.

Objects are as large as the paper's by our guess, turned at random about the way of the press.
Source of task and scores: SimTac, *Sim2Real transfer of contact perception*.
"""

from __future__ import annotations

from workbench.core.design.design import SensorDesign
from workbench.learning.dataset.recipe import Recipe
from workbench.tasks.press_plan import STRAIGHT, all_over
from workbench.tasks.task import Look, Null, Published, Size, Task, Told


def recipe(design: SensorDesign, size: Size) -> Recipe:
    """Straight presses of twelve objects, all over the membrane."""
    return all_over(design, size, STRAIGHT)


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
