"""The published way to press, as a comparison: updated-Lagrangian MPM, the object made of points.

APIC material points with quadratic B-splines on a background grid that stays. In each substep
points scatter mass and momentum, the grid divides, points gather velocity v, affine velocity
C = 4 / dx^2 sum w V (X - x)^T and F <- (I + dt C) F; the stress enters the momentum as
-dt 4 / dx^2 V0 P F^T (X - x). Points of the rigid object have their velocity reset to the
prescribed one, points of the inner skin to zero. Source: SimTac, Supplementary, equations 10 to 19,
in the form that conserves momentum (the affine term carries the mass; S is Kirchhoff's stress).

A frame ends when the object has arrived, as published: nothing settles, there is no friction law
and no contact law; points of both bodies share nodes and stick. Density drops out: the wave speed
measures time (`particle_state.COURANT`) and `SUBSTEPS_PER_MM` the object's speed. The force is the
momentum that the object's points gain per time, averaged over the end of a frame. It leaks: each
reset of the object's velocity lets the skin slip back by one substep of its acceleration, so the
slower the object the less force is left.
Left out: gel behind the skin, driven regions, inclusions, the linear law.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import taichi as ti
from taichi.lang.impl import current_cfg

from sim.contact.motion.approach import Approach, plan_approach
from sim.contact.objects.collider import make_collider
from sim.contact.particles import kernels
from sim.contact.particles.cloud import Readout, make_cloud
from sim.contact.particles.state import TABLE, State
from sim.contact.readout.verdict import check_depth
from sim.contact.region.backing import support_points_mm
from sim.contact.region.radius import region_radius_mm
from workbench.core.base.errors import DesignError, SolveError
from workbench.core.base.frames import quaternion
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.design import Elastomer, Law
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MaterialPoints, MembraneMesh
from workbench.core.result.sensing import Contact

SUBSTEPS_PER_MM = 200.0
"""Substeps in which the object moves 1 mm: 3 % of the wave speed at a grid of 0.5 mm."""
LAST_SHARE = 0.1
"""Share of a frame, at its end, over which forces are averaged."""


def press_particles(
    mesh: MembraneMesh,
    points: MaterialPoints,
    material: Elastomer,
    case: PressCase,
    *,
    monitor: Monitor = silent,
) -> Contact:
    """Press an object made of points; arguments and errors are those of `press_membrane`.

    Raises:
        DesignError: As `press_membrane`, and for a skin with a gap behind it, driven regions,
            inclusions, kinetic friction or the linear law, which the published method does not
            have.
        SolveError: If a point becomes infinite or leaves the grid.
    """
    _refuse_what_was_not_published(mesh, material, case.indenter, case.press)
    monitor(0.0, "filling the object")
    indenter = make_collider(case.indenter, grid_mm=points.grid_mm)
    approach = plan_approach(mesh.outer, indenter, case.press)
    check_depth(support_points_mm(mesh), approach)
    radius_mm = region_radius_mm(mesh, material, approach, case.settings)
    cloud = make_cloud(mesh, points, approach, radius_mm=radius_mm)
    state = State(cloud, material)
    readout = Readout(mesh, cloud)
    found = []
    for frame in range(approach.frame_count):
        monitor(frame / approach.frame_count, f"frame {frame + 1} of {approach.frame_count}")
        try:
            found.append(_frame(state, approach, readout, frame))
        except SolveError as error:
            if found:
                error.partial = _collected(found, approach, state, points.grid_mm, radius_mm)
            raise
    return _collected(found, approach, state, points.grid_mm, radius_mm)


def _collected(
    found: list[dict[str, Any]],
    approach: Approach,
    state: State,
    grid_mm: float,
    radius_mm: float,
) -> Contact:
    """All frames so far as one result."""
    stacked: dict[str, Any] = {
        name: np.stack([np.asarray(one[name]) for one in found]) for name in found[0]
    }
    return Contact(
        **stacked,
        target_mm=approach.target_mm,
        normal=approach.normal,
        tangent_u=approach.tangent_u,
        grid_mm=grid_mm,
        active_radius_mm=radius_mm,
        particles=len(state.cloud.place_mm) + len(state.cloud.body_mm),
        substeps=state.substeps,
        device="cuda" if current_cfg().arch == ti.cuda else "cpu",
        sensor_pose=approach.sensor_poses()[: len(found)],
    )


def _refuse_what_was_not_published(
    mesh: MembraneMesh, material: Elastomer, indenter: Indenter, press: Press
) -> None:
    lacking = {
        "a soft object": indenter.soft is not None,
        "a gap behind the skin": mesh.backing_mm > 0.0,
        "driven regions": bool(press.actuations),
        "inclusions": bool(material.inclusions),
        "the linear law": material.law is Law.LINEAR,
        "kinetic friction": material.kinetic_friction is not None,
    }
    for what, asked in lacking.items():
        if asked:
            raise DesignError(
                f"the method of particles cannot take {what}",
                hint="set contact.method to lattice",
                at="contact.method",
            )


def _frame(state: State, approach: Approach, readout: Readout, frame: int) -> dict[str, Any]:
    """Move the object through a frame and read the fields of `Contact`."""
    travel_mm = approach.travel_mm(frame, approach.collider.reach_mm)
    count = max(1, math.ceil(SUBSTEPS_PER_MM * travel_mm / TABLE)) * TABLE
    averaged = max(1, round(LAST_SHARE * count))
    shares = np.arange(count + 1) / count
    for part in (slice(0, count - averaged), slice(count - averaged, count)):
        state.start_sums()
        for first in range(part.start, part.stop, TABLE):
            last = min(first + TABLE, part.stop)
            state.advance(*approach.poses(frame + shares[first : last + 1]))
    place_mm = state.places_mm()
    lowest = (state.cloud.low + 1.0) * state.cloud.grid_mm
    highest = (state.cloud.low + state.cloud.nodes - 2.0) * state.cloud.grid_mm
    if not ((place_mm > lowest) & (place_mm < highest)).all():
        raise SolveError(
            f"frame {frame + 1} of {approach.frame_count}: material points left the grid",
            hint="press less deep, or set contact.method to lattice",
            at="contact.method",
            frame=frame,
            last_good=frame - 1,
        )
    origin, rotation = approach.pose(frame + 1.0)
    gained = state.gained(averaged)
    reaction, support, border = gained[:, :3]
    arm_mm = origin - state.cloud.low * state.cloud.grid_mm
    displacement = readout.displacement_mm(place_mm)
    vertex_mm = readout.vertex_mm + displacement
    distance, _ = approach.collider.distance((vertex_mm - origin) @ rotation)
    size_N = max(float(np.linalg.norm(reaction)), 1e-12)
    return {
        "displacement_mm": displacement.astype(np.float32),
        "reaction_N": reaction,
        "moment_Nmm": gained[kernels.OBJECT, 3:] - np.cross(arm_mm, reaction),
        "indenter_pose": np.concatenate([origin, quaternion(rotation)]),
        "residual": float(np.linalg.norm(reaction + support + border)) / size_N,
        "penetration_mm": -float(distance.min(initial=0.0)),
        "support_N": -support,
        "cut_N": -border,
        "friction_ratio": 0.0,
        "sliding": np.zeros(len(vertex_mm), bool),
    }
