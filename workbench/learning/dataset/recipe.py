"""What a data set is made of: a design, a pattern of presses, solvers and images.

A recipe is a frozen dataclass, a TOML file (`design` is a name or a table, the rest are numbers),
and a key: the digest of its table. How many cases are wanted is not in the key, so that a data set
can grow: the first N cases of a recipe are the same for every N.
"""

from __future__ import annotations

import dataclasses
import enum
import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from sim.optics.field.model import model_of
from workbench.core.base.check import within
from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError
from workbench.core.base.mapping import to_table
from workbench.core.design.design import Elastomer, SensorDesign
from workbench.core.design.turning import AS_IT_CAME, Angles
from workbench.core.press.fem import QUALITY_MM
from workbench.core.press.indenter import (
    DEFAULT_EDGE_RADIUS_MM,
    DEFAULT_SIZE_MM,
    OF_TRIANGLES,
    SEEN,
    UNSEEN,
    Indenter,
    IndenterKind,
    widest_edge_mm,
)
from workbench.learning.dataset.positions import MARGIN_MM, Pattern
from workbench.learning.dataset.variation import NOTHING, Drawn, Vary

WHOLE = 1e-6
"""Largest distance of depth over step from a whole number."""


LATER: dict[str, Any] = {
    "turn_deg": AS_IT_CAME,
    "image_width_px": 0,
    "vary": Vary(),
    "twist_frames": 5,
    "sequences": 0,
    "hold_out": True,
    "shares": (3, 1, 1),
}
"""Fields that the first recipes had not, with what those stand for."""


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
    image_width_px: int = 0
    """Width of images, in the camera's proportion; 0: as many pixels as the camera has."""
    vary: Vary = field(default_factory=Vary)
    """What is drawn anew for each case."""
    twist_frames: int = 5
    """Frames of a twist, where one is drawn."""
    sequences: int = 0
    """Sequences of eight frames that are listed for telling slip, half of them with it."""
    hold_out: bool = True
    """Keep the objects that the paper's networks did not see in a split of their own."""
    shares: tuple[int, int, int] = (3, 1, 1)
    """Pairs of object and place for training, validation and test. Source: SimTac."""
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
        at = "recipe.sequences"
        within(self.sequences, 0, 1_000_000, what="sequences", unit="", at=at)
        at = "recipe.twist_frames"
        within(self.twist_frames, 1, 100, what="frames of a twist", unit="", at=at)
        for share in self.shares:
            within(share, 0, 1000, what="share of a split", unit="", at="recipe.shares")
        if not self.shares[0]:
            raise DesignError(
                "no pair of object and place is for training",
                hint="make the first of shares 1 or more",
                at="recipe.shares",
            )
        if self.image_width_px:
            at = "recipe.image_width_px"
            within(self.image_width_px, 16, 4096, what="width of images", unit="px", at=at)
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
        sizes_mm = self.vary.size_mm or (self.size_mm,)
        for kind, size_mm in itertools.product(kinds, sizes_mm):
            self.indenter(kind, Drawn(size_mm=size_mm))

    def indenter(self, kind: IndenterKind, drawn: Drawn = NOTHING) -> Indenter:
        """The object of a kind, as a case draws it; edges are as round as the object takes."""
        size_mm = self.size_mm if drawn.size_mm is None else drawn.size_mm
        widest_mm = widest_edge_mm(kind, size_mm)
        edge_mm = self.edge_radius_mm
        if self.vary.size_mm is not None and widest_mm is not None:
            edge_mm = min(edge_mm, widest_mm)
        about_x, about_y, about_z = self.turn_deg
        spun_deg = (about_z + (drawn.spin_deg or 0.0) + 180.0) % 360.0 - 180.0
        return Indenter(
            kind=kind,
            size_mm=size_mm,
            edge_radius_mm=edge_mm,
            turn_deg=self.turn_deg if drawn.spin_deg is None else (about_x, about_y, spun_deg),
        )

    def material(self, drawn: Drawn) -> Elastomer:
        """The elastomer, as a case draws it; kinetic friction stays in proportion to the static."""
        own = self.design.material
        changes = {"friction": drawn.friction, "young_MPa": drawn.young_MPa}
        if drawn.friction is not None and own.kinetic_friction is not None and own.friction > 0.0:
            changes["kinetic_friction"] = drawn.friction * own.kinetic_friction / own.friction
        given = {name: value for name, value in changes.items() if value is not None}
        return dataclasses.replace(own, **given)

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
        for name, before in LATER.items():
            if getattr(self, name) == before:
                # Data sets of before had no such field, and keep their key.
                del table[name]
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
