"""The published method: its kernel against the plain twin, and what it must conserve."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest

from sim.contact.motion.approach import plan_approach
from sim.contact.objects.collider import make_collider
from sim.contact.particles import kernels
from sim.contact.particles import reference as twin
from sim.contact.particles.cloud import ROOM_CELLS, Cloud, make_cloud
from sim.contact.particles.press import press_particles
from sim.contact.particles.state import OBJECT_DENSITY, State
from sim.contact.studies.specimens import flat_block
from sim.material import elastic_solid
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.press.soft_body import SoftBody

pytestmark = pytest.mark.usefixtures("taichi_device")

PRESS = Press(target_mm=(0.0, 0.0, 2.0), depth_mm=0.3, frames=1)
BALL = Indenter(size_mm=3.0)
CASE = PressCase(indenter=BALL, press=PRESS)


def cloud_of(width_mm: float = 4.0):
    mesh, points = flat_block(width_mm=width_mm, height_mm=2.0, grid_mm=0.5)
    collider = make_collider(BALL, grid_mm=0.5)
    approach = plan_approach(mesh.outer, collider, PRESS)
    return make_cloud(mesh, points, approach, radius_mm=10.0), approach


def twin_points(state: State, cloud: Cloud, body: np.ndarray, given: np.ndarray) -> twin.Points:
    """Membrane and object in the units of the twin; the object's points come last."""
    count, objects = len(cloud.place_mm), len(body)
    solid = elastic_solid(Elastomer())
    everything = count + objects
    return twin.Points(
        place=np.concatenate([state.cells(cloud.place_mm), body]),
        speed=np.concatenate([np.zeros((count, 3)), given]),
        affine=np.zeros((everything, 3, 3)),
        gradient=np.tile(np.eye(3), (everything, 1, 1)),
        mass=np.concatenate([cloud.fraction, np.full(objects, OBJECT_DENSITY)]),
        moduli_MPa=np.tile([solid.shear_MPa, solid.bulk_MPa], (everything, 1)),
        kind=np.concatenate([cloud.kind, np.full(objects, kernels.OBJECT)]),
        given=np.concatenate([np.zeros((count, 3)), given]),
    )


def test_the_grid_leaves_three_empty_cells_around_the_points() -> None:
    """From each outermost point it is three to four cells to the grid's outermost nodes."""
    cloud, _ = cloud_of()
    low = cloud.place_mm.min(axis=0) / cloud.grid_mm - cloud.low
    high = cloud.low + np.array(cloud.nodes) - 1 - cloud.place_mm.max(axis=0) / cloud.grid_mm
    for room in (low, high):
        assert (room >= ROOM_CELLS).all() and (room < ROOM_CELLS + 1).all()


def test_substeps_equal_the_twin() -> None:
    """Ten substeps of an object that moves 0.2 cell: places to 1e-6 cell, forces to 1e-4."""
    cloud, approach = cloud_of()
    state = State(cloud, Elastomer())
    origins, turned = approach.poses(0.5 + np.linspace(0.0, 1.0 / 3.0, 11))
    state.start_sums()
    state.advance(origins, turned)
    bodies = [
        state.cells(cloud.body_mm @ rotation.T + origin)
        for origin, rotation in zip(origins, turned, strict=True)
    ]
    points = twin_points(state, cloud, bodies[0], bodies[1] - bodies[0])
    gained = np.zeros((len(points.kind), 3))
    for now, then in itertools.pairwise(bodies):
        given = then - now
        points.place[len(cloud.place_mm) :] = now
        points.speed[len(cloud.place_mm) :] = points.given[len(cloud.place_mm) :] = given
        points.gradient[len(cloud.place_mm) :] = np.eye(3)
        gained += twin.substep(points, cloud.nodes, state.stress_scale)
    places = (state.places_mm() / cloud.grid_mm) - cloud.low
    assert np.abs(points.place[: len(places)] - state.cells(cloud.place_mm)).max() > 1e-3
    # Positions up to 20 cells in single precision: 1e-6 each substep at most.
    assert np.abs(places - points.place[: len(places)]).max() < 1e-5
    exact_N = np.stack([gained[points.kind == k].sum(axis=0) for k in range(3)])
    exact_N *= state.unit_N / 10
    found_N = state.gained(10)[:, :3]
    assert np.abs(found_N - exact_N).max() < 1e-3 * np.abs(exact_N).max()


def test_momentum_is_conserved() -> None:
    """A free block with any velocities, strains and no object keeps its momentum to rounding."""
    cloud, _ = cloud_of()
    random = np.random.default_rng(3)
    count = len(cloud.place_mm)
    state = State(cloud, Elastomer())
    points = twin_points(state, cloud, np.zeros((0, 3)), np.zeros((0, 3)))
    points.kind = np.full(count, kernels.FREE)
    points.speed = random.normal(0.0, 0.01, (count, 3))
    points.gradient = np.eye(3) + random.normal(0.0, 0.05, (count, 3, 3))
    before = points.mass @ points.speed
    for _ in range(5):
        twin.substep(points, cloud.nodes, state.stress_scale)
    np.testing.assert_allclose(points.mass @ points.speed, before, atol=1e-12 * count)


def test_a_press_is_the_same_bit_by_bit() -> None:
    """Two presses: equal bytes of displacement and force; the object is pushed outward."""
    mesh, points = flat_block(width_mm=4.0, height_mm=2.0, grid_mm=0.5)
    first, second = (press_particles(mesh, points, Elastomer(), CASE) for _ in range(2))
    assert first.normal_N[-1] > 0.0
    assert first.displacement_mm.tobytes() == second.displacement_mm.tobytes()
    assert first.reaction_N.tobytes() == second.reaction_N.tobytes()


def test_what_was_not_published_is_refused() -> None:
    """A skin over gel has no support that points could be held at."""
    mesh, points = flat_block(width_mm=4.0, height_mm=2.0, grid_mm=0.5)
    over_gel = dataclasses.replace(mesh, backing_mm=1.0)
    with pytest.raises(DesignError, match="cannot take a gap behind") as raised:
        press_particles(over_gel, points, Elastomer(), CASE)
    assert raised.value.at == "contact.method"
    soft = dataclasses.replace(CASE, indenter=dataclasses.replace(BALL, soft=SoftBody()))
    with pytest.raises(DesignError, match="cannot take a soft object"):
        press_particles(mesh, points, Elastomer(), soft)
