"""The stage `condensed`: the compliance of a whole skin, for fast contact."""

from __future__ import annotations

from dataclasses import dataclass, field

from workbench.core.base.digest import at_defaults
from workbench.core.base.monitor import Monitor
from workbench.core.design.design import Elastomer
from workbench.core.result.condensed import CondensedSkin, SkinColumns
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.fast.columns import STAGE as COLUMNS
from workbench.pipeline.fast.columns import ColumnsInputs
from workbench.pipeline.stage import PART, Call, Chain, Stage
from workbench.pipeline.stages.press import elastic
from workbench.pipeline.store import Store


@dataclass(frozen=True, kw_only=True, slots=True)
class CondensedInputs:
    """What the compliance of a skin depends on."""

    mesh: MembraneMesh
    """That of `node_mesh`."""
    material: Elastomer
    wall_mm: float
    """Elastomer of the design."""
    columns: tuple[SkinColumns, ...] = field(default=(), metadata=PART)


def inputs(chain: Chain) -> CondensedInputs:
    """The nodes and the material."""
    return CondensedInputs(
        mesh=chain.result("node_mesh"),
        material=at_rest(chain.design.material),
        wall_mm=chain.design.layers.elastomer_mm,
    )


def at_rest(material: Elastomer) -> Elastomer:
    """A material without what a skin that is not touched does not know."""
    return at_defaults(elastic(material), "friction", "kinetic_friction")


def parts(given: CondensedInputs, store: Store) -> dict[str, tuple[Call, ...]]:
    """The columns of all tiles."""
    from sim.condensed.tiles import tiles

    mesh = load_mesh(given.mesh, store)
    return {"columns": tuple(tile_call(given, k) for k in range(len(tiles(mesh.outer.points_mm))))}


def load_mesh(mesh: MembraneMesh, store: Store) -> MembraneMesh:
    """The stored mesh that an input of a call stands for."""
    call = COLUMNS.call(ColumnsInputs(mesh=mesh, material=Elastomer(), wall_mm=1.0, tile=0))
    (ref,) = call.reads
    return store.load(ref.stage, ref.key)


def tile_call(given: CondensedInputs, tile: int) -> Call:
    """The call for the columns of a tile."""
    return COLUMNS.call(
        ColumnsInputs(mesh=given.mesh, material=given.material, wall_mm=given.wall_mm, tile=tile)
    )


def condensed(given: CondensedInputs, *, monitor: Monitor) -> CondensedSkin:
    """The skin with its compliance."""
    from sim.condensed import assemble
    from sim.condensed.tiles import reach_mm

    return assemble.condensed(given.mesh, given.columns, reach_mm(given.wall_mm))


STAGE = Stage(
    name="condensed",
    label="Compliance of the skin",
    version=1,
    place=25,
    lane="sim",
    run=condensed,
    inputs=inputs,
    parts=parts,
    shown=False,
    heavy=True,
)
