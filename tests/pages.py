"""The pages of the manual as tests read them: their text, their code, their commands."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
BY_HAND = (
    *(
        "browser",
        "calibration",
        "cluster",
        "contact",
        "data-sets",
        "designs",
        "forces",
        "formats",
        "making",
        "maps",
    ),
    "optics",
    "search",
)
"""Pages that no generator writes; those about the program's inside have tests of their own."""


def page(name: str) -> str:
    """The text of a page of `docs`."""
    return (DOCS / f"{name}.md").read_text(encoding="utf-8")


def code(name: str) -> str:
    """All that stands between single backticks on a page."""
    prose = re.sub(r"^```.*?^```$", "", page(name), flags=re.MULTILINE | re.DOTALL)
    return " ".join(re.findall(r"`([^`]+)`", prose))


def words(name: str) -> set[str]:
    """Whole words of that code."""
    return set(re.findall(r"[\w.]+", code(name)))


def blocks(text: str, language: str) -> list[str]:
    """Fenced blocks of a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL)


def commands(text: str) -> list[list[str]]:
    """The lines of shell of a text that start with `workbench`, as words behind it."""
    lines = [shlex.split(line) for block in blocks(text, "sh") for line in block.splitlines()]
    return [rest for program, *rest in lines if program == "workbench"]


def first_column(text: str, head: str) -> list[str]:
    """The code in the first column of the table whose heading row begins so."""
    (table,) = re.findall(rf"^\| {re.escape(head)}.*\n\|[-|]+\n((?:\|.*\n)+)", text, re.MULTILINE)
    return re.findall(r"^\| `([^`]+)`", table, re.MULTILINE)
