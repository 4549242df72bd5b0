"""The contact solver beside finite elements: the same presses on the same skin.

Both find the force of an object 1 mm deep in the finger's tip. Neither is the limit of its own
refinement, so forces are held to what finite elements tend to on ever finer uniform meshes, which
is on record with how well it is known (`finger_record`); the table of refinements says where both
go. Displacements are those of finite elements at their default, vertex by vertex: the skin is that
of the hexahedra.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator

import numpy as np

from workbench.core.base.errors import StoreError
from workbench.core.base.monitor import silent
from workbench.core.design.design import Elastomer
from workbench.core.press.fem import DRAFT_MM, QUALITY_MM
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.press import ContactSettings, Press
from workbench.core.result.force_field import ForceField, from_contact
from workbench.pipeline.devices import open_device
from workbench.pipeline.stages.press import PressInputs, press
from workbench.proof.row import Row, bounded, compared, stated
from workbench.proof.specimens import finger_points
from workbench.proof.validation.contact.finger_record import FINGER, limit_N
from workbench.proof.validation.contact.presses import tip_target
from workbench.proof.validation.fem.fem_presses import FRAMES, Case, finger, solved

KINDS = (IndenterKind("sphere"), IndenterKind("cylinder_end"))
FORCE_LIMIT = 0.03
"""Of the error of the force: a grid of a quarter wall reads 2.2 % less of a ball and 2.8 % less of
a flat end than the limits, which are known to 1.4 and 2.4 %."""
SHAPE_LIMIT = 0.03
MOVED_MM = 0.1
DEPTH_MM = 1.0
GRID_MM = 0.5
FINE_GRIDS_MM = (0.7, 0.5, 0.36)
FINE_EDGES_MM = (DRAFT_MM, QUALITY_MM, 0.3)
PATCH_MM = 9.0
"""Radius of the submodels of the table: enough for totals [mm]."""


def rows() -> list[Row]:
    """Force and displacement at the default settings of both."""
    return [row for kind in KINDS for row in _kind_rows(kind)]


def fine_rows() -> list[Row]:
    """The table of refinements, which takes many minutes."""
    return [row for kind in KINDS for row in (*_grids(kind), *_edges(kind), _converged(kind))]


def _kind_rows(kind: IndenterKind) -> Iterator[Row]:
    case = f"{kind} at 45 degrees, {DEPTH_MM:g} mm deep: grid {GRID_MM:g} mm against"
    yield compared(
        "mpm_against_fem",
        f"{case} finite elements: normal force; reference: {_limit_words(kind)}; null: without "
        "friction",
        lambda: float(pressed(kind).normal_N[-1]),
        functools.partial(_limit_N, kind),
        unit="N",
        limit=FORCE_LIMIT,
        null=lambda: float(pressed(kind, friction=0.0).normal_N[-1]),
        record=FINGER,
    )
    yield bounded(
        "mpm_against_fem",
        f"{case} {QUALITY_MM:g} mm hexahedra: root mean square error of the displacement where it "
        f"is {MOVED_MM:g} mm or more, over the depth; null: no displacement",
        lambda: _shape_error(kind)[0],
        unit="1",
        limit=SHAPE_LIMIT,
        null=lambda: _shape_error(kind)[1],
    )


def _shape_error(kind: IndenterKind) -> tuple[float, float]:
    """Error of the displacement over the depth, and the displacement's own size over it."""
    here, there = (
        found.displacement_mm[-1].astype(np.float64) for found in (pressed(kind), _truth(kind))
    )
    size_mm = np.linalg.norm(there, axis=1)
    moved = size_mm >= MOVED_MM
    away_mm = np.linalg.norm(here - there, axis=1)[moved]
    return (
        float(np.sqrt((away_mm**2).mean())) / DEPTH_MM,
        float(np.sqrt((size_mm[moved] ** 2).mean())) / DEPTH_MM,
    )


def _truth(kind: IndenterKind) -> ForceField:
    return solved(Case(kind=kind, hex_mm=QUALITY_MM))


@functools.cache
def pressed(
    kind: IndenterKind,
    *,
    grid_mm: float = GRID_MM,
    friction: float = 0.3,
    hex_mm: float = QUALITY_MM,
) -> ForceField:
    """The press of `fem_presses.solved` by the contact solver, on the skin of its hexahedra."""
    open_device()
    found = press(
        PressInputs(
            mesh=finger(hex_mm),
            points=finger_points(grid_mm),
            material=Elastomer(friction=friction),
            indenter=Indenter(kind=kind),
            path=Press(target_mm=tip_target(45.0, 0.0), depth_mm=DEPTH_MM, frames=FRAMES),
            settings=ContactSettings(grid_mm=grid_mm),
        ),
        monitor=silent,
    )
    return from_contact(found)


def _uniform(kind: IndenterKind, edge_mm: float) -> Case:
    """The press on cells of one size, whose error falls with the square of it."""
    return Case(kind=kind, hex_mm=edge_mm, halvings=0, radius_mm=PATCH_MM)


def _force_N(kind: IndenterKind, edge_mm: float) -> float:
    return float(solved(_uniform(kind, edge_mm)).normal_N[-1])


def _limit_N(kind: IndenterKind) -> float:
    """What the force of finite elements tends to, on record."""
    return limit_N(kind.value)[0]


def _limit_words(kind: IndenterKind) -> str:
    try:
        _, off_N = limit_N(kind.value)
    except StoreError:
        return "finite elements at edge 0, of which there is no record"
    return f"finite elements at edge 0, known to {off_N:.2g} N"


def _grid_N(kind: IndenterKind, grid_mm: float) -> float:
    return float(pressed(kind, grid_mm=grid_mm).normal_N[-1])


def _grids(kind: IndenterKind) -> Iterator[Row]:
    for grid_mm in FINE_GRIDS_MM:
        yield stated(
            "mpm_refinement",
            f"{kind}, contact solver on a grid of {grid_mm:g} mm; null: finite elements at edge 0",
            functools.partial(_grid_N, kind, grid_mm),
            unit="N",
            null=functools.partial(_limit_N, kind),
            record=FINGER,
        )


def _edges(kind: IndenterKind) -> Iterator[Row]:
    for edge_mm in FINE_EDGES_MM:
        yield stated(
            "fem_refinement",
            f"{kind}, hexahedra of {edge_mm:g} mm; null: {_limit_words(kind)}",
            functools.partial(_force_N, kind, edge_mm),
            unit="N",
            null=functools.partial(_limit_N, kind),
            record=FINGER,
        )


def _converged(kind: IndenterKind) -> Row:
    return compared(
        "mpm_against_fem_limit",
        f"{kind}: grid {FINE_GRIDS_MM[-1]:g} mm against {_limit_words(kind)}; null: the default "
        "grid",
        functools.partial(_grid_N, kind, FINE_GRIDS_MM[-1]),
        functools.partial(_limit_N, kind),
        unit="N",
        limit=FORCE_LIMIT,
        null=functools.partial(_grid_N, kind, GRID_MM),
        record=FINGER,
    )
