"""Searches of a project, `searches/NAME/`: what a form asked, as the file that a command reads.

`workbench search searches/NAME/search.toml --out searches/NAME` goes on with such a folder.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.project.design_toml import design_to_toml
from workbench.project.project import Project
from workbench.project.state import State, case_table, read_state
from workbench.search.outputs import FRONT, PLOT, SUMMARY
from workbench.search.problem import Goal, Limit, Problem, Vary, Want
from workbench.search.problem_file import read_problem
from workbench.system.names import is_name
from workbench.system.whole_files import kept_text, write_atomically

FOLDER, ASKED, BASE_FILE = "searches", "search.toml", "base.toml"


@dataclass(frozen=True, kw_only=True, slots=True)
class Asked:
    """What a form holds."""

    vary: tuple[Vary, ...] = ()
    goals: tuple[Goal, ...] = ()
    limits: tuple[Limit, ...] = ()
    wishes: tuple[str, ...] = ()
    even_light: bool = False


@dataclass(frozen=True, kw_only=True, slots=True)
class Standing:
    """How a search stands, as its files say."""

    summary: dict[str, Any]
    """`summary.json`; {} before the first trial."""
    front: tuple[dict[str, Any], ...]
    """Rows of `front.json`."""
    plot: str
    """Its front as SVG."""


NOTHING = Standing(summary={}, front=(), plot="")


def search_folder(project: Project, name: str) -> Path:
    """Where a search lies.

    Raises:
        DesignError: If the name cannot be one.
    """
    if not is_name(name):
        raise DesignError(
            f"{shown(name)} cannot be a name", hint="use letters and digits", at="name"
        )
    return project.folder / FOLDER / name


def list_searches(project: Project) -> list[str]:
    """Names of all searches, the newest first."""
    files = (project.folder / FOLDER).glob(f"*/{ASKED}")
    return [path.parent.name for path in sorted(files, key=lambda p: -p.stat().st_mtime)]


def new_search(project: Project, name: str, state: State, asked: Asked) -> Path:
    """Write what is asked of a design, once it is known to be a search; returns the folder.

    Raises:
        DesignError: If it is none.
        StoreError: If the folder cannot be written.
    """
    import tomli_w

    folder = search_folder(project, name)
    project.keep_files(state.design)
    base = design_to_toml(state.design, press_case=case_table(state.case, project))
    write_atomically(folder / BASE_FILE, base.encode())
    text = tomli_w.dumps(asked_table(asked))
    read_problem(text, project, folder=folder)
    write_atomically(folder / ASKED, text.encode())
    return folder


def asked_table(asked: Asked) -> dict[str, Any]:
    """What a form holds as the tables of a search's file."""
    return {
        "base": BASE_FILE,
        "wishes": list(asked.wishes),
        "even_light": asked.even_light,
        "vary": [_vary_table(vary) for vary in asked.vary],
        "goal": [_goal_table(goal) for goal in asked.goals],
        "limit": [_limit_table(limit) for limit in asked.limits],
    }


def _vary_table(vary: Vary) -> dict[str, Any]:
    if vary.choices:
        return {"field": vary.path, "choices": list(vary.choices)}
    return {"field": vary.path, "low": vary.low, "high": vary.high}


def _goal_table(goal: Goal) -> dict[str, Any]:
    table: dict[str, Any] = {"figure": goal.figure, "want": goal.want.value}
    return table | ({"value": goal.value} if goal.want is Want.TARGET else {})


def _limit_table(limit: Limit) -> dict[str, Any]:
    ends = {"at_least": limit.at_least, "at_most": limit.at_most}
    return {"figure": limit.figure} | {k: v for k, v in ends.items() if v is not None}


def kept_problem(project: Project, name: str) -> Problem:
    """The search of that name.

    Raises:
        DesignError: If its files are gone or were edited into nonsense.
    """
    folder = search_folder(project, name)
    return read_problem(_text(folder / ASKED, name), project, folder=folder)


def standing(folder: Path) -> Standing:
    """How a search stands; files that are not there, or not whole, count as none."""
    return Standing(
        summary=_json(folder / SUMMARY, {}),
        front=tuple(_json(folder / FRONT, [])),
        plot=_plain(folder / PLOT),
    )


def design_of(project: Project, folder: Path, row: dict[str, Any]) -> State:
    """Design and press of a row of the front.

    Raises:
        DesignError: If its file is gone or was edited into nonsense.
    """
    name = str(row["design"])
    return read_state(_text(folder / name, name), project, source=name)


def _text(path: Path, what: str) -> str:
    try:
        return kept_text(path)
    except (OSError, ValueError) as error:
        raise DesignError(
            f"{what} cannot be read: {error}", hint=f"see {path}", at="search"
        ) from error


def _json(path: Path, otherwise: Any) -> Any:
    try:
        return json.loads(path.read_bytes())
    except (OSError, ValueError):
        return otherwise


def _plain(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except OSError:
        return ""
