"""The cases of a recipe in the order in which they are made, and which split each is in.

A *case* is one press path, a *sample* one recorded state (one frame). Each case presses anew and
then shears one way, so its frames in order are a tactile sequence.

The order is ours, the paper does not say which states it kept. Cases are dealt like cards: the
k-th takes object k mod I and, of the shuffled positions, the k-th mod P (moved on by one whenever
both have come round together), so that any first N cases hold every object and every position
equally often, to within one. Each pair of position and object comes once with one way of
pressing before any comes with a second. A data set of N cases is the beginning of a larger one.

Training, validation and test share pairs of position and object 3:1:1, or as the recipe says: in
every five pairs, in dealt order, three, one and one at random. All ways of pressing one pair stay
together, so no frame of one press, and no repeated approach, is in two splits. Objects that the
paper's networks did not see are in a split of their own.
"""

from __future__ import annotations

import dataclasses
import enum
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from workbench.core.base.mapping import to_table
from workbench.core.press.indenter import UNSEEN, IndenterKind
from workbench.core.press.motion import Stroke, slide, twist
from workbench.core.press.press import Press
from workbench.core.result.results import Skin
from workbench.learning.dataset.algorithms import shear_way_mm
from workbench.learning.dataset.positions import (
    Pattern,
    Position,
    finger_positions,
    pad_positions,
    side_positions,
    spread_positions,
)
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.dataset.variation import NOTHING, Drawn, Vary, draw


class Split(enum.StrEnum):
    """What a case is for."""

    TRAIN = "train"
    VALIDATION = "validation"
    TEST = "test"
    UNSEEN = "unseen"
    """Objects that training never shows."""


SHARED = (Split.TRAIN, Split.VALIDATION, Split.TEST)
"""What a recipe's `shares` are of."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Case:
    """One press path."""

    id: str
    """Stable, readable, a folder's name: `sphere_tip40_az090_shear3`."""
    split: Split
    indenter: IndenterKind
    position: Position
    depth_mm: float
    press_frames: int
    shear: int = -1
    """Direction of the shear, counted from U toward V; -1 for none."""
    shear_mm: tuple[float, float] = (0.0, 0.0)
    """Way along U and V at its end [mm]."""
    shear_frames: int = 0
    twist_frames: int = 0
    drawn: Drawn = NOTHING
    """Size, turn, friction ... of this case."""
    first_new: int = 0
    """Frames before this one repeat states of an earlier case: the approach of the same pair."""

    @property
    def frames(self) -> int:
        """Samples of the case."""
        return self.press_frames + self.shear_frames + self.twist_frames

    @property
    def pair(self) -> str:
        """Position and object, which never are in two splits."""
        return f"{self.indenter.value}_{self.position.name}"

    @property
    def press(self) -> Press:
        """The path."""
        strokes: list[Stroke] = []
        if self.shear_frames:
            strokes.append(slide(*self.shear_mm, frames=self.shear_frames))
        if self.twist_frames:
            strokes.append(twist(self.drawn.twist_deg or 0.0, frames=self.twist_frames))
        return Press(
            target_mm=self.position.target_mm,
            depth_mm=self.depth_mm,
            frames=self.press_frames,
            strokes=tuple(strokes),
        )

    def depth_at(self, frame: int) -> float:
        """Depth of a frame from first touch [mm]."""
        return self.depth_mm * min(1.0, (frame + 1) / self.press_frames)

    def shear_at(self, frame: int) -> tuple[float, float]:
        """Way along U and V of a frame [mm]."""
        done = min(1.0, max(0, frame + 1 - self.press_frames) / max(1, self.shear_frames))
        return done * self.shear_mm[0] + 0.0, done * self.shear_mm[1] + 0.0


@dataclass(frozen=True, kw_only=True, slots=True)
class _Pair:
    """A position with an object, which all cases of one split press."""

    kind: IndenterKind
    place: Position
    split: Split


def case_row(case: Case) -> dict[str, Any]:
    """A case as a plain table."""
    return to_table(case)


def case_of_row(row: Mapping[str, Any]) -> Case:
    """The case that a table holds; by hand, as there may be a hundred thousand of them.

    Raises:
        KeyError, TypeError, ValueError: If it is none.
    """
    place = row["position"]
    x, y, z = place["target_mm"]
    u, v = row["shear_mm"]
    position = Position(
        name=str(place["name"]), target_mm=(float(x), float(y), float(z)), labels=place["labels"]
    )
    given = {"split", "indenter", "position", "shear_mm", "drawn"}
    return Case(
        **{name: value for name, value in row.items() if name not in given},
        split=Split(row["split"]),
        indenter=IndenterKind(row["indenter"]),
        position=position,
        shear_mm=(float(u), float(v)),
        # Cases of before draw nothing.
        drawn=Drawn.of_row(row.get("drawn", {})),
    )


def positions_of(recipe: Recipe, skin: Skin | None = None) -> list[Position]:
    """The positions of a recipe; only the pattern `spread` looks at the skin.

    Raises:
        DesignError: If the pattern does not suit the design.
    """
    if recipe.pattern is Pattern.FINGER:
        return finger_positions(recipe.design)
    if recipe.pattern is Pattern.SIDE:
        return side_positions(recipe.design)
    if recipe.pattern is Pattern.PAD:
        return pad_positions(recipe.design)
    assert skin is not None, "points are spread over a skin"
    return spread_positions(skin, recipe.points, seed=recipe.seed, margin_mm=recipe.margin_mm)


def cases_of(recipe: Recipe, skin: Skin | None = None) -> list[Case]:
    """The cases that a recipe asks for, in order.

    Raises:
        DesignError: If the pattern does not suit the design.
    """
    return deal(recipe, positions_of(recipe, skin))


def ways_of(recipe: Recipe) -> list[tuple[int, int]]:
    """Depth steps and shear direction of each way of pressing one pair; direction -1 is none."""
    full = recipe.depth_steps
    depths = range(1, full + 1) if recipe.shear_every_depth else (full,)
    if not recipe.shear_directions:
        return [(full, -1)]
    return [(steps, way) for steps in depths for way in range(recipe.shear_directions)]


def count_cases(recipe: Recipe, positions: int) -> int:
    """Cases of a recipe with that many positions; one that varies has as many as are asked for."""
    every = positions * len(recipe.indenters) * len(ways_of(recipe))
    if recipe.cases and recipe.vary != Vary():
        return recipe.cases
    return min(recipe.cases, every) if recipe.cases else every


def deal(recipe: Recipe, positions: Sequence[Position]) -> list[Case]:
    """Deal the cases of a recipe over its positions: the module says how."""
    kinds, ways = recipe.indenters, ways_of(recipe)
    rng = np.random.default_rng(recipe.seed)
    places = [positions[k] for k in rng.permutation(len(positions))]
    ways = [ways[k] for k in rng.permutation(len(ways))]
    pairs = len(kinds) * len(places)
    together = math.lcm(len(kinds), len(places))
    splits = _splits(recipe, pairs, rng)
    pressed = np.zeros(pairs, np.int64)
    found = []
    for k in range(count_cases(recipe, len(positions))):
        turn, pair = divmod(k, pairs)
        kind = kinds[pair % len(kinds)]
        place = places[(pair + pair // together) % len(places)]
        steps, way = ways[(pair // len(kinds) + pair % len(kinds) + turn) % len(ways)]
        both = _Pair(kind=kind, place=place, split=splits[pair])
        case = _case(recipe, both, steps, way, int(pressed[pair]))
        drawn = draw(recipe.vary, seed=recipe.seed, number=k)
        if drawn != NOTHING:
            case = _varied(case, recipe, drawn, turn)
        found.append(case)
        pressed[pair] = max(pressed[pair], steps)
    return found


def _splits(recipe: Recipe, pairs: int, rng: np.random.Generator) -> list[Split]:
    """The split of each pair in dealt order."""
    kinds, seen, found = recipe.indenters, 0, []
    shares = [
        split for split, count in zip(SHARED, recipe.shares, strict=True) for _ in range(count)
    ]
    block: list[Split] = []
    for pair in range(pairs):
        if recipe.hold_out and kinds[pair % len(kinds)] in UNSEEN:
            found.append(Split.UNSEEN)
            continue
        if seen % len(shares) == 0:
            block = [shares[k] for k in rng.permutation(len(shares))]
        found.append(block[seen % len(shares)])
        seen += 1
    return found


def _case(recipe: Recipe, pair: _Pair, steps: int, way: int, pressed: int) -> Case:
    """A pair pressed one way.

    Args:
        steps: Of depth.
        way: Direction of the shear; -1 for none.
        pressed: Steps of depth that an earlier case of the pair has taken.
    """
    kind, place = pair.kind, pair.place
    name = f"{kind.value}_{place.name}"
    depth_mm = recipe.depth_mm * steps / recipe.depth_steps
    if recipe.shear_every_depth and recipe.shear_directions:
        name += f"_depth{depth_mm:.3g}"
    name += f"_shear{way}" if way >= 0 else "_press"
    return Case(
        id=name,
        split=pair.split,
        indenter=kind,
        position=place,
        depth_mm=depth_mm,
        press_frames=steps,
        shear=way,
        shear_mm=(0.0, 0.0)
        if way < 0
        else shear_way_mm(way, recipe.shear_directions, recipe.shear_mm),
        shear_frames=recipe.shear_steps if way >= 0 else 0,
        first_new=min(steps, pressed),
    )


def _varied(case: Case, recipe: Recipe, drawn: Drawn, turn: int) -> Case:
    """A case with what it has drawn: no state of another one comes again in it."""
    return dataclasses.replace(
        case,
        id=f"{case.id}_{turn}" if turn else case.id,
        drawn=drawn,
        twist_frames=0 if drawn.twist_deg is None else recipe.twist_frames,
        first_new=0,
    )
