"""Compare in a real browser: variants, A against B, the report, and a sweep."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import (
    boxes,
    button,
    changed_share,
    choose,
    coarse_project,
    control,
    open_page,
    press,
    set_number,
    tab,
    type_text,
    view,
    wait_until,
)

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]
HOSTILE = "<script>window.hit=1</script><img src=x onerror='window.hit=1'>"
SEEN = 0.01
"""Share of the view that a second sensor changes at least."""


def save(page: Any, name: str) -> None:
    """Keep the design as it stands under a name."""
    type_text(page, "Variant name", name)
    press(page, "Save variant")


def pressed(page: Any) -> None:
    wait_until(lambda: page.get_by_text("Image ✓").count(), 180, "the design is pressed")


def second_wall(page: Any) -> None:
    """Another wall, pressed."""
    tab(page, "Shape").click()
    set_number(page, "Elastomer mm", 3)
    wait_until(lambda: page.get_by_text("Contact ○").count(), 20, "the press is stale")
    tab(page, "Simulate").click()
    press(page, "Run press")
    pressed(page)
    tab(page, "Compare").click()


def test_two_variants_are_compared_and_the_report_opens_by_itself(
    tmp_path: Path, pressed_project: Path, page: Any, start_server: Start
) -> None:
    """Wall 2 and 3 mm: what differs, blinking, B in the view, and a page that needs nothing else.

    A hostile note stays text in list and report, and a hostile name is refused.
    """
    project = pressed_project
    server = start_server(project)
    open_page(page, server.url)
    pressed(page)
    tab(page, "Compare").click()
    page.get_by_text("Tags and note", exact=True).click()
    page.locator("textarea:visible").first.fill(HOSTILE)
    save(page, "<script>alert(1)</script>")
    wait_until(lambda: page.get_by_text("cannot be what a variant").count(), 20, "it is refused")
    save(page, "thin")
    wait_until((project / "variants" / "thin.png").exists, 60, "the thumbnail is drawn")
    second_wall(page)
    save(page, "thick")
    row = page.locator("tr", has_text="elastomer")
    row.first.wait_for()
    assert row.first.inner_text().split() == ["elastomer", "mm", "2", "3"]
    assert page.get_by_text("B is better in").count() == 1

    choose(page, "Images", "blink")
    assert len(shown(page) - {None}) >= 2
    choose(page, "Images", "side by side")
    wait_until(lambda: len(shown(page)) == 1, 20, "it no longer blinks")

    before = view(page)
    control(page, "Show B in 3D").click()
    wait_until(lambda: changed_share(before, view(page)) > SEEN, 20, "B stands in the view")

    with page.expect_download() as download:
        press(page, "Export comparison (HTML)")
    report = tmp_path / "report.html"
    download.value.save_as(str(report))
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(report.as_uri())
    assert page.get_by_role("heading", name="thin against thick").count() == 1
    assert page.locator("img").count() >= 9
    assert [url for url in asked if not url.startswith(("data:", "file:"))] == []
    assert page.evaluate("window.hit") is None
    assert HOSTILE.split(">", maxsplit=1)[0] in page.locator("body").inner_text()


def shown(page: Any) -> set[str | None]:
    """Addresses of the large image within 2.4 s, which is four blinks."""
    found = set()
    for _ in range(12):
        found.add(blinking(page))
        page.wait_for_timeout(200)
    return found


def blinking(page: Any) -> str | None:
    """Address of the large image of the left panel, of which one is on show at a time."""
    sources = page.evaluate(
        "[...document.querySelectorAll('img')].filter(i => i.offsetParent && "
        "i.getBoundingClientRect().left < 400 && !i.src.startsWith('data:image/png'))"
        ".map(i => i.src)"
    )
    return sources[-1] if sources else None


def test_a_variant_is_renamed_deleted_and_brought_back_beside_a_broken_one(
    tmp_path: Path, page: Any, start_server: Start
) -> None:
    """A file of nonsense is listed as broken; deleting asks first, and can be undone."""
    project = coarse_project(tmp_path)
    (project / "variants").mkdir()
    (project / "variants" / "hand made.toml").write_text("nonsense = [")
    server = start_server(project)
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Shape ✓").count(), 60, "the shape is built")
    button(page, "Cancel").click()
    tab(page, "Compare").click()
    page.get_by_text("broken:").wait_for()
    save(page, "first")
    page.get_by_text("it was never pressed").wait_for()
    page.get_by_text("More on the chosen variant").click()
    type_text(page, "Variant name", "second")
    press(page, "Rename variant")
    wait_until(lambda: names(project) == ["hand made", "second"], 20, "it is renamed")
    press(page, "Delete variant")
    assert names(project) == ["hand made", "second"]
    press(page, "Yes, delete it")
    wait_until(lambda: names(project) == ["hand made"], 20, "it is deleted")
    press(page, "Undo delete")
    wait_until(lambda: names(project) == ["hand made", "second"], 20, "it is back")


def names(project: Path) -> list[str]:
    return sorted(path.stem for path in (project / "variants").glob("*.toml"))


def test_a_sweep_of_three_walls_is_plotted_and_kept(
    pressed_project: Path, page: Any, start_server: Start
) -> None:
    """1.5, 7 and 12.5 mm: two images with values, one failure told; a point becomes a variant."""
    project = pressed_project
    server = start_server(project)
    open_page(page, server.url)
    pressed(page)
    tab(page, "Compare").click()
    choose(page, "Parameter", "Layers: elastomer [mm]")
    for label, value in (("From", "1.5"), ("To", "12.5")):
        box = boxes(page, label).first
        box.fill(value)
        box.press("Tab")
    set_number(page, "Steps", 3)
    press(page, "Run sweep")
    wait_until(lambda: page.get_by_text("Finished: 3 points").count(), 150, "the sweep ends")
    shown = page.get_by_text(re.compile(r"1\.5 mm: [\d.]+ grey"))
    wait_until(lambda: shown.count() == 1, 30, "the first point's image is shown")
    refused = page.get_by_text(re.compile(r"12\.5 mm failed"))
    wait_until(lambda: refused.count() == 1, 20, "the failure is told")
    press(page, "Keep point as variant")
    wait_until(lambda: names(project) == ["elastomer_mm 1 at 1.5"], 20, "the point is kept")
    assert (project / "sweeps" / "elastomer_mm 1.toml").exists()


def test_a_sweep_is_cancelled_resumed_after_a_restart_and_deleted(
    tmp_path: Path, page: Any, start_server: Start
) -> None:
    """What was computed before the stop stays; the rest comes later; deleting can be undone."""
    project = coarse_project(tmp_path)
    server = start_server(project)
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Shape ✓").count(), 60, "the shape is built")
    button(page, "Cancel").click()
    sweep_depths(page)
    button(page, "Cancel sweep").wait_for()
    wait_until(lambda: page.get_by_text("2 of 3").count(), 120, "the first point is done")
    press(page, "Cancel sweep")
    page.get_by_text("goes on where it was").wait_for()
    server.stop()

    again = start_server(project)
    open_page(page, again.url)
    tab(page, "Compare").click()
    choose(page, "Sweep", SWEPT)
    press(page, "Resume sweep")
    wait_until(lambda: page.get_by_text("Finished: 3 points.").count(), 120, "it is finished")
    assert not button(page, "Resume sweep").count()
    kept = project / "sweeps" / f"{SWEPT}.toml"
    assert kept.read_text().count('status = "done"') == 3
    press(page, "Delete sweep")
    wait_until(lambda: not kept.exists(), 20, "it is deleted")
    press(page, "Undo delete of sweep")
    wait_until(kept.exists, 20, "it is back")
    wait_until(lambda: button(page, "Delete sweep").count(), 20, "it is on show again")


SWEPT = "depth_mm 1"


def sweep_depths(page: Any) -> None:
    """Begin a sweep of the press's depth in three steps."""
    tab(page, "Compare").click()
    choose(page, "Parameter", "Press: depth [mm]")
    for label, value in (("From", "0.4"), ("To", "1.2")):
        box = boxes(page, label).first
        box.fill(value)
        box.press("Tab")
    set_number(page, "Steps", 3)
    press(page, "Run sweep")
