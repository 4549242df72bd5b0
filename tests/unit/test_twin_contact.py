"""Paths by Gent's law: solved once, kept in the store under a key of their own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.unit.test_twin_cases import field
from workbench.core.base.monitor import silent
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import Press
from workbench.pipeline.store import Store
from workbench.project.named_designs import load_design
from workbench.twin import contact
from workbench.twin.cases import Kind, TwinCase
from workbench.twin.draw import draw_twin
from workbench.twin.twin_plan import Solver, TwinPlan

PLAN = TwinPlan(contact=Solver.GENT, hex_mm=1.5)


def path_to(depth_mm: float) -> TwinCase:
    press = Press(target_mm=(0.0, 0.0, 22.0), depth_mm=depth_mm, frames=2)
    return TwinCase(
        kind=Kind.PRESS,
        number=0,
        name="sphere",
        indenter=Indenter(),
        place="place00",
        press=press,
    )


def test_a_path_by_gent_s_law_is_solved_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The second time it comes from the store; another depth is another path."""
    twin, store, solved = draw_twin(load_design("pad"), 1), Store(tmp_path / "store"), []

    def solve(mesh: Any, material: Any, case: Any, monitor: Any, *, sampled: Any) -> Any:
        solved.append((material.young_MPa, case.press.depth_mm, case.fem.hex_mm, sampled))
        return field(2)

    monkeypatch.setattr(contact, "solve_hardening", solve)
    monkeypatch.setattr(contact, "twin_mesh", lambda *given: None)
    for depth_mm in (0.5, 0.5, 0.7):
        found = contact.pressed(twin, PLAN, path_to(depth_mm), store, silent)
        assert len(found.reaction_N) == 2
    young_MPa = twin.design.material.young_MPa
    assert solved == [(young_MPa, 0.5, 1.5, None), (young_MPa, 0.7, 1.5, None)]
    assert len(list((tmp_path / "store" / "gent").iterdir())) == 2
