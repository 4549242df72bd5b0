"""A gel of another law: Gent's, which hardens, by the product's finite elements.

    W = -(mu Jm / 2) ln(1 - (I1 - 3) / Jm) + (K / 2) (J - 1)^2,    I1 = J^(-2/3) tr(F^T F).

Source: Gent, Rubber Chemistry and Technology 69 (1996), 59. Its small-strain moduli are those of
the neo-Hookean solid, and its stress that of one whose shear modulus is

    mu Jm / (Jm - (I1 - 3)).

So an increment is solved by neo-Hookean elements of this secant modulus, I1 averaged over each
element, and solved again until the modulus is that of its own solution. Chains of polymer end at
I1 - 3 = Jm; Gent names 30 to 100 for rubber. `LIMIT` is ours, far below: a reality whose law a
reader does not know should be another one at the strains of a press.

Left out: the energy that a frame tells is that of the secant solid.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from typing import Any

import numpy as np

from sim.contact.motion.approach import Approach
from sim.contact.motion.rests import pieces_of
from sim.fem.contact_law import PENALTY, Law
from sim.fem.elements import Elements, displacement_gradient
from sim.fem.increment import Pairing, State, advance, at_rest
from sim.fem.newton import Effort
from sim.fem.obstacle import RigidPose
from sim.fem.press import set_up
from sim.fem.readout import FemFrame, read_frame
from sim.fem.submodel import Submodel
from sim.fem.tangent import Tangent
from workbench.core.base.errors import DesignError, SolveError
from workbench.core.base.freed_memory import freed_memory_kept
from workbench.core.base.monitor import Monitor
from workbench.core.design.design import Elastomer
from workbench.core.design.design import Law as ElasticLaw
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import ForceField, Source
from workbench.core.result.results import MembraneMesh
from workbench.core.result.sampled import SampledDistance

VERSION = 1
"""Of what is solved: raise it when that changes."""
LIMIT = 3.0
"""Jm [1]: a gel that is stretched to twice its length is 1.5 times as stiff as at rest."""
MOST_SHARE = 0.95
"""Of Jm that I1 - 3 counts for: beyond, the chains would be at their end."""
AGREED = 0.003
"""By which the modulus of an increment may differ from that of its solution [1]."""
MOST_ROUNDS = 6
"""Times that an increment is solved."""


def hardening(elements: Elements, displacement_mm: np.ndarray, limit: float) -> np.ndarray:
    """Secant shear modulus over that at rest, shape (M,).

    Args:
        elements: At rest.
        displacement_mm: Of all nodes, shape (N, 3).
        limit: Jm [1].
    """
    deformation = displacement_gradient(elements, displacement_mm) + np.eye(3)
    ratio = np.maximum(np.linalg.det(deformation), 1e-3)
    square = np.einsum("mqij,mqij->mq", deformation, deformation)
    beyond = (elements.weights_mm3 * (square * ratio ** (-2.0 / 3.0) - 3.0)).sum(axis=1)
    share = np.clip(beyond / elements.volume_mm3 / limit, 0.0, MOST_SHARE)
    return 1.0 / (1.0 - share)


def solve_hardening(
    mesh: MembraneMesh,
    material: Elastomer,
    case: PressCase,
    monitor: Monitor,
    *,
    sampled: SampledDistance | None = None,
    limit: float = LIMIT,
) -> ForceField:
    """Solve a press of a gel of Gent's law, frame by frame.

    Args:
        mesh: The membrane, meshed at `case.fem.hex_mm`.
        material: The elastomer: its moduli are those at rest.
        case: The rigid object and its path.
        monitor: Progress and cancellation.
        sampled: The object's distance where a store has it.
        limit: Jm [1].

    Raises:
        DesignError: As `sim.fem.press.solve_press`, and if the design's law is the linear one.
        MeshingError: If the membrane has no hexahedra.
        SolveError: If an increment does not converge.
    """
    if material.law is ElasticLaw.LINEAR:
        raise DesignError(
            "Gent's law hardens what the neo-Hookean one says, and this elastomer is linear",
            hint="set material.law = 'neo-hookean', or press the twin by --contact fem",
            at="material.law",
        )
    monitor(0.0, "placing the object")
    approach, submodel = set_up(mesh, material, case, sampled=sampled)
    course = _Course(approach, submodel, _pairing(material, case, approach, submodel), limit)
    try:
        with freed_memory_kept():
            frames = course.frames(mesh, case.fem.increment_mm, monitor)
    finally:
        course.pairing.tangent.close()
    stacked: dict[str, Any] = {
        field.name: np.stack([np.asarray(getattr(frame, field.name)) for frame in frames])
        for field in fields(FemFrame)
    }
    return ForceField(
        source=Source.FEM,
        **stacked,
        target_mm=approach.target_mm,
        normal=approach.normal,
        tangent_u=approach.tangent_u,
        radius_mm=submodel.part.radius_mm,
        spacing_mm=case.fem.hex_mm,
        solver=f"Gent's law, Jm = {limit:g}, {len(submodel.body.elements.cells)} hexahedra, "
        f"{course.pairing.tangent.solver_name}",
    )


def _pairing(
    material: Elastomer, case: PressCase, approach: Approach, submodel: Submodel
) -> Pairing:
    def pose_at(progress: float) -> RigidPose:
        origin_mm, rotation = approach.pose(progress)
        return RigidPose(origin_mm=origin_mm, rotation=rotation)

    still_mm = np.zeros_like(submodel.body.points_mm)
    return Pairing(
        tangent=Tangent(submodel.body),
        law=Law(
            penalty_MPa_mm=PENALTY * material.young_MPa,
            friction=material.friction,
            kinetic_friction=material.kinetic_friction,
        ),
        collider=approach.collider,
        pose_at=pose_at,
        held_mm=lambda progress: still_mm,
        tolerance=case.fem.tolerance,
    )


class _Course:
    """A press under way."""

    def __init__(
        self, approach: Approach, submodel: Submodel, pairing: Pairing, limit: float
    ) -> None:
        self.approach, self.submodel, self.pairing, self.limit = approach, submodel, pairing, limit
        self.elements = submodel.body.elements
        self.rest_MPa = self.elements.shear_MPa.copy()

    def frames(self, mesh: MembraneMesh, increment_mm: float, monitor: Monitor) -> list[FemFrame]:
        count, state, found = self.approach.frame_count, at_rest(self.pairing), list[FemFrame]()
        for frame in range(count):
            effort, before = Effort(), state
            label = f"frame {frame + 1} of {count}"

            def watch(progress: float, label: str = label) -> None:
                monitor(progress / count, label)

            effort.watch = lambda now=state.progress, watch=watch: watch(now)
            way_mm = self.approach.travel_mm(frame, self.approach.collider.reach_mm)
            pieces = pieces_of(way_mm, increment_mm)
            for piece in range(pieces):
                state = self._settled(state, frame + (piece + 1.0) / pieces, effort, watch)
            found.append(read_frame(mesh, self.submodel, self.pairing, state, before, effort))
        monitor(1.0, "converged")
        return found

    def _settled(
        self, before: State, goal: float, effort: Effort, watch: Callable[[float], None]
    ) -> State:
        """The state at a goal whose modulus is that of its own strain."""
        for _ in range(MOST_ROUNDS):
            state = advance(self.pairing, before, goal, effort, watch=watch)
            stiffer = self.rest_MPa * hardening(self.elements, state.displacement_mm, self.limit)
            off = np.abs(stiffer / self.elements.shear_MPa - 1.0).max(initial=0.0)
            if off <= AGREED:
                return state
            # The solver reads the moduli of its elements anew in each balance of forces.
            self.elements.shear_MPa[:] = stiffer
        raise SolveError(
            f"after {MOST_ROUNDS} rounds the gel hardens by {off:.1%} more than it was solved with",
            hint="press less deep",
            at="press.depth_mm",
        )
