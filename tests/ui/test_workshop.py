"""Make: parts in a tree, checks that lead to their places, recipe and files."""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import (
    button,
    changed_share,
    control,
    open_page,
    tab,
    view,
    wait_until,
)

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]
MOVED = 0.05
"""Share of the view that another eye changes at least."""
CHECKED = re.compile(r"^[✓!✗] .*\((≤|≥) .*\)$")
"""A check says sign, name, part, value, unit and limit."""


def download(page: Any, name: str) -> bytes:
    """What a button sends."""
    with page.expect_download() as found:
        button(page, name).click()
    return Path(found.value.path()).read_bytes()


def test_parts_checks_recipe_and_files(
    unpressed_project: Path, page: Any, start_server: Start
) -> None:
    """Parts can be hidden, a check moves the eye to its place, files are whole."""
    import trimesh

    server = start_server(unpressed_project)
    open_page(page, server.url)
    tab(page, "Make").click()
    button(page, "Make parts").click()
    button(page, "Download part STL").wait_for(timeout=150_000)
    wait_until(lambda: not button(page, "Cancel").is_visible(), 60, "nothing runs")

    whole = view(page)
    control(page, "Mould core").click()
    wait_until(lambda: changed_share(whole, view(page)) > 0.01, 20, "the core is hidden")
    checks = page.get_by_role("button").filter(has_text=CHECKED)
    assert checks.count() >= 10
    before = view(page)
    checks.filter(has_text="minimum wall, mould half A").click()
    wait_until(lambda: changed_share(before, view(page)) > MOVED, 20, "the eye moved")
    page.get_by_text(re.compile(r"minimum wall .* At -?\d+\.\d, ")).first.wait_for()

    page.get_by_text("Recipe", exact=True).click()
    page.get_by_text("mix, waste included").wait_for()
    part = io.BytesIO(download(page, "Download part STL"))
    mesh: Any = trimesh.load(part, file_type="stl")
    assert mesh.is_watertight
    assert mesh.volume > 1000
    assert b"ISO-10303-21" in download(page, "Download part STEP")[:100]
    with zipfile.ZipFile(io.BytesIO(download(page, "Download all (zip)"))) as archive:
        names = set(archive.namelist())
    assert {"build_sheet.html", "moulds/half_a.stl", "parts/support.step"} <= names
