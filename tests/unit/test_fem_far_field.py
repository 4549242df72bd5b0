"""The condensed far field: the same solution as without, from fewer equations."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from sim.fem import extent as extent_module
from sim.fem import newton as newton_module
from sim.fem import press as press_module
from sim.fem import submodel as submodel_module
from sim.fem import tangent as tangent_module
from sim.fem.balance import Balance, Equations, Load
from sim.fem.body import Body
from sim.fem.contact_law import PENALTY, Law
from sim.fem.dense_solver import DenseSolver
from sim.fem.far_field import condense
from sim.fem.linear_solver import SuperLU
from sim.fem.newton import broyden_step
from sim.fem.press import set_up, solve_press
from sim.fem.studies.blocks import flat_membrane
from sim.fem.submodel import Submodel
from sim.fem.tangent import Tangent
from workbench.core.design.design import Elastomer
from workbench.core.press.fem import FemSettings
from workbench.core.press.motion import slide
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import ForceField

SETTINGS = FemSettings(hex_mm=0.9, radius_mm=7.0, halvings=0)
PRESS = Press(
    target_mm=(0.0, 0.0, 2.0), depth_mm=0.3, frames=2, strokes=(slide(0.2, 0.0, frames=1),)
)
CLOSE_MM, ALL_MM = 1.5, 100.0


def cut(near_mm: float, monkeypatch: pytest.MonkeyPatch) -> tuple[Submodel, Load]:
    """The part of a pad around a press, and the object as deep as the press goes."""
    monkeypatch.setattr(extent_module, "NEAR_MARGIN_MM", near_mm)
    mesh = flat_membrane(width_mm=16.0)
    approach, submodel = set_up(mesh, Elastomer(), PressCase(press=PRESS, fem=SETTINGS))
    origin_mm, rotation = approach.pose(2.0)
    law = Law(penalty_MPa_mm=PENALTY * 0.145, friction=0.3)
    places_mm = submodel.body.faces.places(submodel.body.points_mm)
    load = Load(
        law=law,
        collider=approach.collider,
        pose=press_module.RigidPose(origin_mm=origin_mm, rotation=rotation),
        anchor_mm=places_mm,
        elastic_mm=np.zeros_like(places_mm),
        slides=np.zeros(len(places_mm), bool),
    )
    return submodel, load


def at_rest(body: Body, load: Load) -> Balance:
    """Forces of the undeformed skin, with the object inside it."""
    state = Equations(body=body, load=load).balance(np.zeros_like(body.points_mm))
    assert state is not None
    return state


def solved(near_mm: float, monkeypatch: pytest.MonkeyPatch) -> ForceField:
    monkeypatch.setattr(extent_module, "NEAR_MARGIN_MM", near_mm)
    return solve_press(
        flat_membrane(width_mm=16.0), Elastomer(), PressCase(press=PRESS, fem=SETTINGS)
    )


@pytest.mark.parametrize("symmetric", [False, True])
def test_a_condensed_step_at_rest_is_that_of_all_equations(
    symmetric: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At rest the far stiffness is exact, so both give the same way for any forces."""
    (small, _), (whole, _) = both = cut(CLOSE_MM, monkeypatch), cut(ALL_MM, monkeypatch)
    assert 0 < small.body.near < 0.5 * len(small.body.elements.cells)
    assert whole.body.near == len(whole.body.elements.cells)
    friction = 0.0 if symmetric else 0.3
    right_N = np.random.default_rng(0).normal(size=len(small.body.system.free))
    ways_mm = []
    for submodel, load in both:
        load = dataclasses.replace(load, law=dataclasses.replace(load.law, friction=friction))
        tangent = Tangent(submodel.body)
        tangent.factorise(at_rest(submodel.body, load), symmetric=symmetric)
        ways_mm.append(tangent.solve(right_N))
        tangent.close()
    # Factors are in float32.
    np.testing.assert_allclose(ways_mm[0], ways_mm[1], atol=1e-5 * np.abs(ways_mm[1]).max())


def test_near_and_far_equations_are_all_there_once(monkeypatch: pytest.MonkeyPatch) -> None:
    submodel, _ = cut(CLOSE_MM, monkeypatch)
    far = condense(submodel.body)
    both = np.sort(np.concatenate([far.near, far.far]))
    np.testing.assert_array_equal(both, np.arange(len(submodel.body.system.free)))
    assert len(far.system.free) == len(far.near) < len(both)
    values = np.linalg.eigvalsh(far.stiffness_N_mm)
    assert values.min() > -1e-9 * values.max(), "springs push back"
    far.close()


def test_the_springs_of_the_rim_are_those_of_dense_elimination(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """S from the dense stiffness of the far elements, all other nodes of theirs eliminated.

    To what factors in float32 leave: it only says where to step.
    """
    submodel, load = cut(CLOSE_MM, monkeypatch)
    far = condense(submodel.body)
    body = submodel.body
    distant = body.elements.take(slice(body.near, None))
    lone = dataclasses.replace(body, elements=distant, near=len(distant.cells))
    tangent = Tangent(lone)
    away = dataclasses.replace(
        load, pose=dataclasses.replace(load.pose, origin_mm=np.full(3, 99.0))
    )
    stiffness = tangent.matrix(at_rest(lone, away)).toarray()
    rows = np.searchsorted(lone.system.free, body.system.free[far.near[far.border]])
    others = np.setdiff1d(np.arange(len(stiffness)), rows)
    eliminated = stiffness[np.ix_(rows, rows)] - stiffness[np.ix_(rows, others)] @ (
        np.linalg.pinv(stiffness[np.ix_(others, others)]) @ stiffness[np.ix_(others, rows)]
    )
    np.testing.assert_allclose(far.stiffness_N_mm, eliminated, atol=1e-6 * np.abs(eliminated).max())
    far.close()


def test_a_press_is_the_same_with_a_condensed_far_field(monkeypatch: pytest.MonkeyPatch) -> None:
    """The residual is that of all elements, so only what the tolerance leaves may differ."""
    small, whole = solved(CLOSE_MM, monkeypatch), solved(ALL_MM, monkeypatch)
    assert small.converged.all() and whole.converged.all()
    size_N = np.abs(whole.contact_force_N).max()
    np.testing.assert_allclose(small.contact_force_N, whole.contact_force_N, atol=1e-5 * size_N)
    np.testing.assert_allclose(small.displacement_mm, whole.displacement_mm, atol=1e-6)
    assert whole.residual.max() <= 1e-6 and small.residual.max() <= 1e-6


def test_kept_factors_find_the_same_press_with_fewer(monkeypatch: pytest.MonkeyPatch) -> None:
    """A third of the factorisations fewer, at the same tolerance."""
    counted: list[bool] = []
    factorise = Tangent.factorise

    def count(self: Tangent, state: Balance, **options: Any) -> int | None:
        counted.append(not options.get("symmetric"))
        return factorise(self, state, **options)

    monkeypatch.setattr(Tangent, "factorise", count)
    found = solved(CLOSE_MM, monkeypatch)
    few = sum(counted)
    counted.clear()
    monkeypatch.setattr(newton_module, "CLOSE", 0.0)
    known = solved(CLOSE_MM, monkeypatch)
    assert few <= 0.67 * sum(counted)
    assert found.residual.max() <= 1e-6 and known.residual.max() <= 1e-6
    size_N = np.abs(known.contact_force_N).max()
    np.testing.assert_allclose(found.contact_force_N, known.contact_force_N, atol=1e-5 * size_N)


def test_broyden_steps_are_those_of_the_explicit_update() -> None:
    """B + (y - B s) s^T / |s|^2, built and solved, on six nonlinear equations."""
    random = np.random.default_rng(0)
    linear = np.eye(6) + 0.2 * random.normal(size=(6, 6))

    def residual(place: np.ndarray) -> np.ndarray:
        return linear @ place + 0.1 * np.sin(place) - 1.0

    place, first = np.zeros(6), np.eye(6)
    matrix, steps = first.copy(), [-residual(np.zeros(6))]
    for _ in range(5):
        step, before = steps[-1], residual(place)
        place = place + step
        matrix += np.outer(residual(place) - before - matrix @ step, step) / (step @ step)
        found = broyden_step(np.linalg.solve(first, -residual(place)), steps)
        assert found is not None
        np.testing.assert_allclose(found, np.linalg.solve(matrix, -residual(place)), rtol=1e-9)
        steps.append(found)
    assert broyden_step(0.95 * steps[0], steps[:1]) is None


def test_a_press_that_meets_nothing_condenses_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise AssertionError("condensed")

    monkeypatch.setattr(tangent_module, "condense", refuse)
    monkeypatch.setattr(extent_module, "NEAR_MARGIN_MM", CLOSE_MM)
    above = dataclasses.replace(PRESS, depth_mm=0.0, strokes=())
    found = solve_press(
        flat_membrane(width_mm=16.0), Elastomer(), PressCase(press=above, fem=SETTINGS)
    )
    assert not found.contact_force_N.any() and "nothing to solve" in found.solver


def test_a_press_is_the_same_by_dense_factors(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a GPU does, on the processor."""
    known = solved(CLOSE_MM, monkeypatch)

    def dense(*, symmetric: bool, **_: object) -> DenseSolver:
        return DenseSolver(symmetric=symmetric, spare=SuperLU, device="cpu")

    monkeypatch.setattr(tangent_module, "make_solver", dense)
    found = solved(CLOSE_MM, monkeypatch)
    assert "dense factors" in found.solver and "dense factors" not in known.solver
    assert found.converged.all() and found.residual.max() <= 1e-6
    size_N = np.abs(known.contact_force_N).max()
    np.testing.assert_allclose(found.contact_force_N, known.contact_force_N, atol=1e-5 * size_N)


def test_what_is_mostly_near_is_solved_as_a_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(submodel_module, "MOST_NEAR", 0.01)
    submodel, _ = cut(CLOSE_MM, monkeypatch)
    assert submodel.body.near == len(submodel.body.elements.cells)
