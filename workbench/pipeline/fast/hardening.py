"""The stage `hardening`: how a condensed skin hardens, fitted to presses of the contact solver."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from workbench.core.base.monitor import Monitor
from workbench.core.design.design import Elastomer
from workbench.core.design.imported import IMPORTED
from workbench.core.press.press import ContactSettings
from workbench.core.result.condensed import Hardening, SkinColumns
from workbench.core.result.results import MaterialPoints, MembraneMesh
from workbench.core.result.sensing import Contact
from workbench.pipeline.devices import start_device
from workbench.pipeline.fast.condensed import (
    CondensedInputs,
    at_rest,
    load_mesh,
    tile_call,
)
from workbench.pipeline.stage import PART, Chain, Stage
from workbench.pipeline.stages.press import STAGE as PRESS
from workbench.pipeline.stages.press import PressInputs, elastic
from workbench.pipeline.store import Store


@dataclass(frozen=True, kw_only=True, slots=True)
class HardeningInputs:
    """What the law depends on."""

    nodes: MembraneMesh
    """That of `node_mesh`."""
    mesh: MembraneMesh
    """The design's, which is pressed."""
    points: MaterialPoints
    material: Elastomer
    wall_mm: float
    """Elastomer of the design."""
    target_mm: tuple[float, float, float] | None
    """Where the family is pressed; None for an imported body, which is pressed at its top."""
    settings: ContactSettings
    columns: tuple[SkinColumns, ...] = field(default=(), metadata=PART)
    """Of the tiles around the target."""
    contacts: tuple[Contact, ...] = field(default=(), metadata=PART)


def inputs(chain: Chain) -> HardeningInputs:
    """Both meshes, the material, and where the family is pressed."""
    from designs.family import family

    design = chain.design
    imported = design.family == IMPORTED
    return HardeningInputs(
        nodes=chain.result("node_mesh"),
        mesh=chain.result("mesh"),
        points=chain.result("lattice"),
        material=elastic(design.material),
        wall_mm=design.layers.elastomer_mm,
        target_mm=None if imported else family(design.family).target(chain.shape, design.layers),
        settings=chain.case.settings,
    )


def parts(given: HardeningInputs, store: Store) -> dict[str, Any]:
    """The tiles around the target, and the presses."""
    from sim.condensed.lessons import NEAR_MM, lessons
    from sim.condensed.tiles import tiles

    points_mm = load_mesh(given.nodes, store).outer.points_mm
    centre_mm = points_mm[_centre(points_mm, given.target_mm)]
    away_mm = np.linalg.norm(points_mm - centre_mm, axis=1)
    near = [k for k, nodes in enumerate(tiles(points_mm)) if away_mm[nodes].min() < NEAR_MM]
    skin = CondensedInputs(
        mesh=given.nodes, material=at_rest(given.material), wall_mm=given.wall_mm
    )
    presses = tuple(
        PRESS.call(
            PressInputs(
                mesh=given.mesh,
                points=given.points,
                material=given.material,
                indenter=indenter,
                path=path,
                settings=given.settings,
            )
        )
        for indenter, path in lessons(tuple(centre_mm.tolist()), given.wall_mm)
    )
    return {"columns": tuple(tile_call(skin, k) for k in near), "contacts": presses}


def _centre(points_mm: np.ndarray, target_mm: tuple[float, float, float] | None) -> int:
    """Node in the middle of the presses."""
    if target_mm is None:
        return int(points_mm[:, 2].argmax())
    return int(np.linalg.norm(points_mm - target_mm, axis=1).argmin())


def hardening(given: HardeningInputs, *, monitor: Monitor) -> Hardening:
    """The law that fits the presses."""
    start_device(monitor)
    from sim.condensed.assemble import condensed
    from sim.condensed.lessons import learnt, lessons
    from sim.condensed.tiles import reach_mm

    skin = condensed(given.nodes, given.columns, reach_mm(given.wall_mm))
    objects = [indenter for indenter, _ in lessons((0.0, 0.0, 0.0), given.wall_mm)]
    return learnt(skin, given.material, list(zip(objects, given.contacts, strict=True)))


STAGE = Stage(
    name="hardening",
    label="Hardening of the skin",
    version=5,
    place=26,
    lane="sim",
    run=hardening,
    inputs=inputs,
    parts=parts,
    shown=False,
)
