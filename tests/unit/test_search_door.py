"""A search from Python: `wb.search_designs` on closed forms."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import workbench as wb
from tests.toy_search import TEXT, Toy, X, Y, beyond
from workbench.core.base.errors import DesignError
from workbench.search import running

pytest.importorskip("optuna")


def test_a_search_from_python_finds_the_known_front_and_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ten trials in two calls; of the front all lie on or beyond sqrt(f) + sqrt(g) = 1, and
    the file beside the journal holds the same."""
    toy = Toy()

    def made(*_: Any, **__: Any) -> Toy:
        return toy

    monkeypatch.setattr(running, "DesignEvaluator", made)
    file, out, project = tmp_path / "toy.toml", tmp_path / "out", tmp_path / "project"
    file.write_text(f"finalists = 0\ntrials = 10\n{TEXT}")
    first = wb.search_designs(file, out, trials=4, project=project)
    found = wb.search_designs(file, str(out), project=project)
    assert (len(first.trials), len(found.trials), len(toy.asked)) == (4, 10, 10)
    off = [beyond(trial.judged) for trial in found.front]
    assert off and min(off) > -1e-9
    kept = json.loads((out / "front.json").read_text())
    values = [(trial.judged.parameters[X], trial.judged.parameters[Y]) for trial in found.front]
    assert [(one["parameters"][X], one["parameters"][Y]) for one in kept] == values
    assert (out / "report.html").stat().st_size > 1000


def test_a_file_that_cannot_be_searched_is_refused(tmp_path: Path) -> None:
    """With the field, before a folder is made."""
    file = tmp_path / "toy.toml"
    file.write_text(TEXT.replace("specular", "speculr"))
    with pytest.raises(DesignError, match="speculr"):
        wb.search_designs(file, tmp_path / "out", project=tmp_path / "project")
    assert not (tmp_path / "out").exists()
