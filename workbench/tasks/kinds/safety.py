"""Judge how safe a contact is for the skin, by the largest pressure in it.

The coefficient is 1 - (p - low) / (high - low), cut to 0 and 1: p is the largest contact pressure,
low and high its least and largest value in the renders. So 1 is safe and 0 the most dangerous
press of the set; the paper normalises to 0 and 1 without saying by what, and its p is the largest
force of a vertex, which grows with the mesh.
Source of task and scores: SimTac, *Sim2Real transfer of contact safety assessment*.
"""

from __future__ import annotations

import dataclasses

from workbench.core.design.design import SensorDesign
from workbench.core.press.indenter import SEEN, UNSEEN
from workbench.learning.dataset.positions import Pattern
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.dataset.variation import Vary
from workbench.tasks.press_plan import FRICTION, pattern_of, pressed
from workbench.tasks.task import Look, Null, Published, Size, Task, Told

CASES = {Size.SMALL: 84, Size.PAPER: 364}
SIZES_MM = {Size.SMALL: (5.0, 8.0), Size.PAPER: (3.0, 12.0)}
STEPS = {Size.SMALL: 2, Size.PAPER: 7}
DEPTHS_MM = {Pattern.PAD: 1.05}
"""Of the paper's pad [mm]."""
DEPTH_MM = 0.8
"""Of any other membrane [mm]."""


def recipe(design: SensorDesign, size: Size) -> Recipe:
    """Straight presses of fourteen objects, all over the membrane."""
    vary = Vary(size_mm=SIZES_MM[size], spin_deg=(-180.0, 180.0), friction=FRICTION)
    pattern = pattern_of(design)
    made = pressed(
        design,
        size,
        pattern,
        (DEPTHS_MM.get(pattern, DEPTH_MM), STEPS[size]),
        vary,
        indenters=(*SEEN, *UNSEEN),
        shear_directions=0,
    )
    return dataclasses.replace(made, cases=CASES[size])


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
