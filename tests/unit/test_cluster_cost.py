"""A cluster on paper: the simulation beside closed forms, and plans beside sums done by hand."""

from __future__ import annotations

import math

import pytest

from docs.scale_plans import DESIGNS, LIT, OWN, PER_PRESS, Plan, designs
from workbench.cluster.cost import asked, most_per_s, saturations
from workbench.cluster.simulation import WORK, Spread, Step, simulate
from workbench.proof.benchmarks.records import RoomRecord, kept_at

WORK_S, SERVICE_S = 2.0, 0.1
STEPS = (Step(station="scheduler", seconds=SERVICE_S), Step(station=WORK, seconds=WORK_S))


@pytest.mark.parametrize("workers", [1, 7, 100])
@pytest.mark.parametrize("spread", Spread)
def test_without_stations_many_workers_are_so_many_times_as_fast(
    workers: int, spread: Spread
) -> None:
    """W workers end W / t jobs a second: exactly with fixed times, else by the mean of many."""
    found = simulate(
        [Step(station=WORK, seconds=WORK_S)], workers=workers, jobs=400 * workers, spread=spread
    )
    # 400 exponential times each: their mean is off by 5 % for one worker; the last ones idle.
    tolerance = 1e-9 if spread is Spread.NONE else 0.1
    assert found.per_s == pytest.approx(workers / WORK_S, rel=tolerance)
    assert found.busy[WORK] == pytest.approx(1.0, abs=tolerance)


def test_a_scheduler_that_saturates_ends_one_job_in_each_time_of_service() -> None:
    """Ten times as many workers as keep it busy: 1 / service, and workers wait nine tenths."""
    (knee,) = saturations(STEPS)
    assert knee.workers == pytest.approx((WORK_S + SERVICE_S) / SERVICE_S)
    found = simulate(STEPS, workers=int(10 * knee.workers), jobs=20_000)
    # The last job's work, 2 s of 2,000, is all that the scheduler is idle.
    assert found.per_s == pytest.approx(1.0 / SERVICE_S, rel=0.0011)
    assert found.busy["scheduler"] > 0.998 and found.busy[WORK] == pytest.approx(0.1, abs=0.01)


@pytest.mark.parametrize("workers", [1, 5, 20, 22, 60])
def test_fixed_times_reach_the_bound(workers: int) -> None:
    """min(W / (Z + D), 1 / D) on both sides of the knee at 21; a station more does not matter."""
    steps = (*STEPS, Step(station="disk", seconds=0.02))
    for each in (STEPS, steps):
        found = simulate(each, workers=workers, jobs=1000 * workers)
        assert found.per_s == pytest.approx(most_per_s(each, workers), rel=0.002)


@pytest.mark.parametrize("workers", [3, 20, 40])
def test_uneven_times_wait_as_the_machine_repairman_does(workers: int) -> None:
    """X = (1 - P0) / D of M/M/1//N; source: L. Kleinrock, Queueing Systems 1 (1975), 3.8."""
    load = SERVICE_S / WORK_S
    terms = [math.perm(workers, k) * load**k for k in range(workers + 1)]
    exact = (1.0 - 1.0 / sum(terms)) / SERVICE_S
    found = simulate(STEPS, workers=workers, jobs=40_000, spread=Spread.EXPONENTIAL)
    # Measured over three seeds: within 0.6 %.
    assert found.per_s == pytest.approx(exact, rel=0.02)
    assert found.per_s < most_per_s(STEPS, workers)


def record(**values: dict[str, float]) -> RoomRecord:
    """A record that nobody measured."""
    rows = [
        {"name": name, "case": case, "value": value}
        for name, cases in values.items()
        for case, value in cases.items()
    ]
    about = {"made": "", "version": "", "room": "stages", "device": "", "kind": "cpu", "load": 0.0}
    return RoomRecord(**about, rows=tuple(rows), kept=kept_at(None, "", ()))  # pyright: ignore


def test_a_plan_of_designs_is_the_mean_of_a_group_that_shares_a_press() -> None:
    """Of three designs one presses for 30 s, each is lit for 6 s: 16 core-seconds and 4/3 tasks;
    2 MB of a press and 4 MB of light are 14/3 MB; the press is read once by each light."""
    press, own, lit = f"press, {OWN}", f"bake, {OWN}", f"bake, {LIT}"
    known = record(
        stage_cpu={press: 30.0, own: 6.0, lit: 6.0},
        stage_written={press: 2.0, own: 4.0, lit: 4.0},
        stage_read={press: 0.0, own: 2.0, lit: 2.0},
        judging_cpu={OWN: 0.4, LIT: 0.1},
        proposal_cpu={"Sobol": 0.05},
        task_cpu={"nothing": 0.003},
    )
    plan: Plan = designs(known, "Sobol")
    assert PER_PRESS == 3 and plan.jobs == DESIGNS
    of_each = asked(plan.steps)
    assert of_each[WORK] == pytest.approx(16.0)
    assert plan.press_s == pytest.approx(10.0) and plan.presses == pytest.approx(1.0 / 3.0)
    assert plan.tasks == pytest.approx(4.0 / 3.0)
    assert plan.written_MB == pytest.approx(14.0 / 3.0)
    assert of_each["Dask's scheduler"] == pytest.approx(4.0 / 3.0 / 2000.0)
    assert of_each["the shared disk"] == pytest.approx((14.0 / 3.0 + 2.0) / 100.0)
    assert of_each["the one who asks"] == pytest.approx(0.05 + 0.6 / 3.0 + 0.004)
    assert saturations(plan.steps)[0].station == "the one who asks"
