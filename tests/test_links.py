"""Links lead somewhere: to files, headings and pages; and every package says what it is."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from tests.pages import DOCS, ROOT

TEXTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(DOCS.glob("*.md"))]
PACKAGES = ("workbench", "designs", "geometry", "sim", "ui")


def anchors(text: str) -> set[str]:
    """What the headings of a text are called in links, as GitHub does it."""
    titles = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    plain = (re.sub(r"[^\w\- ]", "", title.lower()) for title in titles)
    return {title.strip().replace(" ", "-") for title in plain}


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: path.name)
def test_every_relative_link_leads_somewhere(path: Path) -> None:
    """To a file of the repository, pictures too, and to a heading that is there."""
    for target in re.findall(r"\]\(([^): ]+)\)", path.read_text()):
        file, _, heading = target.partition("#")
        found = path.parent / file if file else path
        assert found.exists(), target
        if heading:
            assert heading in anchors(found.read_text()), target


@pytest.mark.parametrize("package", PACKAGES)
def test_pages_that_the_program_names_exist(package: str) -> None:
    """In messages, help texts and docstrings; none sends a reader to the README at large."""
    for path in (ROOT / package).rglob("*.py"):
        text = path.read_text()
        assert "see the README" not in text, path
        for name in re.findall(r"docs/([\w-]+\.md)", text):
            assert (DOCS / name).is_file(), (path, name)


@pytest.mark.parametrize("package", PACKAGES)
def test_every_package_has_its_design_note(package: str) -> None:
    """One short DESIGN.md per package."""
    assert len((ROOT / package / "DESIGN.md").read_text().splitlines()) < 60


def test_the_design_note_of_the_front_names_its_rooms() -> None:
    """`ui/DESIGN.md` names each room, and each file beside them."""
    note = (ROOT / "ui" / "DESIGN.md").read_text()
    files = {path.name for path in (ROOT / "ui").glob("*.py")} - {"__init__.py"}
    rooms = {path.parent.name + "/" for path in (ROOT / "ui").glob("*/__init__.py")}
    assert {name for name in files | rooms if f"`{name}`" not in note} == set()


@pytest.mark.parametrize("package", PACKAGES)
def test_every_file_says_its_idea(package: str) -> None:
    """In the first line of its docstring, as a sentence."""
    for path in (ROOT / package).rglob("*.py"):
        told = ast.get_docstring(ast.parse(path.read_text())) or ""
        assert told.partition("\n")[0][-1:] in ".:?", path
