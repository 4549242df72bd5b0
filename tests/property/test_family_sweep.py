"""Random sensors of every family come out whole, and what does not is counted."""

from __future__ import annotations

import dataclasses
import os
import time

import pytest

from workbench.proof.validation.geometry import sweep as sweeps
from workbench.proof.validation.geometry.meshes import family_names
from workbench.proof.validation.geometry.sweep import judge, sweep, sweep_row
from workbench.proof.validation.geometry.trial_workers import Workers
from workbench.proof.validation.geometry.trials import Finding, Trial, draw


@pytest.mark.parametrize("name", family_names())
def test_a_few_random_sensors_of_each_family(name: str) -> None:
    """Two sets: watertight, one body, 0.3 % of the kernel's and 3 % of the fields' volume."""
    for trial in draw(name, 2, seed=1):
        finding = judge(trial)
        assert finding.fault == "", finding


@pytest.mark.slow
def test_random_sensors_of_all_families_in_workers() -> None:
    """Six sets of each family, no failure; those refused are told apart."""
    rows = sweeps.rows(6)
    assert [row.name for row in rows] == [f"sweep_{name}" for name in family_names()]
    assert all(row.ok for row in rows), rows


def test_the_same_seed_draws_the_same_sensors() -> None:
    """Two draws of three are equal; another seed differs."""
    first, again, other = (list(draw("paw", 3, seed=seed)) for seed in (7, 7, 8))
    assert first == again
    assert first != other


def _crash(trial: Trial) -> Finding:
    if trial.refused == 1:
        os._exit(9)
    if trial.refused == 2:
        time.sleep(60.0)
    return Finding(trial=trial)


def test_a_crash_and_a_hang_are_one_failure_each() -> None:
    """Of four sets one dies and one hangs: two faults, the others are judged."""
    (trial,) = draw("finger", 1)
    trials = [dataclasses.replace(trial, refused=number) for number in (0, 1, 2, 3)]
    # Long enough for a fresh process to start and answer on a busy machine.
    found = Workers(_crash, 2, hang_s=25.0).judge(trials)
    assert [bool(finding.fault) for finding in found] == [False, True, True, False]
    assert "ended with 9" in found[1].fault
    assert "no answer" in found[2].fault


def test_a_row_counts_failures() -> None:
    """One of two failed: value 1, limit 0, not ok, and the case says why."""
    (trial,) = draw("finger", 1)
    found = [Finding(trial=trial), Finding(trial=trial, fault="2 pieces")]
    row = sweep_row("finger", lambda: found)
    assert (row.value, row.limit, row.ok) == (1, 0, False)
    assert "2 random sets" in row.case
    assert "2 pieces" in row.case
    assert sweep_row("finger", lambda: found[:1]).ok


def test_sweep_runs_in_workers() -> None:
    """Two fingers judged in one process, in order, without fault."""
    found = sweep(["finger"], 2, workers=1)
    assert [finding.trial for finding in found] == list(draw("finger", 2))
    assert not any(finding.fault for finding in found)
