"""Designs beside each other by what tasks found of them, as a project keeps it."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import pytest

from workbench.core.press.press_case import PressCase
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.project.state import State
from workbench.variants.kept_tasks import earlier, keep, kept
from workbench.variants.told_apart import confusions, lines, only_of, recalls, told_html
from workbench.variants.variants import save_variant, variant_path

NAMES = ["cube", "<b>sphere"]


def result(confusion: list[list[int]], value: float = 0.5, spread: float = 0.1) -> dict[str, Any]:
    """Of a task of two objects: by place as given, at random better."""
    row = {"task": "objects", "metric": "accuracy", "spread": spread, "null": 0.5, "paper": None}
    recall = {
        name: line[k] / sum(line)
        for k, (name, line) in enumerate(zip(NAMES, confusion, strict=True))
    }
    own = {"confusion": confusion, "recall": recall, "outputs": NAMES}
    return {
        "task": "objects",
        "design": "geltip",
        "size": "small",
        "network": "lite",
        "rows": [
            {**row, "test": "sim", "value": 0.9},
            {**row, "test": "sim_by_place", "value": value},
        ],
        "details": {"tests": {"sim_by_place": own}},
    }


SURE, LOST = result([[9, 1], [0, 10]], 0.95), result([[9, 1], [6, 4]], 0.65)


def test_a_result_is_found_by_the_design_and_not_by_its_name(tmp_path: Path) -> None:
    """Renamed it is the same sensor; another wall is another, of which an earlier one was judged.

    A damaged file counts as none.
    """
    project, design = Project(tmp_path), load_design("geltip")
    path = keep(project, design, SURE)
    assert kept(project, design) == {"objects-small-lite": SURE}
    assert kept(project, dataclasses.replace(design, name="mine")) == kept(project, design)
    assert earlier(project, design) == ()
    thicker = design.replace("layers.elastomer_mm", 3.0)
    assert not kept(project, thicker) and earlier(project, thicker) == ("objects",)
    path.write_text("{")
    assert not kept(project, design)


def test_a_variant_is_judged_by_its_file(tmp_path: Path) -> None:
    """What the command reads from the file of a variant is what the comparison asks for."""
    project = Project(tmp_path)
    design = load_design("geltip").replace("layers.elastomer_mm", 3.0)
    save_variant(project, "thick", State(design=design, case=PressCase()))
    read = load_design(str(variant_path(project, "thick")), project=project)
    keep(project, read, SURE)
    assert kept(project, design)


@pytest.mark.parametrize(("spread", "better"), [(0.1, "A"), (0.4, "")])
def test_better_is_what_differs_by_more_than_the_spread(spread: float, better: str) -> None:
    """.95 against .65: over a spread of .1, not over one of .4."""
    sure = result([[9, 1], [0, 10]], 0.95, spread)
    (line,) = lines({"objects-small-lite": sure}, {"objects-small-lite": LOST})
    assert (line.metric, line.better) == ("accuracy", better)
    assert line.a is not None and (line.a.value, line.a.null) == (0.95, 0.5)


def test_of_an_error_less_is_better() -> None:
    """The same numbers as a mean absolute error."""
    sure, lost = (
        {**each, "rows": [{**row, "metric": "mae_depth_mm"} for row in each["rows"]]}
        for each in (SURE, LOST)
    )
    (line,) = lines({"pose-small-lite": sure}, {"pose-small-lite": lost})
    assert line.better == "B"


def test_sizes_and_networks_are_not_compared_with_each_other() -> None:
    """Two lines, each with one side."""
    found = lines({"objects-small-lite": SURE}, {"objects-paper-paper": LOST})
    assert [(line.a is None, line.b is None) for line in found] == [(True, False), (False, True)]
    assert {line.better for line in found} == {""}


def test_what_one_confuses_and_the_other_does_not() -> None:
    """6 of 10 spheres are taken for cubes by one; one cube of ten is no confusion."""
    assert confusions(LOST) == {("<b>sphere", "cube"): 0.6}
    assert only_of(LOST, SURE) == [("<b>sphere", "cube", 0.6)]
    assert only_of(SURE, LOST) == []
    assert recalls(LOST) == {"cube": 0.9, "<b>sphere": 0.4}


def test_the_table_says_all_of_it_and_escapes_names() -> None:
    """Scores with null, recall of each class, and the confusion in words."""
    page = told_html({"objects-small-lite": SURE}, {"objects-small-lite": LOST}, ("thin", "thick"))
    for text in ("0.95 ± 0.1", "null 0.5", "100 %", "40 %", "Only B takes", "cube (60 %)"):
        assert text in page
    assert "<b>sphere" not in page and "Only A" not in page
    assert told_html({}, {}, ("thin", "thick")) == ""
