"""Quasi-static press of a rigid indenter into a membrane, frame by frame.

Each frame moves the indenter along its path in a short ramp and then relaxes until the forces
balance. From the second frame on, the displacement is first extrapolated along the path. A frame
has settled when the out-of-balance force is below `tolerance` of the reaction, its sum below half
a percent, and the reaction has stopped changing; at nearly zero load 1 % of the peak reaction
stands in for the reaction.
Left out: self-contact, inertia, viscosity.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from sim.contact.approach import Approach, plan_approach
from sim.contact.backing import (
    SIDEWAYS,
    backed_faces,
    bonded_faces,
    foundation_N_mm3,
    support_points_mm,
)
from sim.contact.collider import Collider, make_collider
from sim.contact.domain import Domain, build_domain
from sim.contact.outcome import FrameOutcome, collect, frame_outcome
from sim.contact.quadrature import corner_points, facets_of, join, merge
from sim.contact.refinement import LONGEST_EDGE, path_distance_mm, reach_mm, refine
from sim.contact.region import region_radius_mm
from sim.contact.relaxation import BATCH, Balance, Relaxation
from sim.contact.verdict import check_depth, check_frame
from sim.material import neo_hookean
from workbench.core.design import Elastomer
from workbench.core.errors import SolveError
from workbench.core.indenter import Indenter
from workbench.core.monitor import Monitor, silent
from workbench.core.press import ContactSettings, Press
from workbench.core.results import MaterialPoints, MembraneMesh
from workbench.core.sensing import Contact

RAMP_SUBSTEPS_PER_MM = 100.0
"""Substeps for the indenter to move 1 mm without a prediction."""
SHORTEST_RAMP = 10
LOOK_EVERY = 5
"""Substeps between two looks at the residual while settling."""
FORCE_CHANGE = 2e-4
"""Largest relative change of the reaction between two looks of a settled frame."""
NET_FORCE = 5e-3
"""Largest sum of the forces on free nodes over the reaction: what the support would miss."""
LEAST_OF_PEAK = 0.01
"""Share of the peak reaction that stands in for a vanishing one."""
PATIENCE = 300
"""Substeps without a lower residual before the fictitious masses are doubled."""
MOST_RETRIES = 4
BOND_PENALTY = 100.0
"""Stiffness of the bond to the support per area, in units of E / grid."""


def press_membrane(
    mesh: MembraneMesh,
    points: MaterialPoints,
    material: Elastomer,
    indenter: Indenter,
    press: Press,
    settings: ContactSettings,
    *,
    monitor: Monitor = silent,
) -> Contact:
    """Press the indenter along its path; Taichi must have been initialised in this thread.

    Args:
        mesh: Skins: contact on `outer`, bond or gel on `inner`.
        points: Material points; their `grid_mm` is the grid of the solution.
        material: The elastomer, with its friction against the indenter.
        indenter: The rigid object.
        press: Its path.
        settings: Region, penalty, tolerance.
        monitor: Told the frame and residual; raises `Cancelled` to stop.

    Raises:
        DesignError: If the target is off the skin, the indenter cannot be made or would reach the
            support, or the region is too small.
        SolveError: If a frame does not settle or is not sound; carries frame, residual and last
            good frame.
    """
    monitor(0.0, "placing the indenter")
    collider = make_collider(indenter, grid_mm=points.grid_mm)
    approach = plan_approach(mesh.outer, collider, press)
    check_depth(support_points_mm(mesh), approach, collider)
    radius_mm = region_radius_mm(mesh, material, approach, collider, settings)
    domain = prepare(mesh, points, material, approach, collider, settings, radius_mm=radius_mm)
    relaxation = Relaxation(domain, collider, neo_hookean(material), friction=material.friction)
    run = _Run(relaxation=relaxation, approach=approach, settings=settings, monitor=monitor)
    outcomes: list[FrameOutcome] = []
    for frame in range(press.frame_count):
        balance = _solve_frame(run, frame)
        scale_N = run.scale_N(balance)
        outcome = frame_outcome(relaxation, mesh.outer, approach, balance, frame, scale_N=scale_N)
        check_frame(outcome, relaxation, approach, frame)
        outcomes.append(outcome)
        relaxation.commit(approach.pose(frame + 1.0))
    monitor(1.0, "settled")
    return collect(
        outcomes,
        approach=approach,
        domain=domain,
        radius_mm=radius_mm,
        substeps=relaxation.substeps,
    )


def prepare(
    mesh: MembraneMesh,
    points: MaterialPoints,
    material: Elastomer,
    approach: Approach,
    collider: Collider,
    settings: ContactSettings,
    *,
    radius_mm: float,
) -> Domain:
    """Surface points that may take part, and the active region around them."""
    grid_mm = points.grid_mm
    unit = material.young_MPa / grid_mm

    def near(skin_points_mm: np.ndarray) -> np.ndarray:
        distance = np.linalg.norm(skin_points_mm - approach.target_mm, axis=1)
        return distance < radius_mm + 2.0 * grid_mm

    outer_centre = mesh.outer.points_mm[mesh.outer.faces].mean(axis=1)
    inner_centre = mesh.inner.points_mm[mesh.inner.faces].mean(axis=1)
    spacing_mm = LONGEST_EDGE * grid_mm
    facets = facets_of(mesh.outer, np.flatnonzero(near(outer_centre)), spacing_mm=spacing_mm)
    facets = refine(facets, approach, collider, grid_mm=grid_mm)
    touching = corner_points(facets, stiffness_N_mm3=settings.penalty * unit, bonded=False)
    gap_mm = path_distance_mm(touching.position_mm, approach, collider)
    # Only points that the indenter comes near get contact springs and their mass.
    touching = touching.take(gap_mm < reach_mm(approach, grid_mm))
    held = touching
    springs = (
        (bonded_faces(mesh), BOND_PENALTY * unit, 1.0),
        (backed_faces(mesh), foundation_N_mm3(mesh, material), SIDEWAYS),
    )
    for faces, stiffness_N_mm3, sideways in springs:
        members = np.flatnonzero(faces & near(inner_centre))
        if stiffness_N_mm3 > 0.0 and len(members):
            facets = facets_of(mesh.inner, members, spacing_mm=spacing_mm)
            bond = corner_points(
                facets, stiffness_N_mm3=stiffness_N_mm3, bonded=True, sideways=sideways
            )
            held = join(held, merge(bond, grid_mm))
    return build_domain(
        mesh,
        points,
        held,
        neo_hookean(material),
        target_mm=approach.target_mm,
        active_radius_mm=radius_mm,
    )


@dataclass(kw_only=True, slots=True)
class _Run:
    """A press under way."""

    relaxation: Relaxation
    approach: Approach
    settings: ContactSettings
    monitor: Monitor
    settled: list[np.ndarray] = field(default_factory=list)
    """Nodal displacements of the last settled frames, newest last."""
    peak_N: float = 0.0
    retries: int = 0

    def scale_N(self, balance: Balance) -> float:
        """Force against which residual and change are measured."""
        reaction_N = float(np.linalg.norm(balance.reaction_N))
        self.peak_N = max(self.peak_N, reaction_N)
        return max(reaction_N, LEAST_OF_PEAK * self.peak_N, 1e-12)


def _solve_frame(run: _Run, frame: int) -> Balance:
    """Ramp to the pose of a frame and settle there."""
    relaxation, press = run.relaxation, run.approach.press
    if frame < press.frames and press.depth_mm == 0.0:
        return relaxation.evaluate(run.approach.pose(frame + 1.0))
    if not run.settled:
        run.settled = [relaxation.displacement()]
    rest = run.settled[-1]
    for attempt in range(MOST_RETRIES + 1):
        predicted = attempt == 0 and _predict(run, frame)
        _ramp(run, frame, short=predicted, gentler=2**attempt)
        balance = _settle(run, frame)
        if balance is not None:
            run.settled = [*run.settled[-2:], relaxation.displacement()]
            return balance
        relaxation.mass_scale *= 2.0
        relaxation.restart(rest)
    raise SolveError(
        f"frame {frame + 1} of {press.frame_count} became unstable {MOST_RETRIES + 1} times",
        hint="lower press.depth_mm or raise press.frames",
        frame=frame,
        last_good=frame - 1,
    )


def _predict(run: _Run, frame: int) -> bool:
    """Extrapolate the displacement of the last frames along the path; False if it turns."""
    frames = run.approach.press.frames
    known = min(len(run.settled), frame % frames + 1)
    if known < 2:
        return False
    *older, before, last = run.settled
    guess = 2.0 * last - before
    if known >= 3:
        guess = 3.0 * last - 3.0 * before + older[-1]
    run.relaxation.restart(guess)
    return True


def _ramp(run: _Run, frame: int, *, short: bool, gentler: int) -> None:
    """Move the indenter from its last pose to that of a frame."""
    press = run.approach.press
    travel_mm = press.depth_mm / press.frames
    if frame >= press.frames:
        reach_mm = run.relaxation.domain.grid_mm * 10.0
        turn_mm = abs(math.radians(press.twist_deg)) * reach_mm
        travel_mm = (math.hypot(*press.shear_mm) + turn_mm) / press.frames
    count = max(SHORTEST_RAMP, math.ceil(RAMP_SUBSTEPS_PER_MM * travel_mm)) * gentler
    if short:
        count = 1
    steps = frame + (np.arange(count) + 1.0) / count
    for first in range(0, count, BATCH):
        batch = [run.approach.pose(float(step)) for step in steps[first : first + BATCH]]
        run.relaxation.advance(batch)
        run.monitor(frame / press.frame_count, f"frame {frame + 1} of {press.frame_count}")


def _balanced(run: _Run, balance: Balance) -> bool:
    """Whether residual and net force are within their tolerances."""
    scale_N = run.scale_N(balance)
    net_N = float(np.linalg.norm(balance.net_N))
    return balance.unbalanced_N < run.settings.tolerance * scale_N and net_N < NET_FORCE * scale_N


def _settle(run: _Run, frame: int) -> Balance | None:
    """Relax at the pose of a frame until forces balance; None if they overflow."""
    relaxation, settings, press = run.relaxation, run.settings, run.approach.press
    pose = run.approach.pose(frame + 1.0)
    start = relaxation.substeps
    lowest, lowest_at, before_N = np.inf, 0, np.full(3, np.inf)
    while (spent := relaxation.substeps - start) < settings.max_substeps:
        relaxation.advance([pose] * LOOK_EVERY)
        balance = relaxation.balance()
        if not balance.finite:
            return None
        scale_N = run.scale_N(balance)
        residual = balance.unbalanced_N / scale_N
        change = float(np.linalg.norm(balance.reaction_N - before_N)) / scale_N
        before_N = balance.reaction_N
        if change < FORCE_CHANGE and _balanced(run, balance):
            # The balance is from before the last move: what counts is where the nodes are now.
            final = relaxation.evaluate(pose)
            if not (final.finite and np.isfinite(relaxation.displacement()).all()):
                return None
            if _balanced(run, final):
                return final
        if residual < lowest:
            lowest, lowest_at = residual, spent
        elif spent - lowest_at > PATIENCE and run.retries < MOST_RETRIES:
            # A residual that will not fall is an oscillation at the limit of stability.
            relaxation.mass_scale *= 2.0
            run.retries += 1
            lowest_at = spent
        share = min(1.0, spent / 200.0)
        note = f"frame {frame + 1} of {press.frame_count}, residual {residual:.0e}"
        run.monitor((frame + share) / press.frame_count, note)
    raise SolveError(
        f"frame {frame + 1} of {press.frame_count} has a residual of {residual:.1e} after "
        f"{settings.max_substeps} substeps; the limit is {settings.tolerance:.1e}",
        hint="raise contact.max_substeps or contact.tolerance, or press less deep",
        at="contact.max_substeps",
        frame=frame,
        residual=residual,
        last_good=frame - 1,
    )
