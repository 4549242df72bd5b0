"""Presses whose limits are recorded: a finger's tip and a flat pad under balls, cones, a ring.

The finger is the `geltip` preset: a hemisphere of 15 mm on a cylinder of 27 mm, 2 mm of elastomer
bonded to a rigid core. The cone is the product's: full apex angle 90 degrees, apex rounded by
0.45 mm; the wide one has 120 degrees. The disc stands for a pad of 25.25 x 20.75 mm, roughly: a
body of revolution cannot say more of it.
"""

from __future__ import annotations

import itertools
import math
import time
from dataclasses import dataclass

import numpy as np

from tests.reference.axisymmetric.contact import Pair, make_skin
from tests.reference.axisymmetric.grids import (
    Chart,
    Places,
    disc_chart,
    finger_chart,
    growing,
    make_grid,
    refined,
)
from tests.reference.axisymmetric.profiles import Profile, ball, cone, torus
from tests.reference.axisymmetric.solid import make_solid
from tests.reference.axisymmetric.solving import Press

PENALTY_PER_MM = 7000.0
"""eps over Young's modulus [1/mm]: about 1000 MPa/mm at 0.145 MPa."""
STICK_SHARE = 0.1
"""k over eps."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Body:
    """A section and its elastomer."""

    chart: Chart
    thickness_mm: float
    length_mm: float
    """Of the skin, from the axis."""
    free_end: bool
    young_MPa: float
    poisson: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Case:
    """A press."""

    title: str
    body: Body
    profile: Profile
    friction: float
    fine_mm: float
    """Length of the skin with edges all alike."""
    edge_mm: float
    """Their length at level 0; every level halves it."""
    depths_mm: tuple[float, ...]
    """Where forces are recorded."""
    increments: tuple[float, ...]
    """Largest increments up to each of those depths [mm]."""
    levels: tuple[int, ...] = (0, 1, 2, 3)


@dataclass(frozen=True, kw_only=True, slots=True)
class Run:
    """How a case is solved."""

    level: int
    order: int = 2
    """Of the elements; grids of order 1 have their nodes where those of order 2 have theirs."""
    stiffer: float = 1.0
    """Factor on penalty and stick."""
    finer: int = 1
    """Parts that every increment is cut into."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Found:
    """Results at the depths of a case."""

    forces_N: tuple[float, ...]
    radii_mm: tuple[float, ...]
    unknowns: int
    steps: int
    seconds: float


def solve(name: str, run: Run) -> Found:
    """A recorded case."""
    return pressed(CASES[name], run)


def pressed(case: Case, run: Run) -> Found:
    """Press as deep as a case asks."""
    began = time.perf_counter()
    body, parts = case.body, 2**run.level * (2 if run.order == 1 else 1)
    grid = make_grid(
        body.chart, *(refined(p, parts) for p in places(case)), run.order, body.free_end
    )
    shear_MPa = body.young_MPa / (2.0 * (1.0 + body.poisson))
    bulk_MPa = body.young_MPa / (3.0 * (1.0 - 2.0 * body.poisson))
    penalty_MPa_mm = PENALTY_PER_MM * body.young_MPa * run.stiffer
    pair = Pair(
        profile=case.profile,
        friction=case.friction,
        penalty_MPa_mm=penalty_MPa_mm,
        stick_MPa_mm=STICK_SHARE * penalty_MPa_mm,
    )
    press = Press(grid, make_solid(grid, shear_MPa, bulk_MPa), make_skin(grid), pair)
    state, states = press.at_rest(), []
    for start_mm, end_mm, step_mm in zip(
        (0.0, *case.depths_mm), case.depths_mm, case.increments, strict=False
    ):
        count = math.ceil((end_mm - start_mm) / step_mm - 1e-9) * run.finer
        for depth_mm in np.linspace(start_mm, end_mm, count + 1)[1:]:
            state = press.advance(state, float(depth_mm))
        states.append(state)
    return Found(
        forces_N=tuple(state.force_N for state in states),
        radii_mm=tuple(state.radius_mm for state in states),
        unknowns=grid.unknowns,
        steps=state.steps,
        seconds=time.perf_counter() - began,
    )


def places(case: Case) -> tuple[Places, Places]:
    """Corners of level 0 along the skin and below it [mm]."""
    body = case.body
    along_mm = growing(case.fine_mm, case.edge_mm, body.length_mm, ALONG)
    return along_mm, growing(0.0, case.edge_mm, body.thickness_mm, DOWN)


ALONG, DOWN = (1.6, 8.0), (1.6, 1.0)
"""Growth of level 0 from cell to cell, and largest cell [mm]."""
TIP = Body(
    chart=finger_chart(15.0),
    thickness_mm=2.0,
    length_mm=7.5 * math.pi + 27.0,
    free_end=False,
    young_MPa=0.145,
    poisson=0.45,
)
DISC = Body(
    chart=disc_chart,
    thickness_mm=4.0,
    length_mm=11.5,
    free_end=True,
    young_MPa=0.1,
    poisson=0.49,
)
FRICTIONS = (0.0, 0.3)
DEPTHS_MM = (0.1, 0.2, 0.3, 0.5, 1.0)
INCREMENTS = {0.0: (0.05,) * 5, 0.3: (0.0125, *(0.025,) * 4)}


def _cases() -> dict[str, Case]:
    cases = {}
    for friction in FRICTIONS:
        ending = f"mu_{friction:g}"
        for name, what, profile, fine_mm, edge_mm in (
            ("ball", "ball of radius 3 mm", ball(3.0), 2.16, 0.24),
            ("cone", "cone of 90 degrees, apex 0.45 mm", cone(45.0, 0.45), 1.2, 0.2),
            ("wide_cone", "cone of 120 degrees, apex 0.45 mm", cone(60.0, 0.45), 1.6, 0.2),
            ("torus", "ring of 2.5 mm, tube 1 mm", torus(2.5, 1.0, 15.0), 4.5, 0.25),
        ):
            cases[f"tip_{name}_{ending}"] = Case(
                title=f"tip of the geltip preset, {what}",
                body=TIP,
                profile=profile,
                fine_mm=fine_mm,
                edge_mm=edge_mm,
                depths_mm=DEPTHS_MM,
                increments=INCREMENTS[friction],
                friction=friction,
                # A ring is wide; on level 2 its forces are known to .2 %.
                levels=(0, 1, 2) if name == "torus" else (0, 1, 2, 3),
            )
        for radius_mm, depth_mm, fine_mm, edge_mm in (
            (3.0, 0.8, 2.0, 0.25),
            (50.0, 0.2266, 4.5, 0.5),
        ):
            cases[f"disc_ball_{radius_mm:g}_{ending}"] = Case(
                title=f"disc of radius 11.5 mm, ball of radius {radius_mm:g} mm",
                body=DISC,
                profile=ball(radius_mm),
                fine_mm=fine_mm,
                edge_mm=edge_mm,
                depths_mm=(depth_mm,),
                increments=(depth_mm / 20.0,),
                friction=friction,
                levels=(0, 1, 2),
            )
    return cases


CASES = _cases()
LINEAR = "tip_ball_mu_0"
"""Case that is solved with linear elements too."""


def runs_of(case: Case) -> list[Run]:
    """Levels of a case, and the checks on level 1 of what else its force depends on."""
    runs = [Run(level=level) for level in case.levels]
    runs.append(Run(level=1, stiffer=2.0))
    if case.friction > 0.0:
        return [*runs, Run(level=1, finer=2)]
    return runs


def jobs() -> list[tuple[str, Run]]:
    """All that the record needs, the quick ones first."""
    found = [(name, run) for name, case in CASES.items() for run in runs_of(case)]
    linear = [(LINEAR, Run(level=level, order=1)) for level in CASES[LINEAR].levels]
    return sorted(itertools.chain(found, linear), key=lambda job: (job[1].level, job[1].finer))
