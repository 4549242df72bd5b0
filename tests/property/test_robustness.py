"""The robustness room counts what it should, and a process that presses all day does not grow."""

from __future__ import annotations

import dataclasses
import gc
from pathlib import Path

import numpy as np
import pytest

from sim.contact.readout.problem import Problem
from sim.contact.studies.specimens import flat_block
from workbench.core.base.errors import DesignError, SolveError
from workbench.core.press.indenter import IndenterKind
from workbench.core.press.press import ContactSettings, Press
from workbench.core.result.sensing import Contact
from workbench.proof.validation.contact import endurance, robustness, trials
from workbench.proof.validation.contact.robustness import Finding, State, judge, judged
from workbench.proof.validation.contact.trials import Motion, Sensor, Trial


def trial(number: int = 0, motion: Motion = Motion.PRESS) -> Trial:
    """A press of the pad with one of the objects."""
    return Trial(family="pad", kind=list(IndenterKind)[number], place=0, motion=motion)


@pytest.fixture(scope="module")
def block(taichi_device: str) -> Sensor:
    """A flat block of 2 mm, coarse, with all places in its middle."""
    mesh, points = flat_block(width_mm=16.0, height_mm=2.0, grid_mm=0.8, skin_mm=0.8)
    targets = np.tile([0.0, 0.0, 2.0], (trials.PLACES, 1))
    walls = np.full(trials.PLACES, 2.0)
    return Sensor(mesh=mesh, points=points, targets_mm=targets, walls_mm=walls)


@pytest.fixture(scope="module")
def settled(block: Sensor) -> Contact:
    """A ball pressed into it."""
    from sim.contact.solver.solver import solve

    (result,) = solve([robustness._problem(trial(), block)])
    assert isinstance(result, Contact)
    return result


def test_there_are_630_different_presses() -> None:
    """14 x 5 x 3 x 3; a sample has no press twice and is the same again for its seed."""
    everything = trials.every_trial()
    assert len(everything) == len(set(everything)) == 14 * 5 * 3 * 3
    some = trials.some_trials(40, 3)
    assert len(set(some)) == 40
    assert some == trials.some_trials(40, 3) != trials.some_trials(40, 4)


def test_results_are_named_by_what_they_are(settled: Contact) -> None:
    """Settled, unsettled with frames, and faults: NaN, an error without frames or remedy, a bug."""
    assert judge(trial(), settled).state is State.SETTLED
    spoilt = settled.displacement_mm.copy()
    spoilt[0, 0] = np.nan
    bad = dataclasses.replace(settled, displacement_mm=spoilt)
    assert (judge(trial(), bad).state, judge(trial(), bad).not_finite) == (State.FAULT, 3)
    good = SolveError("no", hint="less deep", partial=settled)
    assert judge(trial(), good).state is State.UNSETTLED
    for error in (
        SolveError("no", hint="less deep"),
        SolveError("no", partial=settled),
        SolveError("no", hint="less deep", partial=bad),
        IndexError("out of range"),
    ):
        assert judge(trial(), error).state is State.FAULT, error


def test_rows_count_refusals_apart() -> None:
    """3 settled, 1 not, 1 refused: share 0.75 of four, refused 0.2 of five, no faults."""
    states = [State.SETTLED] * 3 + [State.UNSETTLED, State.REFUSED]
    found = [Finding(trial=trial(n), state=state) for n, state in enumerate(states)]
    values = {row.name: (row.value, row.ok) for row in judged(lambda: found)}
    assert values["robustness_settled"] == (0.75, False)
    assert values["robustness_pad"] == (0.75, False)
    assert values["robustness_refused"] == (0.2, False)
    assert values["robustness_errors"] == values["robustness_nan"] == (0, True)


def test_press_that_breaks_the_batch_is_one_fault(
    block: Sensor, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of three presses one has a bug and one is refused; the third settles all the same."""
    from sim.contact.solver import solver

    solve = solver.solve

    def breaking(problems: list[Problem]) -> list[Contact | SolveError]:
        if any(p.press.twist_deg for p in problems):
            raise IndexError("a bug")
        return solve(problems)

    def path_of(trial: Trial, sensor: Sensor) -> Press:
        if trial.motion is Motion.SHEAR:
            raise DesignError("too deep", hint="less deep")
        return plain(trial, sensor)

    plain = trials.path_of
    monkeypatch.setattr(solver, "solve", breaking)
    monkeypatch.setattr(trials, "path_of", path_of)
    found = robustness.press_together([trial(0, motion) for motion in Motion], block)
    assert [f.state for f in found] == [State.SETTLED, State.REFUSED, State.FAULT]
    assert "a bug" in found[-1].why


@pytest.mark.slow
def test_saved_sensors_are_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Skins, lattice and places of the pad come back bit by bit; its places stand off the rim."""
    monkeypatch.setattr(trials, "FAMILIES", ("pad",))
    trials.save(tmp_path / "sensors.npz")
    loaded, built = trials.load(tmp_path / "sensors.npz")["pad"], trials.sensor("pad")
    assert loaded.points.grid_mm == ContactSettings().grid_mm
    for old, new in (
        (built.mesh.outer.points_mm, loaded.mesh.outer.points_mm),
        (built.mesh.inner.faces, loaded.mesh.inner.faces),
        (built.points.fractions, loaded.points.fractions),
        (built.targets_mm, loaded.targets_mm),
    ):
        np.testing.assert_array_equal(old, new)
    assert len(np.unique(built.targets_mm, axis=0)) == trials.PLACES
    # The elastomer of the default pad is 2 mm thick everywhere.
    assert built.walls_mm == pytest.approx(np.full(trials.PLACES, 2.0), abs=1e-3)


@pytest.mark.slow
def test_memory_is_flat_over_presses_of_changing_designs(taichi_device: str) -> None:
    """60 presses: the resident set after the last 40 is within 20 MB of that after the first 20."""
    from sim.contact.solver.solver import solve

    sizes_MB = []
    for number in range(60):
        (result,) = solve([endurance.varied_press(number)])
        assert isinstance(result, Contact)
        if number in (19, 59):
            gc.collect()
            sizes_MB.append(endurance.resident_MB())
    # One press has 2.2 MB of arrays: were they kept, 40 presses would be 88 MB.
    assert abs(sizes_MB[1] - sizes_MB[0]) < 20.0
