"""The pages on installing and on the slim environment: what they tell to type is real."""

from __future__ import annotations

import ast
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest

import workbench as wb
from tests.release.conftest import ROOT
from workbench.cli.command_line import parser

PAGES = [ROOT / "docs" / "install.md", ROOT / "docs" / "slim.md"]
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
COMMAND = re.compile(
    r"(?:^|[ /`])workbench ((?:serve|run|doctor|dataset|train)\b[^`\n]*)", re.MULTILINE
)


def commands(page: Path) -> Iterator[str]:
    """What follows the word `workbench` wherever a command is given, not only named."""
    for found in COMMAND.finditer(page.read_text(encoding="utf-8")):
        if " " in found[1] or found[1] == "doctor":
            yield found[1]


def test_their_commands_are_those_of_the_command_line() -> None:
    """By the real parser, options and all."""
    found = {
        command: parser().parse_args(shlex.split(command))
        for page in PAGES
        for command in commands(page)
    }
    assert {options.command for options in found.values()} >= {"serve", "run", "dataset", "train"}


def test_their_python_uses_what_is_public() -> None:
    """Each block is Python, and each `wb.name` is a name of the front door."""
    used: set[str] = set()
    for page in PAGES:
        for language, code in BLOCK.findall(page.read_text(encoding="utf-8")):
            if language == "python":
                for node in ast.walk(ast.parse(code)):
                    if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "wb":
                        used.add(node.attr)
    assert used >= {"ForceNetwork", "evaluate", "load", "DataSet"}
    assert used <= set(wb.__all__)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_files_that_they_name_are_there(page: Path) -> None:
    """Links, and the files of requirements."""
    text = page.read_text(encoding="utf-8")
    links = re.findall(r"\]\(([^)#]+)\)", text)
    assert links or page.name == "slim.md"
    for link in links:
        assert (page.parent / link).exists(), link
    for name in re.findall(r"requirements[\w-]*\.\w+", text):
        assert (ROOT / name).exists(), name


def test_the_container_is_built_and_run_as_its_head_says() -> None:
    """The two lines are the same in both places."""
    head = (ROOT / "Containerfile").read_text(encoding="utf-8").split("FROM")[0]
    lines = [line[2:] for line in head.splitlines() if line.startswith("# podman")]
    assert len(lines) == 2
    page = PAGES[0].read_text(encoding="utf-8")
    assert all(f"\n{line}\n" in page for line in lines)
