"""`docs/command-line.md` has every command and option, and every command in the manual is one."""

from __future__ import annotations

import argparse
import importlib
import re

import pytest

from docs.generate_command_line import SHARED, commands
from tests.pages import BY_HAND, ROOT, page
from tests.pages import commands as written
from workbench.cli.command_line import _join_negative, parser
from workbench.cli.press_options import press_case
from workbench.core.design.design import SensorDesign
from workbench.core.press.press import Press

PAGE = page("command-line")
TEXTS = {"README": (ROOT / "README.md").read_text(), **{name: page(name) for name in BY_HAND}}
OPTION = r"(?<![\w-])--[a-z][a-z-]*"
OTHERS = re.compile(r"^.*\bdask (?:worker|scheduler) .*$", re.MULTILINE)
"""Lines that start another program, which has options of its own."""


def chapter(title: str) -> str:
    """What stands under a heading of the page."""
    (found,) = re.findall(rf"^## {re.escape(title)}\n(.*?)(?=^## |\Z)", PAGE, re.M | re.S)
    return found


def long_options(command: argparse.ArgumentParser) -> set[str]:
    return {o for action in command._actions for o in action.option_strings if o[:2] == "--"}


@pytest.mark.parametrize("name", commands())
def test_every_option_of_every_command_is_documented(name: str) -> None:
    """In the command's chapter, or in one about shared options that it links to."""
    text = chapter(f"`workbench {name}`")
    text += "".join(chapter(title) for title in SHARED if f"[{title.lower()}]" in text)
    documented = set(re.findall(OPTION, text)) | {"--help", "--project"}
    assert long_options(commands()[name]) <= documented


@pytest.mark.parametrize("name", commands())
def test_every_argument_says_what_it_does(name: str) -> None:
    """Each has a help text, and the command a sentence."""
    command = commands()[name]
    assert (command.description or "").endswith(".")
    assert [action.dest for action in command._actions if not action.help] == []


@pytest.mark.parametrize("title", SHARED)
def test_shared_options_name_the_commands_that_take_them(title: str) -> None:
    """Exactly those that have them all."""
    scratch = argparse.ArgumentParser(add_help=False)
    SHARED[title](scratch)
    accepting = {n for n, c in commands().items() if long_options(scratch) <= long_options(c)}
    (named,) = re.findall(r"^Options of (.*)\.$", chapter(title), re.MULTILINE)
    assert set(re.findall(r"`([^`]+)`", named)) == accepting


def test_the_project_folder_is_documented_once_for_all_commands() -> None:
    """Every command takes `--project DIR`."""
    assert "`--project DIR`" in PAGE
    assert all("--project" in command.format_help() for command in commands().values())


def test_defaults_that_help_texts_state_are_the_programs() -> None:
    """A press without options has the numbers that its options say."""
    options = parser().parse_args(["run", "geltip", "--out", "out"])
    case = press_case(options, SensorDesign(), Press().target_mm)
    found = 0
    for action in commands()["run"]._actions:
        told = re.search(r"default (\d[\d.]*)(?!,\d)", action.help or "")
        if told:
            parts = (case.settings, case.press, case.indenter)
            (value,) = (getattr(part, action.dest) for part in parts if hasattr(part, action.dest))
            assert float(told[1]) == value, action.dest
            found += 1
    # Size, edges, depth, twist, frames, grid, region, substeps, tolerance, penalty.
    assert found == 10


def test_choices_that_help_texts_state_are_the_programs() -> None:
    """The default among the choices of mover, extent and method."""
    options = parser().parse_args(["run", "geltip", "--out", "out"])
    case = press_case(options, SensorDesign(), Press().target_mm)
    actions = {action.dest: action.help or "" for action in commands()["run"]._actions}
    assert f"(default {case.press.mover.value})" in actions["mover"]
    assert f"(default {case.settings.extent.value})" in actions["extent"]
    assert f"(default {case.settings.method.value})" in actions["method"]
    assert f"(default {case.indenter.kind.value})" in actions["indenter"]


@pytest.mark.parametrize("name", ["validate", "bench"])
def test_every_room_is_documented(name: str) -> None:
    """The argument of the command lists exactly the rooms there are."""
    rooms = importlib.import_module(f"workbench.cli.{name}_rooms").ROOMS
    (told,) = re.findall(
        r"^\| `ROOM\S*` \| one (?:or more )?of (.*) \|$", chapter(f"`workbench {name}`"), re.M
    )
    assert told.split(", ") == list(rooms)


@pytest.mark.parametrize("name", TEXTS)
def test_every_command_that_a_page_shows_can_be_typed(name: str) -> None:
    """The parser takes each line of shell as it stands."""
    for line in written(TEXTS[name]):
        assert callable(parser().parse_args(_join_negative(line)).handler), line


@pytest.mark.parametrize("name", TEXTS)
def test_every_option_that_a_page_names_exists(name: str) -> None:
    """And every command named in the text."""
    every = set().union(*map(long_options, commands().values()))
    ours = re.sub(OTHERS, "", TEXTS[name])
    assert set(re.findall(OPTION, ours)) <= every
    known = {*commands(), *(command.split()[0] for command in commands())}
    for named in re.findall(r"`workbench ([a-z]+(?: [a-z]+)?)", TEXTS[name]):
        assert named in known or named.split()[0] in known, named
    groups = {command.split()[0] for command in commands() if " " in command}
    for group, word in re.findall(r"`workbench ([a-z]+) ([a-z]+)", TEXTS[name]):
        assert group not in groups or f"{group} {word}" in known, (group, word)
