"""Judge how safe a contact is for the skin, by the largest pressure in it.

The coefficient is 1 - (p - low) / (high - low), cut to 0 and 1: p is the largest mean pressure on a
disc of 2 mm (`workbench.learning.dataset.photo_labels`), low and high its least and largest value
in the renders. So 1 is safe and 0 the most dangerous press of the set; the paper normalises to 0
and 1 without saying by what, and its p is the largest force of a vertex, which grows with the mesh.
Source of task and scores: SimTac, *Sim2Real transfer of contact safety assessment*.
"""

from __future__ import annotations

from workbench.core.design.design import SensorDesign
from workbench.core.press.indenter import SEEN, UNSEEN
from workbench.learning.dataset.positions import Pattern
from workbench.learning.dataset.recipe import Recipe
from workbench.tasks.press_plan import DEPTH_MM, Amount, all_over, pattern_of
from workbench.tasks.task import Look, Null, Published, Size, Task, Told

PRESSES = {
    Size.SMALL: Amount(cases=84, size_mm=(5.0, 8.0), steps=2),
    Size.PAPER: Amount(cases=364, size_mm=(3.0, 12.0), steps=7),
}
DEPTHS_MM = {Pattern.PAD: 1.05}
"""Of the paper's pad [mm]."""


def recipe(design: SensorDesign, size: Size) -> Recipe:
    """Straight presses of fourteen objects, all over the membrane."""
    depth_mm = DEPTHS_MM.get(pattern_of(design), DEPTH_MM)
    return all_over(design, size, PRESSES, depth_mm, (*SEEN, *UNSEEN))


TASK = Task(
    purpose="how safe a contact is for the skin, by its largest pressure",
    recipe=recipe,
    look=Look.PLAIN,
    told=Told.VALUES,
    columns=("peak_MPa",),
    metric="mae_safety",
    null=Null.MEDIAN,
    published=(Published(metric="mae_safety", sim=0.028, real=0.105),),
    safety=True,
    formula="1 - (peak_MPa - low) / (high - low), low and high of the renders, cut to 0 and 1",
)
