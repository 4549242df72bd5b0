"""`docs/architecture.md` names every room, files that exist, and a slider's way, on one page."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.test_layers import RANKS

ROOT = Path(__file__).parent.parent
TEXT = (ROOT / "docs" / "architecture.md").read_text()
MOST_FILES = 20
"""On the way from a slider to a pixel."""
MOST_WORDS = 30


def chapter(title: str) -> str:
    """A chapter without its heading."""
    (found,) = re.findall(rf"^## {title}\n(.*?)(?=^## |\Z)", TEXT, re.M | re.S)
    return found


def rooms() -> list[str]:
    """Packages of the table of rooms, in its order."""
    found = []
    for row in re.findall(r"^\| (`.*?) \|", chapter("Rooms, the lowest first"), re.M):
        owner = ""
        for name in re.findall(r"`([\w/]+)`", row):
            if name.endswith("/"):
                owner = name.rstrip("/").replace("/", ".")
                found.append(owner)
            else:
                found.append(f"{owner}.{name}")
    return found


def test_every_room_stands_in_the_table() -> None:
    """All packages but folders that only hold rooms, tabs, and rooms of the validation."""
    below = {name for name in RANKS if re.match(r"ui\.panels\.|workbench\.proof\.\w+\.", name)}
    holders = {"workbench", "sim", "sim.optics"}
    assert set(RANKS) - below - holders == set(rooms()) - holders


@pytest.mark.parametrize("file", sorted(set(re.findall(r"`([\w/]+\.py)`", TEXT))))
def test_files_that_it_names_exist(file: str) -> None:
    """And stand in their room."""
    assert (ROOT / file).is_file()


@pytest.mark.parametrize(
    ("file", "name"), re.findall(r"`([\w/]+\.py)` \(`(\w+)`\)", chapter("Where to look"))
)
def test_what_it_looks_for_is_there(file: str, name: str) -> None:
    """A name in brackets behind a file is one that the file uses or defines."""
    assert re.search(rf"\b{name}\b", (ROOT / file).read_text())


def test_the_way_of_a_slider_is_short() -> None:
    """At most 20 files lie on it."""
    way = chapter("From a slider to a pixel")
    assert len(set(re.findall(r"`([\w/]+\.py)`", way))) <= MOST_FILES


def test_the_glossary_is_one_of_thirty_words() -> None:
    """A word a line, none twice."""
    words = re.findall(r"^\| ([a-z, ]+) \|", chapter("Words"), re.M)[1:]
    assert len(words) == len(set(words)) <= MOST_WORDS
