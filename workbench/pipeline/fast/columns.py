"""The stage `columns`: compliance of one tile of a skin; `condensed` and `hardening` ask for it."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.monitor import Monitor
from workbench.core.design.design import Elastomer
from workbench.core.result.condensed import SkinColumns
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.stage import Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class ColumnsInputs:
    """What the columns of a tile depend on."""

    mesh: MembraneMesh
    """That of `node_mesh`."""
    material: Elastomer
    wall_mm: float
    """Elastomer of the design: it says how far a push is felt."""
    tile: int


def columns(given: ColumnsInputs, *, monitor: Monitor) -> SkinColumns:
    """Columns of the nodes of a tile."""
    from sim.condensed.columns import tile_columns
    from sim.condensed.tiles import reach_mm, tiles

    monitor(0.0)
    nodes = tiles(given.mesh.outer.points_mm)[given.tile]
    return tile_columns(given.mesh, given.material, nodes, reach_mm(given.wall_mm))


STAGE = Stage(
    name="columns",
    label="Compliance of a tile",
    version=1,
    place=24,
    lane="sim",
    run=columns,
    shown=False,
)
