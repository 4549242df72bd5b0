"""Which side touches, in the browser: the question about a foot, its one-click answer, a face."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.made_indenters import on_a_foot, write_stl
from tests.ui.conftest import Server
from tests.ui.widgets import COARSE, button, coarse_project, open_page, tab, wait_until
from workbench.core.design.turning import turn_matrix
from workbench.project.project import Project
from workbench.project.state import read_state

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]


def turn_of(server: Server) -> tuple[float, float, float]:
    """The turn that the autosave has."""
    project = Project(server.project)
    text = (server.project / "designs" / "autosave.toml").read_text()
    return read_state(text, project, source="autosave").case.indenter.turn_deg


def test_a_foot_is_turned_over_by_one_click(
    pressed_project: Path, tmp_path: Path, start_server: Start, page: Any
) -> None:
    """A cross on a foot is asked about; the answer turns it, and the question goes."""
    server = start_server(pressed_project)
    open_page(page, server.url)
    tab(page, "Simulate").click()
    path = write_stl(on_a_foot("cross"), tmp_path / "cross.stl")
    with page.expect_file_chooser() as choosing:
        button(page, "Load object").click()
    choosing.value.set_files(str(path))
    answer = button(page, "Touch with the structured side")
    wait_until(answer.is_visible, 60, "the question is asked")
    answer.click()
    wait_until(lambda: turn_of(server) == (180.0, 0.0, 0.0), 30, "the object is turned")
    wait_until(lambda: not answer.is_visible(), 30, "the question has gone")


def test_a_clicked_face_is_turned_to_the_skin(
    tmp_path: Path, start_server: Start, page: Any
) -> None:
    """A click on a side of a large cube that looks at the eye: its normal is down afterwards."""
    project = coarse_project(tmp_path)
    autosave = project / "designs" / "autosave.toml"
    # With sharp edges: the click must not find the facet of a rounded one.
    cube = "[press_case.indenter]\nkind = 'cube'\nsize_mm = 24.0\nedge_radius_mm = 0.0\n"
    autosave.write_text(f"{COARSE}{cube}")
    server = start_server(project)
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Shape ✓").count(), 60, "the body is there")
    tab(page, "Simulate").click()
    page.wait_for_timeout(3000)
    button(page, "Touch with a face").click()
    page.get_by_text("Click the face of the object").wait_for()
    box = page.locator("canvas").first.bounding_box()
    shares = [(x, y) for y in np.linspace(0.1, 0.6, 11) for x in np.linspace(0.25, 0.6, 8)]
    for x, y in shares:
        page.mouse.click(box["x"] + x * box["width"], box["y"] + y * box["height"])
        page.wait_for_timeout(400)
        if not page.get_by_text("Click the face of the object").is_visible():
            break
    wait_until(lambda: any(turn_of(server)), 30, "the cube is turned")
    turn = turn_matrix(turn_of(server))
    # A side of a cube is down: the matrix has only quarter turns toward Z.
    assert np.abs(turn[2]).max() == pytest.approx(1.0, abs=1e-4)
