"""Where the press aims, in the browser: a target typed on a straight wall stays."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import COARSE, coarse_project, open_page, tab, type_numbers, wait_until
from workbench.project.project import Project
from workbench.project.state import read_state

pytestmark = [pytest.mark.ui, pytest.mark.slow]


def test_a_target_typed_on_the_wall_stays(
    tmp_path: Path, start_server: Callable[..., Server], page: Any
) -> None:
    """Finger of radius 10: 0, 10, 18 became 0.3, 10, 27; in the air it still comes to the skin."""
    project = coarse_project(tmp_path)
    autosave = project / "designs" / "autosave.toml"
    head, rest = COARSE.split("[meshing]")
    autosave.write_text(f"{head}[shape]\nouter_radius_mm = 10.0\n[meshing]{rest}")
    server = start_server(project)

    def target_mm() -> tuple[float, float, float]:
        text = autosave.read_text()
        return read_state(text, Project(project), source="autosave").case.press.target_mm

    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Shape ✓").count(), 60, "the body is there")
    tab(page, "Simulate").click()
    type_numbers(page, "Target mm", (0, 10, 18))
    wait_until(lambda: target_mm()[2] == 18.0, 30, "what was typed is kept")
    page.wait_for_timeout(2000)
    assert target_mm() == (0.0, 10.0, 18.0)
    type_numbers(page, "Target mm", (0, 17, 18))
    wait_until(lambda: target_mm()[1] < 11.0, 30, "the target comes to the skin")
    assert target_mm() == pytest.approx((0.0, 10.0, 18.0), abs=0.05)
