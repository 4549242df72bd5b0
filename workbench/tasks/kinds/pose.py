"""Tell where the skin is touched, and how deep.

Columns `pose_*` are numbers of any name; of renders they are the point of the skin that the object
touches first [mm]. Each is a row of its own, and so is the depth. The presses are those of the
task `objects`.
"""

from __future__ import annotations

from workbench.core.design.design import SensorDesign
from workbench.learning.dataset.photo_labels import DEPTH, POSE
from workbench.learning.dataset.recipe import Recipe
from workbench.tasks.press_plan import STRAIGHT, all_over
from workbench.tasks.task import Look, Null, Size, Task, Told


def recipe(design: SensorDesign, size: Size) -> Recipe:
    """Straight presses of twelve objects, all over the membrane."""
    return all_over(design, size, STRAIGHT)


TASK = Task(
    purpose="where the skin is touched, and how deep",
    recipe=recipe,
    look=Look.PLAIN,
    told=Told.VALUES,
    columns=(POSE, DEPTH),
    metric="mae_pose",
    null=Null.MEAN,
)
