"""Forces of a press as a trained network predicts them from what the contact solver found.

The solver's displacement, and its force where a network asks for it, is carried to a skin with the
spacing of the training, where the network gives a force per vertex, and a second one, where there
is one, the displacement. Both are carried back to the skin of the design; forces keep their sum
(`transfer`).

    pressure = -f . n / A,  reaction = -sum f,  moment = -sum (x + u - o) x f

with f the force on a vertex, n the outward normal of the deformed skin, A a third of the triangles
around the vertex at rest, x + u its place and o the object's origin. Networks compute in float32:
a result that is stored must not depend on what the machine's processor can do faster.

Left out: stress, energy and slip, which these networks do not predict; what nobody solved for has
no residual.
"""

from __future__ import annotations

import contextlib
import dataclasses
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sim.forces.acquaintance import BETWEEN, Acquaintance
from sim.forces.network.inputs import given_field
from sim.forces.network.spec import Target
from sim.forces.network.weights import NetworkWeights
from sim.forces.peaks import pressure_MPa
from sim.forces.shares import shares_on
from sim.forces.transfer import transferred
from workbench.core.base.errors import StoreError
from workbench.core.base.monitor import Monitor, silent
from workbench.core.result.force_field import ForceField, Source
from workbench.core.result.results import MembraneMesh, Skin
from workbench.core.result.sensing import Contact

if TYPE_CHECKING:
    from sim.forces.network.steady import SteadyPredictor


@dataclass(frozen=True, kw_only=True, slots=True)
class Known:
    """Weights, and how well they know the press."""

    name: str
    """Of their file, for people."""
    weights: NetworkWeights
    acquaintance: Acquaintance


@dataclass(frozen=True, slots=True)
class Pair:
    """A force network, and a displacement network beside it.

    Raises:
        StoreError: If weights are not of the kind that they are given for.
    """

    force: Known
    displacement: Known | None = None
    """Without one, the displacement is the solver's."""

    def __post_init__(self) -> None:
        _expect_target(self.force, Target.FORCE)
        if self.displacement is not None:
            _expect_target(self.displacement, Target.DISPLACEMENT)


def learned_forces(
    mesh: MembraneMesh,
    contact: Contact,
    source: MembraneMesh,
    networks: Pair,
    *,
    device: str = "cpu",
    monitor: Monitor = silent,
) -> ForceField:
    """Predict forces, and displacements where there are weights for them, frame by frame.

    Args:
        mesh: Of the design, on whose skin the press was solved.
        contact: What the contact solver found.
        source: The same membrane at the spacing of the weights.
        networks: Their weights.
        device: Where PyTorch computes.
        monitor: Told the frames; raises `Cancelled` to stop.

    Raises:
        SolveError: If a displacement, or a prediction, is not finite.
        DeviceError: If the device has no room for a network.
    """
    from sim.forces.network.steady import steady_predictor

    force, displacement = networks.force, networks.displacement
    monitor(0.0, "carrying the displacement to the network's points")
    given_mm, given_N = _carried(mesh.outer, source.outer, contact)
    used = [force] if displacement is None else [force, displacement]
    points_mm, faces = source.outer.points_mm, source.outer.faces
    predictors = [steady_predictor(k.weights, points_mm, faces, device=device) for k in used]
    given = [
        given_field(known.weights, given_mm, given_N, factor=known.acquaintance.young_ratio)
        for known in used
    ]
    fields, seconds = _predicted(predictors, given, monitor)
    force_N = fields[0] * np.float32(force.acquaintance.factor)
    moved_mm = fields[1] if displacement is not None else given_mm
    found = _force_field(source.outer, contact, force_N, moved_mm, seconds)
    reasons = dict.fromkeys(r for known in used for r in known.acquaintance.reasons)
    found = dataclasses.replace(
        found,
        solver=f"{' and '.join(known.name for known in used)} on {device}, "
        f"{1e3 * np.median(seconds):.0f} ms a frame",
        notice=BETWEEN.join(reasons),
        note=force.acquaintance.note,
    )
    monitor(1.0, "carrying the forces to the skin")
    shown = transferred(found, source, mesh)
    if displacement is None:
        # Its own numbers, not those that went to the network's points and back.
        return dataclasses.replace(shown, displacement_mm=contact.displacement_mm)
    return shown


def _carried(skin: Skin, points: Skin, contact: Contact) -> tuple[np.ndarray, np.ndarray]:
    """Displacement [mm] and force [N] of the contact solver at the network's points, (K, V, 3)."""
    there = shares_on(skin, points.points_mm)
    back = shares_on(points, skin.points_mm)
    return (
        there.interpolate(np.asarray(contact.displacement_mm)),
        back.spread(np.asarray(contact.contact_force_N), len(points.points_mm)),
    )


def _expect_target(known: Known, wanted: Target) -> None:
    if known.weights.target is not wanted:
        raise StoreError(
            f"{known.name} predicts {known.weights.target}, not {wanted}",
            hint=f"choose weights whose name has -{wanted}- in it",
            at="learned.weights",
        )


def _predicted(
    predictors: Sequence[SteadyPredictor], given: Sequence[np.ndarray], monitor: Monitor
) -> tuple[list[np.ndarray], np.ndarray]:
    """Fields of each network, (K, V, 3), from what enters each; time of each frame [s], (K,)."""
    rows: list[list[np.ndarray]] = [[] for _ in predictors]
    count = len(given[0])
    seconds = np.zeros(count)
    with _one_thread():
        for frame in range(count):
            monitor(frame / count, f"frame {frame + 1} of {count}")
            begun = time.perf_counter()
            for row, predictor, fields in zip(rows, predictors, given, strict=True):
                row.append(predictor.predict(fields[frame]))
            seconds[frame] = time.perf_counter() - begun
    return [np.stack(row) for row in rows], seconds


@contextlib.contextmanager
def _one_thread() -> Iterator[None]:
    """Let PyTorch compute in one thread.

    A frame is a thousand small products, after each of which threads wait for each other: on two
    cores that other programs use as well, two threads took 2,500 ms a frame where one took 140.
    """
    import torch

    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)


def _force_field(
    skin: Skin,
    contact: Contact,
    force_N: np.ndarray,
    moved_mm: np.ndarray,
    seconds: np.ndarray,
) -> ForceField:
    """The result on the network's points, (K, V, 3) each."""
    reaction_N = -force_N.sum(axis=1, dtype=np.float64)
    place_mm = skin.points_mm + moved_mm.astype(np.float64)
    arm_mm = place_mm - contact.indenter_pose[:, None, :3]
    return ForceField(
        source=Source.LEARNED,
        displacement_mm=moved_mm,
        contact_force_N=force_N,
        reaction_N=reaction_N,
        target_mm=contact.target_mm,
        normal=contact.normal,
        tangent_u=contact.tangent_u,
        indenter_pose=contact.indenter_pose,
        residual=np.full(len(force_N), np.nan),
        balance=np.full(len(force_N), np.nan),
        converged=np.ones(len(force_N), dtype=bool),
        moment_Nmm=-np.cross(arm_mm, force_N).sum(axis=1),
        pressure_MPa=np.stack(
            [
                pressure_MPa(skin, force, moved).astype(np.float32)
                for force, moved in zip(force_N, moved_mm, strict=True)
            ]
        ),
        frame_seconds=seconds,
    )
