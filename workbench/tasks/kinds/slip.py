"""Tell whether the whole contact has come to slide, from eight images with markers.

Label: 95 % of the contact's area slides in the last frame, or did before
(`workbench.learning.dataset.sequences`); the paper takes the turn of the tangential force, which
comes at the same time. Every press that comes to slip gives one window with and one without.
Friction is drawn about the design's, as far as cast sensors differ: a skin that is smoother than
its drawing slides within two images of the drag. Taught by .2 to .6 a network told a twin of .1
worse by 5 in a hundred.
Source of task and scores: SimTac, *Sim2Real transfer of slip detection*.
"""

from __future__ import annotations

import dataclasses

from workbench.core.design.design import SensorDesign
from workbench.learning.dataset.recipe import Recipe
from workbench.tasks.press_plan import DEPTH_MM, OBJECTS, pattern_of, pressed
from workbench.tasks.task import Look, Null, Published, Size, Task, Told
from workbench.twin.draw import FRICTION, LEAST_FRICTION

CASES = {Size.SMALL: 24, Size.PAPER: 500}
WINDOWS = {Size.SMALL: 80, Size.PAPER: 832}
"""At most: a slide that comes to slip gives two."""
MOST_FRICTION = 2.0
"""Of a recipe."""
SIZES_MM = {Size.SMALL: (5.0, 8.0), Size.PAPER: (3.0, 12.0)}


def recipe(design: SensorDesign, size: Size) -> Recipe:
    """Slides of twelve objects along the side wall of a finger, or all over another membrane."""
    made = pressed(
        design,
        size,
        pattern_of(design, side=True),
        (DEPTH_MM, 8),
        SIZES_MM[size],
        indenters=OBJECTS,
        shear_mm=1.6,
        shear_step_mm=0.1,
        sequences=WINDOWS[size],
    )
    about = design.material.friction
    least = max(LEAST_FRICTION, round(about - FRICTION, 6))
    friction = least, min(MOST_FRICTION, round(about + FRICTION, 6))
    vary = dataclasses.replace(made.vary, friction=friction)
    return dataclasses.replace(made, cases=CASES[size], vary=vary)


TASK = Task(
    purpose="whether the whole contact slides",
    recipe=recipe,
    look=Look.WINDOW,
    told=Told.CLASS,
    columns=("slip",),
    metric="balanced_accuracy",
    null=Null.MOTION,
    published=(Published(metric="balanced_accuracy", sim=0.9789, real=0.9206),),
)
