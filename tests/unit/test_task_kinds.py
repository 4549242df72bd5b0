"""Tasks for any design: patterns and depths that suit it, and lists that are derived."""

from __future__ import annotations

import pytest

from workbench.cli.command_line import parser
from workbench.core.design.design import SensorDesign
from workbench.learning.dataset.cases import cases_of
from workbench.learning.dataset.positions import Pattern
from workbench.project.named_designs import load_design
from workbench.tasks.task import Size, tasks


@pytest.mark.parametrize("size", Size)
@pytest.mark.parametrize("name", tasks())
def test_every_task_has_a_recipe_for_every_preset(name: str, size: Size) -> None:
    """The paper's patterns where they fit, `spread` elsewhere; no press through the wall."""
    for preset in ("geltip", "pad", "paw", "trunk", "thumb", "digitac", "tentacle"):
        design = load_design(preset)
        recipe = tasks()[name].recipe(design, size)
        patterns = {"geltip": (Pattern.FINGER, Pattern.SIDE), "pad": (Pattern.PAD, Pattern.SPREAD)}
        assert recipe.pattern in patterns.get(preset, (Pattern.SPREAD,)), preset
        assert recipe.depth_mm <= 0.4 * design.layers.elastomer_mm + 1e-6
        assert recipe.vary.looks.count > 1 and not recipe.hold_out


def test_sizes_of_the_paper_are_its_numbers() -> None:
    """8,016 images of objects, 2,548 of pressure, 832 windows. Source: SimTac."""
    finger, pad = load_design("geltip"), load_design("pad")
    found = {name: task.recipe(finger, Size.PAPER) for name, task in tasks().items()}
    images = sum(case.frames for case in cases_of(found["objects"]))
    assert (images, found["slip"].sequences) == (8016, 832)
    recipe = tasks()["safety"].recipe(pad, Size.PAPER)
    assert sum(case.frames for case in cases_of(recipe)) == 2548


def test_a_short_finger_is_pressed_all_over() -> None:
    """The paper's paths go 12 mm down the straight part."""
    short = SensorDesign(family="finger", shape={"cylinder_mm": 8.0})
    assert tasks()["slip"].recipe(short, Size.SMALL).pattern is Pattern.SPREAD


def test_the_command_offers_the_tasks_that_there_are() -> None:
    """Their files, without loading them."""
    words = ["task", "force", "geltip", "--out", "here"]
    assert parser().parse_args(words).task == "force"
    assert set(tasks()) == {"objects", "slip", "safety", "pose", "force"}
