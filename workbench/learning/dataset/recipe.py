"""What a data set is made of: a design, a pattern of presses, solvers and images.

A recipe is a frozen dataclass, a TOML file (`design` is a name or a table, the rest are numbers),
and a key: the digest of its table. How many cases are wanted is not in the key, so that a data set
can grow: the first N cases of a recipe are the same for every N.
"""

from __future__ import annotations

import dataclasses
import enum
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sim.optics.field.model import model_of
from workbench.core.base.check import within
from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import from_table, to_table
from workbench.core.design.design import SensorDesign
from workbench.core.design.turning import AS_IT_CAME, Angles
from workbench.core.press.fem import DRAFT_MM, QUALITY_MM
from workbench.core.press.indenter import (
    DEFAULT_EDGE_RADIUS_MM,
    DEFAULT_SIZE_MM,
    OF_TRIANGLES,
    SEEN,
    UNSEEN,
    Indenter,
    IndenterKind,
)
from workbench.learning.dataset.positions import MARGIN_MM, Pattern

WHOLE = 1e-6
"""Largest distance of depth over step from a whole number."""


class Solvers(enum.StrEnum):
    """Which solvers find displacement and force."""

    MPM = "mpm"
    FEM = "fem"
    BOTH = "both"
    """Both, on the same vertices: what the network learns from."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Recipe:
    """A plan for a data set."""

    design: SensorDesign = field(default_factory=SensorDesign)
    pattern: Pattern = Pattern.FINGER
    points: int = 40
    """Positions of the pattern `spread`."""
    margin_mm: float = MARGIN_MM
    """Least distance from the rim, for the pattern `spread` [mm]."""
    indenters: tuple[IndenterKind, ...] = (*SEEN, *UNSEEN)
    size_mm: float = DEFAULT_SIZE_MM
    """Of every object [mm]: the paper gives none."""
    edge_radius_mm: float = DEFAULT_EDGE_RADIUS_MM
    """Rounding of every object's edges [mm]: physics, see the FEM's findings on cubes."""
    turn_deg: Angles = AS_IT_CAME
    """Turn of every object about the fixed X, then Y, then Z [degree]."""
    depth_mm: float = 1.0
    depth_step_mm: float = 0.1
    """One frame each [mm]."""
    shear_mm: float = 0.5
    """Way aside along U, V or both [mm]: diagonals go 1.4 times as far, as in the paper."""
    shear_step_mm: float = 0.1
    """One frame each [mm], along U or V."""
    shear_directions: int = 8
    """Evenly about the normal, from U: 0 presses only, 4 or 8."""
    shear_every_depth: bool = False
    """Shear at each depth step, as the paper's Algorithm 1; else at full depth only."""
    solvers: Solvers = Solvers.BOTH
    hex_mm: float = QUALITY_MM
    """Edge of a hexahedron; its skin carries all fields [mm]."""
    grid_mm: float = 0.5
    """Grid of the contact solver [mm]."""
    images: bool = True
    """Render each sample, with and without markers."""
    seed: int = 0
    """Of the order of cases, the split, and spread positions."""
    cases: int = field(default=0, metadata={"cosmetic": True})
    """The first so many cases; 0: all."""

    def __post_init__(self) -> None:
        within(self.points, 1, 100_000, what="points", unit="", at="recipe.points")
        within(self.margin_mm, 0.0, 50.0, what="margin", unit="mm", at="recipe.margin_mm")
        within(self.cases, 0, 10_000_000, what="cases", unit="", at="recipe.cases")
        within(self.seed, 0, 2**31, what="seed", unit="", at="recipe.seed")
        within(self.hex_mm, 0.2, 3.0, what="mesh spacing", unit="mm", at="recipe.hex_mm")
        within(self.grid_mm, 0.1, 3.0, what="grid spacing", unit="mm", at="recipe.grid_mm")
        _check_steps(self.depth_mm, self.depth_step_mm, "depth")
        if self.shear_directions not in (0, 4, 8):
            raise DesignError(
                f"there are {self.shear_directions} shear directions",
                hint="use 0 (presses only), 4 or 8",
                at="recipe.shear_directions",
            )
        if self.shear_directions:
            _check_steps(self.shear_mm, self.shear_step_mm, "shear")
        self._check_indenters()
        if self.images and model_of(self.design.optics.light_model).per_frame:
            raise DesignError(
                "photons traced for every frame take minutes an image",
                hint="choose another optics.light_model, or leave images out (--no-images)",
                at="recipe.images",
            )

    def _check_indenters(self) -> None:
        kinds = self.indenters
        if not kinds or len(set(kinds)) < len(kinds) or OF_TRIANGLES in kinds:
            raise DesignError(
                f"indenters {', '.join(kinds) or 'none'}",
                hint="name each of the shapes once, at least one; meshes are left out",
                at="recipe.indenters",
            )
        for kind in kinds:
            self.indenter(kind)

    def indenter(self, kind: IndenterKind) -> Indenter:
        """The object of a kind."""
        return Indenter(
            kind=kind,
            size_mm=self.size_mm,
            edge_radius_mm=self.edge_radius_mm,
            turn_deg=self.turn_deg,
        )

    @property
    def meshed_design(self) -> SensorDesign:
        """The design divided as finely as the FEM, so that all fields share their vertices."""
        meshing = dataclasses.replace(self.design.meshing, hex_mm=self.hex_mm)
        return dataclasses.replace(self.design, meshing=meshing)

    @property
    def depth_steps(self) -> int:
        """Frames of a press to full depth."""
        return round(self.depth_mm / self.depth_step_mm)

    @property
    def shear_steps(self) -> int:
        """Frames of a shear; 0 where there is none."""
        return round(self.shear_mm / self.shear_step_mm) if self.shear_directions else 0

    @property
    def table(self) -> dict[str, Any]:
        """The recipe as plain tables, as a manifest and a TOML file hold it."""
        from workbench.project.design_toml import design_table

        table = {**to_table(self), "design": design_table(self.design)}
        if not any(self.turn_deg):
            # Data sets of before had no such field, and keep their key.
            del table["turn_deg"]
        return table

    @property
    def key(self) -> str:
        """Digest of all that a sample depends on."""
        return table_key(self.table)


def table_key(table: Mapping[str, Any]) -> str:
    """Key of a recipe's table: neither names nor the number of cases change it."""
    own = {name: value for name, value in table.items() if name != "cases"}
    design = {name: value for name, value in own["design"].items() if name != "name"}
    return digest({**own, "design": design})


def _check_steps(way_mm: float, step_mm: float, what: str) -> None:
    within(way_mm, 0.01, 10.0, what=what, unit="mm", at=f"recipe.{what}_mm")
    within(step_mm, 0.005, 10.0, what=f"{what} step", unit="mm", at=f"recipe.{what}_step_mm")
    steps = way_mm / step_mm
    if steps < 1.0 - WHOLE or abs(steps - round(steps)) > WHOLE:
        raise DesignError(
            f"{what} {way_mm:g} mm is {steps:g} steps of {step_mm:g} mm",
            hint=f"make {what}_mm a whole multiple of {what}_step_mm",
            at=f"recipe.{what}_step_mm",
        )


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
    "tiny": (
        f'design = "geltip"\npattern = "finger"\nhex_mm = {DRAFT_MM}\nindenters = ["sphere"]\n'
        "depth_mm = 0.2\nshear_directions = 0\nimages = false\ncases = 2\n",
        "two presses of a sphere, 0.2 mm deep: to see that it works",
    ),
}
"""TOML and purpose of each recipe by name."""
