"""A compliance on disk: the pairs once each, in half precision, a quarter of its size.

C is symmetric, so blocks of pairs i <= j say all. Half precision errs by 5e-4 of a block, which
moves forces by less.
"""

from __future__ import annotations

import numpy as np

from workbench.core.result.condensed import SkinColumns


def halved(whole: SkinColumns) -> dict[str, np.ndarray]:
    """Pairs i <= j of a symmetric compliance."""
    rows = np.repeat(np.arange(len(whole.nodes)), np.diff(whole.starts))
    kept = whole.neighbours >= rows
    counts = np.bincount(rows[kept], minlength=len(whole.nodes))
    return {
        "counts": counts.astype(np.uint16),
        "neighbours": whole.neighbours[kept],
        "blocks": whole.blocks_mm_N[kept].astype(np.float16),
    }


def made_whole(half: dict[str, np.ndarray]) -> SkinColumns:
    """The compliance that was halved."""
    count = len(half["counts"])
    rows = np.repeat(np.arange(count), half["counts"])
    columns, blocks = half["neighbours"], half["blocks"].astype(np.float32)
    other = np.flatnonzero(rows != columns)
    rows, columns = (
        np.concatenate([rows, columns[other]]),
        np.concatenate([columns, rows[other]]),
    )
    blocks = np.concatenate([blocks, np.swapaxes(blocks[other], 1, 2)])
    order = np.lexsort((columns, rows))
    return SkinColumns(
        nodes=np.arange(count, dtype=np.int32),
        starts=np.append(0, np.cumsum(np.bincount(rows, minlength=count))).astype(np.int64),
        neighbours=columns[order].astype(np.int32),
        blocks_mm_N=blocks[order],
    )
