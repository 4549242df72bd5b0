"""Reports of comparisons and sweeps: self-contained, escaped, honest about what is not stored."""

from __future__ import annotations

import dataclasses
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from tests.unit.test_sweeps import compute, finger, shot, walls
from workbench.core.base.errors import DesignError, SolveError
from workbench.core.result.sensing import Shot
from workbench.planning.plan import plan
from workbench.project.project import Project
from workbench.project.state import State
from workbench.variants.comparison_images import Moment, pair, side_by_side
from workbench.variants.comparison_report import Reported, comparison_page, point_state, sweep_page
from workbench.variants.comparison_side import Side
from workbench.variants.sweep_plot import sweep_svg
from workbench.variants.sweeps import done, failed

HOSTILE = "<script>alert(1)</script><img src=http://evil.example/x onerror=alert(2)>"
VOID = {"meta", "img", "circle", "path", "br"}


@pytest.fixture
def project(tmp_path: Path) -> Project:
    return Project(tmp_path / "project")


class Checker(HTMLParser):
    """Collects what could load or run something, and tags left open."""

    def __init__(self) -> None:
        super().__init__()
        self.reaching: list[str] = []
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag in ("script", "link", "iframe", "object", "base"):
            self.reaching.append(tag)
        for name, value in attrs:
            if name.startswith("on") or (name in ("src", "href") and value is not None):
                if name.startswith("on") or not (value or "").startswith("data:image/"):
                    self.reaching.append(f"{tag} {name}={value}")
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if self.open and self.open[-1] == tag:
            self.open.pop()


def check(page: str) -> str:
    """The page loads and runs nothing; its tags close."""
    checker = Checker()
    checker.feed(page)
    assert checker.reaching == []
    assert checker.open in ([], ["html"])
    return page


def hostile(state: State) -> State:
    material = dataclasses.replace(state.design.material, source=HOSTILE)
    design = dataclasses.replace(state.design, name=HOSTILE, material=material)
    return State(design=design, case=state.case)


def side(name: str, state: State, project: Project, image: Shot | None, grey: float) -> Side:
    keys = {}
    if image is not None:
        call = plan(state.design, state.case)["shoot"]
        project.store.save("shoot", call.key, image, seconds=1.0, version=1)
        keys = {"shoot": call.key}
    return Side(
        name=name,
        state=state,
        keys=keys,
        figures={"contact_change_mean_grey": grey},
        note=HOSTILE,
    )


def made_shot(width: int, height: int, level: int) -> Shot:
    """A press whose last image is brighter than that at rest by `level`."""
    rgb = np.full((2, height, width, 3), 100, np.uint8)
    rgb[1] += np.uint8(level)
    plain = shot(1.0)
    return dataclasses.replace(plain, frames=dataclasses.replace(plain.frames, rgb=rgb))


def test_a_comparison_is_self_contained_and_escaped(project: Project) -> None:
    """Names, notes and sources with tags in them are text; keys and figures are there."""
    sweep = failed(walls(project), 0, SolveError(HOSTILE))
    compute(project, sweep, 1)
    sweep = done(sweep, 1, project.store, 1.0)
    a = side(HOSTILE, hostile(finger()), project, made_shot(40, 30, 5), 3.0)
    other = finger().design.replace("layers.elastomer_mm", 2.5)
    b = side("b", State(design=other, case=finger().case), project, made_shot(40, 30, 9), 4.0)
    more = Reported(others=((HOSTILE, {}),), sweep=sweep, metric="contact_change_mean_grey")
    page = check(comparison_page(project.store, a, b, more))
    assert HOSTILE not in page and "&lt;script&gt;" in page
    assert "33.3 % better" in page and "elastomer" in page
    assert a.keys["shoot"] in page and b.keys["shoot"] in page
    assert page.count("data:image/jpeg") == 3 * 2 + 1 + 1


def test_a_comparison_without_results_says_so(project: Project) -> None:
    """Nothing is stored: no image, no thumbnail, no error."""
    a, b = (side(name, finger(), project, None, 1.0) for name in "ab")
    page = check(comparison_page(project.store, a, b))
    assert "No image of a and b is stored" in page
    assert "No parameter differs" in page


def test_a_sweep_report_has_plot_images_and_failures(project: Project) -> None:
    """Two points of three are done, one failed: two images, two dots, one cross."""
    sweep = walls(project)
    for number in (0, 2):
        compute(project, sweep, number)
        sweep = done(sweep, number, project.store, 1.0)
    sweep = failed(sweep, 1, SolveError("did not settle"))
    page = check(sweep_page(project.store, sweep))
    assert page.count("data:image/jpeg") == 2
    assert page.count("<circle") == 2
    assert page.count("failed: did not settle") == 2
    assert point_state(sweep, "3").design.layers.elastomer_mm == 3.0
    with pytest.raises(DesignError):
        point_state(sweep, "7")


def test_the_plot_has_round_ticks_that_hold_all_values(project: Project) -> None:
    """Walls from 1 to 3 mm: ticks each 0.5 mm; a single point makes no division by zero."""
    sweep = walls(project)
    assert "No point" in sweep_svg(sweep, "contact_change_mean_grey")
    compute(project, sweep, 1)
    one = done(sweep, 1, project.store, 1.0)
    svg = sweep_svg(one, "contact_change_mean_grey")
    ticks = re.findall(r"text-anchor='middle'>([^<]+)<", svg)
    assert ticks == ["1", "1.5", "2", "2.5", "3"]
    assert "nan" not in svg


def test_images_of_other_sizes_are_brought_together_or_refused() -> None:
    """40 x 30 beside 80 x 60 is resampled; beside 40 x 40 there is no difference to show."""
    same = pair(made_shot(40, 30, 5), made_shot(40, 30, 9), Moment.LAST)
    assert same.difference is not None
    # 9 - 5 = 4 grey levels, eight times as strong at most.
    assert np.unique(same.difference).tolist() == [128 + 8 * 4]
    scaled = pair(made_shot(40, 30, 5), made_shot(80, 60, 9), Moment.LAST)
    assert scaled.a.shape == scaled.b.shape == (30, 40, 3)
    assert scaled.difference is not None and "resampled" in scaled.words
    other = pair(made_shot(40, 30, 5), made_shot(40, 40, 9), Moment.LAST)
    assert other.difference is None and "proportions differ" in other.words
    assert side_by_side(other).shape == (40, 88, 3)


def test_changes_are_strengthened_alike() -> None:
    """A change of 5 levels and one of 100: both by 1, for they are compared by eye."""
    both = pair(made_shot(4, 4, 5), made_shot(4, 4, 100), Moment.CHANGE)
    assert np.unique(both.a).tolist() == [133]
    assert np.unique(both.b).tolist() == [228]
    assert "both × 1" in both.words
