"""Another program's results of a deck as the same `ForceField` that our solver makes.

CalculiX's own file is read by `deck_dat`. Others: comma-separated values with the columns step,
node, ux, uy, uz, fx, fy, fz [mm, N] for the nodes of NOUT, f the contact force on the skin.
A result of fewer steps than the press has frames is refused: it did not converge.
"""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass

import numpy as np

from sim.fem.decks.deck import DeckCase
from workbench.core.base.errors import SolveError, StoreError
from workbench.core.base.frames import quaternion
from workbench.core.result.force_field import ForceField, Source

COLUMNS = ("step", "node", "ux", "uy", "uz", "fx", "fy", "fz")


@dataclass(frozen=True, kw_only=True)
class OtherResult:
    """What another program found, at the nodes of the part, frame by frame."""

    displacement_mm: np.ndarray
    """Shape (K, N, 3)."""
    contact_N: np.ndarray
    """Force of the object on the nodes, shape (K, N, 3)."""
    reaction_N: np.ndarray
    """Force on the object, shape (K, 3)."""
    program: str


def expect_frames(found: int, count: int) -> None:
    """Refuse results of fewer or more steps than the press has frames.

    Raises:
        SolveError: If there are fewer.
        StoreError: If there are more.
    """
    if found < count:
        raise SolveError(
            f"the results end after {found} of {count} frames: the program did not converge, or "
            "is still running",
            hint="look at its log; smaller first increments in the deck may help",
            frame=found,
            last_good=found - 1,
        )
    if found > count:
        raise StoreError(
            f"the results have {found} steps, the press has {count} frames",
            hint="name the results of this very deck",
        )


def read_table(text: str, case: DeckCase) -> OtherResult:
    """Comma-separated values of any program; columns in any order.

    Raises:
        StoreError: If a column, a node or a number is missing, or nodes are not those of NOUT.
        SolveError: If it has fewer steps than the press has frames.
    """
    rows = csv.DictReader(io.StringIO(text), skipinitialspace=True)
    missing = set(COLUMNS) - {name.strip() for name in rows.fieldnames or () if name}
    if missing:
        raise StoreError(
            f"the table has no column {', '.join(sorted(missing))}",
            hint=f"the first line names the columns {','.join(COLUMNS)}",
        )
    try:
        values = np.array([[float(row[name]) for name in COLUMNS] for row in rows]).reshape(-1, 8)
    except (TypeError, ValueError) as error:
        raise StoreError(f"the table is damaged: {error}", hint="write it again") from error
    if not np.isfinite(values).all():
        raise StoreError("the table holds a value that is not finite", hint="run it again")
    count, nodes = case.approach.frame_count, np.flatnonzero(case.submodel.marks.outer >= 0)
    expect_frames(len(np.unique(values[:, 0])), count)
    shape = (count, len(case.submodel.marks.outer), 3)
    moved, forces = np.zeros(shape), np.zeros(shape)
    for frame in range(count):
        of_step = values[values[:, 0] == frame + 1]
        of_step = of_step[np.argsort(of_step[:, 1])]
        if not np.array_equal(of_step[:, 1], nodes + 1):
            raise StoreError(
                f"step {frame + 1} of the table has other nodes than the set NOUT",
                hint="give each node of NOUT once in each step, steps counted from 1",
            )
        moved[frame, nodes], forces[frame, nodes] = of_step[:, 2:5], of_step[:, 5:8]
    return OtherResult(
        displacement_mm=moved,
        contact_N=forces,
        reaction_N=-forces.sum(axis=1),
        program="another program",
    )


def force_field(
    result: OtherResult, case: DeckCase, vertices: int, spacing_mm: float
) -> ForceField:
    """Another program's result as ours stand.

    The balance is what the nodal forces lack of the reaction; residuals are not known (NaN).

    Args:
        result: What it found.
        case: What the deck was written for.
        vertices: Vertices of the outer skin.
        spacing_mm: Edge of a hexahedron.
    """
    submodel, approach = case.submodel, case.approach
    skin = np.flatnonzero(submodel.marks.outer >= 0)
    count = approach.frame_count
    moved = np.zeros((count, vertices, 3), dtype=np.float32)
    forces = np.zeros_like(moved)
    moved[:, submodel.marks.outer[skin]] = result.displacement_mm[:, skin]
    forces[:, submodel.marks.outer[skin]] = result.contact_N[:, skin]
    missing_N = np.linalg.norm(result.contact_N.sum(axis=1) + result.reaction_N, axis=1)
    poses = [approach.pose(frame + 1.0) for frame in range(count)]
    return ForceField(
        source=Source.FEM,
        displacement_mm=moved,
        contact_force_N=forces,
        reaction_N=result.reaction_N,
        target_mm=approach.target_mm,
        normal=approach.normal,
        tangent_u=approach.tangent_u,
        indenter_pose=np.stack([np.concatenate([at, quaternion(turn)]) for at, turn in poses]),
        residual=np.full(count, np.nan),
        balance=missing_N / np.maximum(np.linalg.norm(result.reaction_N, axis=1), 1e-12),
        converged=np.ones(count, dtype=bool),
        radius_mm=submodel.part.radius_mm,
        spacing_mm=spacing_mm,
        solver=f"{result.program}, {len(submodel.body.elements.cells)} {case.element.value}",
    )
