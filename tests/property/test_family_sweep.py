"""Random sensors of every family come out whole, and what does not is counted."""

from __future__ import annotations

import dataclasses
import os
import time

import pytest

from workbench.proof.validation.geometry.meshes import family_names
from workbench.proof.validation.geometry.sweep import judge, rows, sweep, sweep_row
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
    """Four sets of each family beside the two above: no failure, in the order of the draw."""
    # The same processes for all families: each takes seconds to import the kernel.
    found = sweep(family_names(), 4)
    assert [finding.trial for finding in found] == [
        trial for name in family_names() for trial in draw(name, 4)
    ]
    for number, name in enumerate(family_names()):
        row = sweep_row(name, lambda own=found[4 * number : 4 * number + 4]: own)
        assert (row.name, row.ok) == (f"sweep_{name}", True), row


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
    # Less than a process needs to load the kernel, which does not count.
    found = Workers(_crash, 2, hang_s=2.0).judge(trials)
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


def test_rows_of_a_sweep_in_workers() -> None:
    """A row for each family that is named: here two fingers in one process, without fault."""
    (row,) = rows(2, names=["finger"])
    assert (row.name, row.value, row.ok) == ("sweep_finger", 0, True)
    assert row.case.startswith("2 random sets")
