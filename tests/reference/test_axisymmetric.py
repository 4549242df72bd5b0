"""The axisymmetric solver against closed forms, and the record of its limits against itself."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.reference.axisymmetric import grids
from tests.reference.axisymmetric.cases import CASES, DISC, Case, Found, Run, jobs, pressed, solve
from tests.reference.axisymmetric.contact import Kept, Pair, make_skin, touch
from tests.reference.axisymmetric.grids import Grid, disc_chart, make_grid
from tests.reference.axisymmetric.profiles import Profile, ball, cone, torus
from tests.reference.axisymmetric.record import extrapolated, limits, load, same_run
from tests.reference.axisymmetric.solid import make_solid, respond
from workbench.proof.validation.fem.fem_limits import RECORD

SHEAR_MPa, BULK_MPa = 0.05, 0.4833


def crooked(order: int) -> Grid:
    """A disc of 3 x 3 cells whose inner corners are moved, with straight edges."""
    places = np.linspace(0.0, 1.0, 3 * order + 1)

    def chart(along_mm: np.ndarray, down_mm: np.ndarray) -> np.ndarray:
        flat = disc_chart(along_mm, down_mm)
        corners = flat[::order, ::order].copy()
        shift = np.random.default_rng(3).uniform(-0.06, 0.06, corners[1:-1, 1:-1].shape)
        corners[1:-1, 1:-1] += shift
        for axis in (0, 1):
            corners = np.apply_along_axis(
                lambda x: np.interp(places, places[::order], x), axis, corners
            )
        return corners

    return make_grid(chart, np.linspace(0.0, 1.0, 4), np.linspace(0.0, 1.0, 4), order, True)


@pytest.mark.parametrize("order", [1, 2])
def test_even_strain_is_in_balance(order: int) -> None:
    """u = (0.1 r, -0.05 z) stores W times the volume, and pulls on no node inside."""
    grid = crooked(order)
    solid = make_solid(grid, SHEAR_MPa, BULK_MPa)
    motion = (grid.points_mm * [0.1, -0.05]).ravel()
    found = respond(solid, motion)
    stretches = np.array([1.1, 1.1, 0.95])
    ratio = stretches.prod()
    density = 0.5 * SHEAR_MPa * ((stretches**2).sum() * ratio ** (-2 / 3) - 3.0)
    density += 0.5 * BULK_MPa * (ratio - 1.0) ** 2
    assert found.energy_N_mm == pytest.approx(math.pi * density, rel=1e-12)
    force = np.bincount(solid.unknowns.ravel(), found.force_N.ravel()).reshape(-1, 2)
    r_mm, z_mm = grid.points_mm.T
    inside = (r_mm < 1.0) & (z_mm < 0.0) & (z_mm > -1.0)
    assert np.abs(force[inside]).max() < 1e-12 * np.abs(force).max()


@pytest.mark.parametrize("order", [1, 2])
def test_forces_and_tangent_are_derivatives_of_the_energy(order: int) -> None:
    """Central differences along a random motion, at strains of some tens of percent."""
    grid = crooked(order)
    solid = make_solid(grid, SHEAR_MPa, BULK_MPa)
    random = np.random.default_rng(5)
    motion, way = random.normal(0.0, 0.02, (2, grid.fixed.size))
    for vector in (motion, way):
        vector[grid.fixed] = 0.0
    ahead, behind = (respond(solid, motion + side * 1e-5 * way) for side in (1.0, -1.0))
    here = respond(solid, motion)
    assert here.tangent_N_mm is not None
    local = way[solid.unknowns]
    slope = (ahead.energy_N_mm - behind.energy_N_mm) / 2e-5
    # A step of 2e-7 mm leaves nine digits of the differences.
    assert slope == pytest.approx((here.force_N * local).sum(), rel=1e-6)
    change = (ahead.force_N - behind.force_N) / 2e-5
    predicted = np.einsum("eij,ej->ei", here.tangent_N_mm, local)
    assert np.abs(change - predicted).max() < 1e-7 * np.abs(predicted).max()


@pytest.mark.parametrize(
    "profile", [ball(3.0), cone(45.0, 0.45), cone(60.0, 0.1), torus(0.4, 1.0, 9.0)]
)
@pytest.mark.parametrize("stick_MPa_mm", [1.0, 1e4])
def test_tangent_of_touch_is_its_derivative(profile: Profile, stick_MPa_mm: float) -> None:
    """Sticking with 1 MPa/mm, sliding with 10^4, by central differences."""
    grid = crooked(2)
    skin = make_skin(grid)
    pair = Pair(profile=profile, friction=0.3, penalty_MPa_mm=100.0, stick_MPa_mm=stick_MPa_mm)
    random = np.random.default_rng(7)
    kept = Kept(
        motion_mm=random.normal(0.0, 0.01, skin.places_mm.shape),
        depth_mm=0.1,
        slip_mm=random.normal(0.0, 0.01, skin.area_mm2.shape),
    )
    motion, way = random.normal(0.0, 0.01, (2, grid.fixed.size))
    ahead, behind = (touch(skin, pair, kept, motion + s * 1e-7 * way, 0.2) for s in (1.0, -1.0))
    here = touch(skin, pair, kept, motion, 0.2)
    change = (behind.force_N - ahead.force_N) / 2e-7
    predicted = np.einsum("sij,sj->si", here.tangent_N_mm, way[skin.unknowns])
    # No point changes between sticking and sliding within 1e-9 mm; rounding leaves 1e-6.
    assert np.abs(change - predicted).max() < 1e-5 * np.abs(predicted).max()


def test_a_thick_block_under_a_ball_is_that_of_hertz() -> None:
    """F = 4 E R^(1/2) d^(3/2) / (3 (1 - nu^2)), a = (R d)^(1/2), by blocks of 100 a and 200 a.

    What a clamped block adds to the half-space's force goes with one over its size.
    """
    radius_mm, contact_mm = 10.0, 0.2
    depth_mm = contact_mm**2 / radius_mm
    found = [hertz_press(radius_mm, contact_mm, size_mm) for size_mm in (20.0, 40.0)]
    exact_N = 4.0 * 0.145 * radius_mm**0.5 * depth_mm**1.5 / (3.0 * (1.0 - 0.45**2))
    assert found[1].forces_N[0] == pytest.approx(exact_N, rel=0.01)
    # Four edges across the contact's radius err by 0.14 %, eight by 0.01 %.
    half_space_N = 2.0 * found[1].forces_N[0] - found[0].forces_N[0]
    assert half_space_N == pytest.approx(exact_N, rel=0.003)
    assert found[1].radii_mm[0] == pytest.approx(contact_mm, rel=0.02)


def hertz_press(radius_mm: float, contact_mm: float, size_mm: float) -> Found:
    """A ball on a clamped block, pressed until Hertz's contact radius is `contact_mm`."""
    depth_mm = contact_mm**2 / radius_mm
    body = replace(DISC, thickness_mm=size_mm, length_mm=size_mm, young_MPa=0.145, poisson=0.45)
    case = Case(
        title="a thick block",
        body=body,
        profile=ball(radius_mm),
        friction=0.0,
        fine_mm=1.5 * contact_mm,
        edge_mm=0.25 * contact_mm,
        depths_mm=(depth_mm,),
        increments=(0.5 * depth_mm,),
    )
    # The penalty gives way by 2e-7 mm, 5e-5 of the depth.
    return pressed(case, Run(level=0, stiffer=10.0))


def test_limits_of_known_orders() -> None:
    """1 + h^2 tends to 1; forces that swing keep their last."""
    assert extrapolated([1.16, 1.04, 1.01]) == pytest.approx((1.0, 0.03))
    assert extrapolated([1.0, 1.2, 1.1]) == pytest.approx((1.1, 0.1))


def test_the_record_is_complete_and_says_what_its_runs_say() -> None:
    """Every run is there, and the limits are those of the runs."""
    record = load()
    assert set(record["cases"]) == set(CASES)
    assert len(record["runs"]) == len(jobs())
    for name, run in jobs():
        assert any(same_run(row, name, run) for row in record["runs"])
    for name in CASES:
        assert record["cases"][name]["limits"] == limits(record["runs"], name)


@pytest.mark.parametrize("name", ["tip_ball_mu_0", "tip_cone_mu_0.3"])
def test_coarse_forces_are_near_the_limits(name: str) -> None:
    """Two or three edges across the smallest contacts: 2.5 %."""
    solved_again(name, level=0, off=0.025)


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_forces_of_level_1_are_near_the_limits(name: str) -> None:
    """Edges half as long: 0.7 %."""
    solved_again(name, level=1, off=0.007)


def solved_again(name: str, *, level: int, off: float) -> None:
    """A run finds the forces that were recorded of it, and they are near the limits."""
    record = load()
    (row,) = (row for row in record["runs"] if same_run(row, name, Run(level=level)))
    found = solve(name, Run(level=level))
    # With friction the halves of an increment that did not settle depend on rounding.
    np.testing.assert_allclose(found.forces_N, row["forces_N"], rtol=1e-3)
    exact_N = [limit["force_N"] for limit in record["cases"][name]["limits"]]
    np.testing.assert_allclose(found.forces_N, exact_N, rtol=off)


def test_it_shares_no_code_with_the_solver_it_judges() -> None:
    """Nothing of the program is imported but where the record is kept."""
    foreign = r"^\s*(from|import) (sim|workbench|geometry|designs|ui)\b"
    kept = "from workbench.proof.validation.fem.fem_limits import RECORD\n"
    for file in Path(grids.__file__).parent.glob("*.py"):
        assert not re.search(foreign, file.read_text().replace(kept, ""), re.MULTILINE)


def test_the_record_is_of_this_code() -> None:
    """Else make it anew: the runs are those of a solver that is no more."""
    assert RECORD.stale() == ""


def test_linear_elements_tend_to_the_same_limits() -> None:
    """Ball, no friction: on the finest grid within 0.5 %, and closer than on the coarsest."""
    record = load()
    exact = np.array([row["force_N"] for row in record["cases"]["tip_ball_mu_0"]["limits"]])
    rows = sorted((r for r in record["runs"] if r["order"] == 1), key=lambda row: row["level"])
    errors = np.abs([np.array(row["forces_N"]) / exact - 1.0 for row in rows])
    assert errors[-1].max() < 0.005
    assert errors[-1].mean() < errors[0].mean()
