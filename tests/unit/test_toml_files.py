"""TOML that Python's own parser has other errors for: a sentence, wherever a file is read."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from workbench.core.base.errors import DesignError
from workbench.learning.dataset.recipes import recipe_from_toml
from workbench.project.design_toml import design_from_toml
from workbench.project.project import Project
from workbench.variants.sweep_files import load_sweep
from workbench.variants.variants import load_variant

BAD = {
    "brackets": (f"name = {'[' * 4000}{']' * 4000}", "nested too deeply"),
    "digits": (f"schema = 1{'0' * 5000}", "thousands of digits"),
    "a long name": (f"[{'x' * 5000}]\n[{'x' * 5000}]", "Cannot declare"),
}


def _kept(folder: str, load: Callable[[Project, str], object]) -> Callable[[str, Path], object]:
    def read(text: str, root: Path) -> object:
        (root / folder).mkdir()
        (root / folder / "bad.toml").write_text(text)
        return load(Project(root), "bad")

    return read


READERS: dict[str, Callable[[str, Path], object]] = {
    "design": lambda text, root: design_from_toml(text),
    "recipe": lambda text, root: recipe_from_toml(text, source="it", project=Project(root)),
    "variant": _kept("variants", load_variant),
    "sweep": _kept("sweeps", load_sweep),
}


@pytest.mark.parametrize("case", BAD)
@pytest.mark.parametrize("reader", READERS)
def test_what_the_parser_chokes_on_is_refused(reader: str, case: str, tmp_path: Path) -> None:
    """4,000 brackets, 5,000 digits, a name of 5,000 letters: said in a line, with a remedy."""
    text, words = BAD[case]
    with pytest.raises(DesignError) as caught:
        READERS[reader](text, tmp_path)
    assert words in caught.value.message
    assert len(caught.value.message) < 250
    assert caught.value.hint
