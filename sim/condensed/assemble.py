"""The compliance of a whole skin, put together from the columns of its tiles."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from sim.condensed.tiles import skin_normals, walls_mm
from workbench.core.result.condensed import CondensedSkin, SkinColumns
from workbench.core.result.results import MembraneMesh

NOTHING = SkinColumns(
    nodes=np.zeros(0, np.int32),
    starts=np.zeros(1, np.int64),
    neighbours=np.zeros(0, np.int32),
    blocks_mm_N=np.zeros((0, 3, 3), np.float32),
)
"""The compliance of a skin of which nothing is known."""


def bare(mesh: MembraneMesh, reach_mm: float) -> CondensedSkin:
    """The skin of a membrane before anything is known of how it gives."""
    return CondensedSkin(
        points_mm=mesh.outer.points_mm,
        normals=skin_normals(mesh),
        wall_mm=walls_mm(mesh),
        faces=mesh.outer.faces.astype(np.int32),
        reach_mm=reach_mm,
        compliance=NOTHING,
    )


def condensed(mesh: MembraneMesh, parts: Sequence[SkinColumns], reach_mm: float) -> CondensedSkin:
    """The skin of a membrane with the columns of its tiles; what no tile holds does not move."""
    return known(bare(mesh, reach_mm), parts)


def known(skin: CondensedSkin, parts: Sequence[SkinColumns]) -> CondensedSkin:
    """A skin with the columns of tiles.

    Two tiles know of a pair that lies across their border, each from a piece cut off elsewhere:
    the mean of both is taken, or the compliance would not be symmetric.
    """
    return dataclasses.replace(skin, compliance=symmetric(len(skin.points_mm), parts))


def symmetric(count: int, parts: Sequence[SkinColumns]) -> SkinColumns:
    """All `count` rows: of each pair the mean of what both of its nodes say, else of the one."""
    pushed = np.concatenate([np.repeat(part.nodes, np.diff(part.starts)) for part in parts])
    moved = np.concatenate([part.neighbours for part in parts])
    blocks = np.concatenate([part.blocks_mm_N for part in parts])
    pairs = pushed.astype(np.int64) * count + moved
    order = np.argsort(pairs, kind="stable")
    known, turned = pairs[order], moved.astype(np.int64) * count + pushed
    both = np.union1d(known, turned)
    padded = np.concatenate([blocks[order], np.zeros((1, 3, 3), np.float32)])
    rows, columns = np.divmod(both, count)
    mine = _places(known, columns * count + rows)
    its = _places(known, both)
    total = padded[mine] + np.swapaxes(padded[its], 1, 2)
    told = (mine < len(known)).astype(np.float32) + (its < len(known))
    return SkinColumns(
        nodes=np.arange(count, dtype=np.int32),
        starts=np.searchsorted(rows, np.arange(count + 1)).astype(np.int64),
        neighbours=columns.astype(np.int32),
        blocks_mm_N=(total / told[:, None, None]).astype(np.float32),
    )


def _places(known: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Where values lie in sorted ones, shape as `wanted`; how many there are for one that does
    not."""
    found = np.searchsorted(known, wanted)
    there = known[np.minimum(found, len(known) - 1)] == wanted
    return np.where(there, found, len(known))
