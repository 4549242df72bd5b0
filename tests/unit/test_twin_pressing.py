"""Presses of a twin in processes of their own: reasons come back, and nobody is left behind."""

from __future__ import annotations

import dataclasses
import multiprocessing
from pathlib import Path

import pytest

from tests.unit.test_dataset_cases import flat_skin
from workbench.core.base.errors import Cancelled
from workbench.core.base.monitor import silent
from workbench.pipeline.store import Store
from workbench.project.named_designs import load_design
from workbench.twin.cases import Ground, Kind, TwinCase, case
from workbench.twin.draw import draw_twin
from workbench.twin.pressing import press_ahead
from workbench.twin.twin_plan import Solver, TwinPlan

PLAN = TwinPlan(contact=Solver.MPM, jobs=2)
TWIN = draw_twin(load_design("pad"), 1)


def beside_the_skin(number: int) -> TwinCase:
    """A path whose target is nowhere near."""
    ground = Ground(places_mm=flat_skin(8.0, 1.0).points_mm)
    found = case(TWIN, PLAN, ground, Kind.PRESS, number)
    press = dataclasses.replace(found.press, target_mm=(300.0, 0.0, 0.0))
    return dataclasses.replace(found, press=press)


@pytest.mark.slow
def test_why_a_path_fails_comes_back_from_its_process(tmp_path: Path) -> None:
    """By the path's name; the others of the pool go on."""
    cases = [beside_the_skin(number) for number in range(3)]
    failed = press_ahead(TWIN, PLAN, cases, Store(tmp_path), silent)
    assert set(failed) == {each.id for each in cases}
    assert all("mm" in why for why in failed.values())
    assert not multiprocessing.active_children()


@pytest.mark.slow
def test_cancelling_ends_the_processes(tmp_path: Path) -> None:
    """At the next look, whatever they compute."""

    def stop(fraction: float, note: str = "") -> None:
        raise Cancelled("stopped")

    with pytest.raises(Cancelled):
        press_ahead(TWIN, PLAN, [beside_the_skin(0)], Store(tmp_path), stop)
    assert not multiprocessing.active_children()
