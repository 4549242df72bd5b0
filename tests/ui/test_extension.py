"""A page of one's own in the browser: the example of docs/extending.md."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.test_extending import FILES
from tests.ui.widgets import open_page, wait_until

pytestmark = [pytest.mark.ui, pytest.mark.slow]


def test_a_page_of_ones_own_is_a_tab(
    page: Any,
    start_server: Callable[..., Any],
    pressed_project: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Its tab stands behind the others and says the mass of the body that is stored."""
    name = "ui/panels/weight/page.py"
    (tmp_path / "mine" / name).parent.mkdir(parents=True)
    (tmp_path / "mine" / name).write_text(FILES[name])
    monkeypatch.setenv("WORKBENCH_EXTENSIONS", str(tmp_path / "mine"))
    open_page(page, start_server(pressed_project, cold=True).url)
    tabs = page.get_by_role("tab").all_inner_texts()
    assert tabs.index("Weight") == tabs.index("Read") + 1
    page.get_by_role("tab", name="Weight").click()
    wait_until(lambda: page.get_by_text("The membrane weighs").count(), 30, "the mass is there")
