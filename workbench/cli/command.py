"""A command: what may be typed behind its name, and what it does with that.

A command is one file of `workbench.cli.commands` with a `COMMAND`. Of two words it is one of
`workbench.cli.groups`: the file `train_make` is `workbench train make`, and the part before the
underscore has a file of its own with a `GROUP`.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass

from workbench.core.base.records import records
from workbench.project.project import Project

PACKAGE, GROUPS = "workbench.cli.commands", "workbench.cli.groups"


@dataclass(frozen=True, kw_only=True, slots=True)
class Command:
    """One command."""

    place: int
    """Where it stands in the help."""
    run: Callable[[argparse.Namespace, Project], int]
    """Does it; returns the exit code. The first line of its docstring is the help."""
    options: Callable[[argparse.ArgumentParser], None]
    """Adds what may be typed."""

    @property
    def help(self) -> str:
        """What it does, in a line."""
        return (self.run.__doc__ or "").splitlines()[0]


@dataclass(frozen=True, kw_only=True, slots=True)
class Group:
    """Commands that share the first word."""

    place: int
    help: str


def commands() -> dict[str, Command | Group]:
    """Commands and groups by the first word, in the order of the help."""
    found: dict[str, Command | Group] = {**records(PACKAGE, "COMMAND"), **records(GROUPS, "GROUP")}
    return {name: found[name] for name in sorted(found, key=lambda name: found[name].place)}


def members(group: str) -> dict[str, Command]:
    """Commands of a group by their second word, in the order of the help."""
    found = {
        name.removeprefix(f"{group}_"): command
        for name, command in records(GROUPS, "COMMAND").items()
        if name.startswith(f"{group}_")
    }
    return {name: found[name] for name in sorted(found, key=lambda name: found[name].place)}
