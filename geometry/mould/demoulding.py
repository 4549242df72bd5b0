"""How a mould is opened: a list of motions, found by trying, each looked at for what is in its way.

Two orders are known: the outer parts first and then the core out of the free skin, or the core
first while the outer parts hold the skin. Either can be the only one: a bent core cannot leave a
skin that is held, and an undercut that would squeeze a skin against its core can be left once the
skin may dent. The first is taken where it asks little of the skin, else the one that asks less; an
order with a rigid part in the way comes last.

A core that leaves a free skin may go aslant: for a bent one, which leans from its opening to its
tip, the way on which the least of its wall meets the skin where that lies is searched.

Leaves out: turning parts on their way; friction.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from geometry.body.csg import Body
from geometry.body.csg_mesh import closed, evaluate
from geometry.mould.cast import Cast
from geometry.mould.castability import LIFT_MM, Worst
from geometry.mould.parting import Parting
from geometry.mould.squeezing import confined_strain, outer_strain
from geometry.mould.sweeping import swept, way_mm
from geometry.surface.offset import inside
from geometry.surface.spread import spread
from workbench.core.result.fabrication import FabricationPart, PartMotion

APART_MM = 15.0
"""How much farther a part goes than it must [mm]."""
EASY_STRAIN = 0.05
"""No silicone minds a strain as small as this [1]."""
DOWN = np.array([0.0, 0.0, -1.0])
TILTS_DEG = tuple(range(0, 27, 2))
WAYS_MM = (2.0, 6.0, 12.0, 20.0, 30.0)
"""How far a core is drawn to see what it meets of the skin [mm]."""
STRAIGHT_SHARE = 0.01
"""A core less of whose wall ever meets the skin goes straight out [1]."""
SAMPLES = 1500
UPRIGHT_SHARE = 0.02
"""A core whose tip is aside of its opening by less of its height stands upright [1]."""
LEAN_SHARE = 0.05
"""Share of a core's height at either end that tells where its middle is."""


def opening(
    parts: Sequence[FabricationPart], cast: Cast, parting: Parting, core_pull: np.ndarray
) -> tuple[PartMotion, ...]:
    """The motions that open a mould, the best of the known orders.

    Args:
        parts: The finished outer parts and, last, the core.
        core_pull: Direction in which the core leaves a free skin.
    """
    solids = {part.name: closed(part.name, part.points_mm, part.faces) for part in parts}
    skin = evaluate(cast.outer)
    tried = []
    for order in _orders(list(solids), cast, parting, core_pull):
        tried.append(_motions(order, solids, skin))
        if all(motion.free for motion in tried[-1]):
            return tried[-1]
    return min(tried, key=hardship)


def hardship(motions: Sequence[PartMotion]) -> tuple[bool, float]:
    """Whether a rigid part is in the way, and the skin's largest strain [1]: less is better."""
    return not all(motion.free for motion in motions), max(motion.strain for motion in motions)


class _Pull(NamedTuple):
    """One part's way out, before it is known what is in it."""

    part: str
    way: np.ndarray
    """Unit direction, shape (3,)."""
    stretch: Worst
    """What the skin must stretch for it."""


def _strain(order: Sequence[_Pull]) -> float:
    return max(pull.stretch.value for pull in order)


def _orders(
    names: Sequence[str], cast: Cast, parting: Parting, core_pull: np.ndarray
) -> Iterator[list[_Pull]]:
    """The known orders, the best first: where its ways are free, the next need not be tried."""
    first = _order(names, cast, parting, core_pull, outer_first=True)
    easy = _strain(first) <= max(EASY_STRAIN, confined_strain(cast, DOWN).value)
    if easy:
        yield first
    other = _order(names, cast, parting, DOWN, outer_first=False)
    yield from [other] if easy else sorted((first, other), key=_strain)


def _order(
    names: Sequence[str], cast: Cast, parting: Parting, core_pull: np.ndarray, *, outer_first: bool
) -> list[_Pull]:
    """One of the known orders, with what it asks of the skin.

    Args:
        names: Of the outer parts and, last, the core.
    """
    *outer, core = names
    ways = dict(zip(outer, parting.pulls, strict=True))
    return [
        _Pull(
            name,
            ways.get(name, core_pull),
            _stretch(cast, parting, name, outer, outer_first=outer_first),
        )
        for name in ((*outer, core) if outer_first else (core, *outer))
    ]


def _motions(
    order: Sequence[_Pull], solids: Mapping[str, Any], skin: Any
) -> tuple[PartMotion, ...]:
    """The motions of an order, with what is in the way of each.

    Args:
        solids: The parts as manifolds, closed.
        skin: The membrane's outside as a manifold.
    """
    placed = dict(solids)
    found: list[PartMotion] = []
    for name, way, stretch in order:
        others = {other: solid for other, solid in placed.items() if other != name}
        # What has moved is out of the way already, and need not be passed again.
        gone = {motion.part for motion in found}
        near = {other: solid for other, solid in others.items() if other not in gone}
        distance_mm = way_mm(placed[name], {**near, "skin": skin}, way) + APART_MM
        met = swept(placed[name], others, way, distance_mm)
        found.append(
            PartMotion(
                step=len(found) + 1,
                part=name,
                direction=_triple(way),
                distance_mm=round(distance_mm, 1),
                overlap_mm3=met.overlap_mm3,
                tolerance_mm3=met.tolerance_mm3,
                overlap_at_mm=met.place_mm,
                strain=stretch.value,
                strain_at_mm=stretch.place_mm,
            )
        )
        placed[name] = placed[name].translate(distance_mm * way)
    return tuple(found)


def _stretch(
    cast: Cast, parting: Parting, name: str, outer: Sequence[str], *, outer_first: bool
) -> Worst:
    """What the skin must stretch for one part; a core that leaves a free skin is `core_release`."""
    if name in outer:
        backed = outer_first or cast.core is None
        return outer_strain(cast, parting, list(outer).index(name), backed=backed)
    if outer_first:
        return Worst(0.0, (0.0, 0.0, 0.0))
    return confined_strain(cast, DOWN)


def core_way(cast: Cast) -> np.ndarray:
    """Unit direction in which the core leaves a free skin, shape (3,)."""
    core = cast.core
    if core is None:
        return DOWN
    wall = spread(core.points_mm, core.faces, SAMPLES)
    # A hair inside the core, so that a wall that slides along the skin does not meet it.
    start = wall.points_mm - LIFT_MM * wall.normals
    if _met(cast, core, start, [DOWN])[0] <= STRAIGHT_SHARE:
        return DOWN
    lean = _lean(core.points_mm)
    if lean is None:
        return DOWN
    ways = [_aslant(lean, tilt) for tilt in TILTS_DEG]
    return ways[int(np.argmin(_met(cast, core, start, ways)))]


def _met(cast: Cast, core: Body, start_mm: np.ndarray, ways: Sequence[np.ndarray]) -> np.ndarray:
    """Largest share of a core's wall that is in the skin, where that lies, on each way, shape (W,).

    Args:
        start_mm: Places on the wall, shape (S, 3).
    """
    gone = np.array([[gone_mm * way for gone_mm in WAYS_MM] for way in ways])
    places = (gone[:, :, None] + start_mm).reshape(-1, 3)
    in_skin = inside(cast.outer.points_mm, cast.outer.faces, places)
    in_skin &= ~inside(core.points_mm, core.faces, places)
    return in_skin.reshape(len(ways), len(WAYS_MM), -1).mean(axis=2).max(axis=1)


def _lean(points_mm: np.ndarray) -> np.ndarray | None:
    """Unit direction in which a core leans from its opening to its tip, shape (2,); None where it
    stands upright.
    """
    low, high = points_mm[:, 2].min(), points_mm[:, 2].max()
    reach = LEAN_SHARE * (high - low)
    ends = [points_mm[points_mm[:, 2] < low + reach], points_mm[points_mm[:, 2] > high - reach]]
    root, tip = ((end.min(axis=0) + end.max(axis=0))[:2] / 2 for end in ends)
    aside_mm = float(np.linalg.norm(tip - root))
    return (tip - root) / aside_mm if aside_mm > UPRIGHT_SHARE * (high - low) else None


def _aslant(lean: np.ndarray, tilt_deg: float) -> np.ndarray:
    turn = np.radians(tilt_deg)
    return np.array([*(-np.sin(turn) * lean), -np.cos(turn)])


def drawn_apart(
    parts: Sequence[FabricationPart], motions: Sequence[PartMotion]
) -> list[FabricationPart]:
    """The parts with the way and the place that their motions give them."""
    ways = {motion.part: motion for motion in motions}
    return [
        dataclasses.replace(
            part,
            pull=ways[part.name].direction,
            explode=_triple(ways[part.name].distance_mm * np.array(ways[part.name].direction)),
        )
        for part in parts
    ]


def _triple(vector: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in vector)
    return x, y, z
