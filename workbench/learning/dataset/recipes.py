"""Recipes by name and from files, and those that come with the program."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import from_table
from workbench.core.press.fem import DRAFT_MM
from workbench.core.press.indenter import SEEN, UNSEEN
from workbench.learning.dataset.recipe import Recipe


def recipe_to_toml(recipe: Recipe) -> str:
    """A recipe as TOML; `recipe_from_toml` gives the same recipe back."""
    import tomli_w

    return tomli_w.dumps(recipe.table)


def recipe_from_toml(text: str, *, source: str = "the recipe", project: Any = None) -> Recipe:
    """Parse and check a recipe.

    Args:
        text: The file.
        source: Its name, for messages.
        project: Where files of a design may be kept.

    Raises:
        DesignError: For broken TOML, unknown fields, refused values or an unknown design.
    """
    from workbench.project.design_toml import design_from_toml
    from workbench.project.named_designs import load_design
    from workbench.system.whole_files import toml_table

    try:
        table = toml_table(text)
    except ValueError as error:
        raise DesignError(
            f"{source} is not valid TOML: {error}", hint="correct the line named", at="recipe"
        ) from error
    design = table.pop("design", None)
    recipe = from_table(Recipe, table, at="recipe")
    if isinstance(design, str):
        design = load_design(design, project=project)
    elif isinstance(design, dict):
        import tomli_w

        roots = () if project is None else (project.folder,)
        design = design_from_toml(tomli_w.dumps(design), source=source, roots=roots)
    else:
        raise DesignError(
            f"{source} names no design",
            hint='write design = "geltip" or a [design] table',
            at="recipe.design",
        )
    return dataclasses.replace(recipe, design=design)


def load_recipe(name: str, project: Any = None) -> Recipe:
    """A recipe by its name, else from a TOML file.

    Raises:
        DesignError: If there is none, or the file is not valid.
    """
    from workbench.core.base.mapping import suggest
    from workbench.system.whole_files import kept_text

    if name in RECIPES:
        text, _ = RECIPES[name]
        return recipe_from_toml(text, source=name, project=project)
    path = Path(name)
    if path.suffix != ".toml":
        raise DesignError(
            f"there is no recipe {shown(name)}", hint=suggest(name, RECIPES), at="recipe"
        )
    try:
        text = kept_text(path)
    except (OSError, ValueError) as error:
        raise DesignError(
            f"cannot read {path}: {error}", hint="give a readable TOML file", at="recipe"
        ) from error
    return recipe_from_toml(text, source=name, project=project)


OTHERS = ("ring", "rhombus")
CLASSES = [kind.value for kind in (*SEEN, *UNSEEN) if kind not in OTHERS]
"""The 12 objects of the paper's classification. Source: class names in its released script."""
_VARIED = """\
[vary]
size_mm = [3.0, 12.0]
spin_deg = [-180.0, 180.0]
friction = [0.2, 0.6]
looks.count = 8
"""
"""Presses of all sizes and turns, seen by eight built sensors."""

RECIPES = {
    "paper_finger": (
        'design = "geltip"\npattern = "finger"\nshear_every_depth = true\n',
        "Algorithm 1 of the paper: 85 positions, 14 objects, shear at every depth",
    ),
    "paper_pad": (
        'design = "pad"\npattern = "pad"\ndepth_mm = 1.2\nshear_directions = 0\n',
        "Algorithm 2 of the paper: 25 positions, 14 objects, 12 depths: 4,200 samples",
    ),
    "small": (
        'design = "geltip"\npattern = "finger"\ncases = 84\n',
        "a first set for training on the finger: 84 cases, 1,260 samples",
    ),
    "objects": (
        'design = "geltip"\npattern = "finger"\nsolvers = "mpm"\nhold_out = false\n'
        f"indenters = {CLASSES}\ndepth_mm = 0.8\nshear_directions = 0\ncases = 1002\n"
        f"image_width_px = 320\n{_VARIED}",
        "the paper's task to tell objects: 1,002 presses of 12 objects, 8,016 samples",
    ),
    "safety": (
        'design = "pad"\npattern = "pad"\nsolvers = "mpm"\nhold_out = false\n'
        f"depth_mm = 1.05\ndepth_step_mm = 0.15\nshear_directions = 0\ncases = 364\n"
        f"image_width_px = 320\n{_VARIED}",
        "the paper's task to judge pressure: 364 presses of 14 objects on the pad, 2,548 samples",
    ),
    "slip": (
        'design = "geltip"\npattern = "side"\nsolvers = "mpm"\nhold_out = false\n'
        f"indenters = {CLASSES}\ndepth_mm = 0.8\nshear_mm = 1.6\ncases = 500\n"
        f"sequences = 832\nimage_width_px = 320\n{_VARIED}",
        "the paper's task to tell slip: 500 long slides on the side wall, of which 832 sequences",
    ),
    "varied": (
        'design = "geltip"\npattern = "finger"\ncases = 500\nimage_width_px = 320\n'
        f"{_VARIED}twist_deg = [-10.0, 10.0]\nyoung_MPa = [0.1, 0.2]\n",
        "all that can be varied, by both solvers: 500 cases, 10,000 samples",
    ),
    "tiny": (
        f'design = "geltip"\npattern = "finger"\nhex_mm = {DRAFT_MM}\nindenters = ["sphere"]\n'
        "depth_mm = 0.2\nshear_directions = 0\nimages = false\ncases = 2\n",
        "two presses of a sphere, 0.2 mm deep: to see that it works",
    ),
}
"""TOML and purpose of each recipe by name."""
