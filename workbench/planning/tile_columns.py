"""The compliance of a skin, tile by tile, as fast contact asks for it: from the store, or made."""

from __future__ import annotations

from collections.abc import Callable

from workbench.core.base.monitor import Monitor, silent
from workbench.core.result.condensed import SkinColumns
from workbench.pipeline.fast.condensed import CondensedInputs, tile_call
from workbench.pipeline.store import Store
from workbench.planning.running import run


def tile_finder(
    store: Store, skin: CondensedInputs, monitor: Monitor = silent
) -> Callable[[int], SkinColumns]:
    """What finds the columns of a tile by its number.

    Args:
        store: Where they are kept.
        skin: As a plan has it, its mesh a reference.
        monitor: Told of each tile; raises to stop.
    """

    def columns(tile: int) -> SkinColumns:
        call = tile_call(skin, tile)
        if not store.has(call.stage, call.key):
            monitor(0.0, "finding how the skin gives here")
        run(store, call)
        return store.load(call.stage, call.key)

    return columns
