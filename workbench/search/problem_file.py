"""The file of a search, `FILE.toml`, read into a `Problem` with everything checked that can be.

```toml
base = "geltip"
wishes = ["robust to .3 mm"]

[[vary]]
field = "design.optics.ring.tilt_deg"
low = -20.0
high = 20.0

[[vary]]
field = "design.optics.ring.mount"
choices = ["cavity", "shell"]

[[link]]
field = "design.optics.ring.radius_mm"
follows = "design.shape.outer_radius_mm"

[[goal]]
figure = "light_evenness_p5_over_p95_1"
want = "max"

[[limit]]
figure = "skin_seen_percent"
at_least = 60.0
```
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import from_table, suggest
from workbench.project.design_toml import parse_toml
from workbench.project.named_designs import load_design
from workbench.project.prices import Prices, read_prices
from workbench.project.project import Project
from workbench.project.state import State, fresh_state, read_state
from workbench.search.applying import with_settings
from workbench.search.consistent import expect_consistent
from workbench.search.problem import DRAFT, Goal, Limit, Problem, Tolerances, Want
from workbench.search.search_figures import COST, KNOWN
from workbench.search.varied import read_link, read_vary
from workbench.search.wishes import Wish, wish_of
from workbench.system.whole_files import kept_text, toml_table

SCALARS = {
    "even_light": bool,
    "per_press": int,
    "finalists": int,
    "photons": bool,
    "seed": int,
    "trials": int,
}
TABLES = ("base", "wishes", "vary", "link", "goal", "limit", "draft", "tolerances", "prices")


def load_problem(path: Path, project: Project) -> Problem:
    """A search from its file; a base that is a file is looked for beside it.

    Raises:
        DesignError: If the file cannot be read, or `read_problem` refuses it.
    """
    try:
        text = kept_text(path)
    except (OSError, ValueError) as error:
        raise DesignError(
            f"cannot read {path}: {getattr(error, 'strerror', None) or error}",
            hint="give the path of a readable UTF-8 TOML file",
            at="search",
        ) from error
    return read_problem(text, project, folder=path.parent)


def read_problem(text: str, project: Project, *, folder: Path) -> Problem:
    """A search from the text of its file.

    Args:
        text: TOML.
        project: Where files that the base names are kept.
        folder: Where a base that is a file is looked for.

    Raises:
        DesignError: For broken TOML; an unknown word, field or figure, with the nearest one; an
            empty range; limits that no design of this search can keep.
    """
    try:
        table = toml_table(text)
    except ValueError as error:
        raise DesignError(
            f"the search is not valid TOML: {error}", hint="correct the line named", at="search"
        ) from error
    _expect_known(table, (*SCALARS, *TABLES), "")
    base = base_of(table.get("base"), project, folder)
    wishes = [wish_of(words) for words in _list(table, "wishes")]
    goals = [_goal(row) for row in _rows(table, "goal")]
    limits = [_limit(row) for row in _rows(table, "limit")]
    problem = Problem(
        base=base,
        vary=tuple(read_vary(row, base) for row in _rows(table, "vary")),
        links=tuple(read_link(row, base) for row in _rows(table, "link")),
        goals=_with_wishes(goals, (goal for wish in wishes for goal in wish.goals)),
        limits=_with_wishes(limits, (limit for wish in wishes for limit in wish.limits)),
        draft=_draft(table, base),
        tolerances=_tolerances(table, wishes),
        prices=_prices(table, project, [each.figure for each in (*goals, *limits)]),
        **{name: _scalar(table, name) for name in SCALARS if name in table},
    )
    expect_consistent(problem)
    return problem


def _prices(table: Mapping[str, Any], project: Project, figures: list[str]) -> Prices | None:
    """Those of the file, else the project's where the cost is asked for: only then they count."""
    if "prices" in table:
        return from_table(Prices, table["prices"], at="prices")
    return read_prices(project.folder) if COST in figures else None


def base_of(name: Any, project: Project, folder: Path) -> State:
    """The design and press that a search begins with: a preset, a family, or a file."""
    if not isinstance(name, str):
        raise DesignError(
            "the search has no base" if name is None else f"base is {shown(name)}",
            hint='write base = "geltip", another preset, a family, or the file of a design',
            at="base",
        )
    if not name.endswith(".toml"):
        return fresh_state(load_design(name, project=project))
    path = folder / name
    design = load_design(path, project=project)
    text = kept_text(path)
    if "press_case" not in parse_toml(text, source=name):
        return fresh_state(design)
    return State(design=design, case=read_state(text, project, source=name).case)


def _goal(row: Mapping[str, Any]) -> Goal:
    _expect_known(row, ("figure", "want", "value"), "goal")
    want = row.get("want")
    if want not in [each.value for each in Want]:
        raise DesignError(
            f"a goal wants {shown(want)}", hint="write want = max, min or target", at="goal.want"
        )
    if (want == Want.TARGET) != ("value" in row):
        raise DesignError(
            f"a goal of {shown(want)} {'has no' if want == Want.TARGET else 'takes no'} value",
            hint="value = ... belongs to want = target",
            at="goal.value",
        )
    value = number(row.get("value", 0.0), "goal.value")
    return Goal(figure=_figure(row, "goal"), want=Want(want), value=value)


def _limit(row: Mapping[str, Any]) -> Limit:
    _expect_known(row, ("figure", "at_least", "at_most"), "limit")
    ends = {
        name: number(row[name], f"limit.{name}") for name in ("at_least", "at_most") if name in row
    }
    figure = _figure(row, "limit")
    if not ends:
        hint = "write at_least = ... or at_most = ..."
        raise DesignError(f"the limit of {figure} has no end", hint=hint, at="limit")
    return Limit(figure=figure, **ends)


def _figure(row: Mapping[str, Any], at: str) -> str:
    name = row.get("figure")
    if not isinstance(name, str) or name not in KNOWN:
        hint = suggest(str(name), KNOWN)
        raise DesignError(f"there is no figure {shown(name)}", hint=hint, at=f"{at}.figure")
    return name


def _with_wishes(stated: list[Any], wished: Iterable[Any]) -> tuple[Any, ...]:
    """Goals, or limits, of the file, then those of wishes for other figures."""
    found = {each.figure: each for each in (*reversed(list(wished)), *stated)}
    return (
        tuple(found[each.figure] for each in stated)
        + tuple(each for name, each in found.items() if name not in {one.figure for one in stated})[
            ::-1
        ]
    )


def _draft(table: Mapping[str, Any], base: State) -> tuple[str, ...]:
    if "draft" not in table:
        return DRAFT
    settings = tuple(_list(table, "draft"))
    if not all(isinstance(each, str) and "=" in each for each in settings):
        raise DesignError(
            f"draft is {shown(settings)}",
            hint='write draft = ["design.optics.baking.photons=400000"], or [] for none',
            at="draft",
        )
    with_settings(base, settings)
    return settings


def _tolerances(table: Mapping[str, Any], wishes: list[Wish]) -> Tolerances:
    wished = [wish.tolerances for wish in wishes if wish.tolerances is not None]
    found = wished[-1] if wished else Tolerances()
    if "tolerances" in table:
        stated = from_table(Tolerances, table["tolerances"], at="tolerances")
        given = {name: getattr(stated, name) for name in table["tolerances"]}
        found = dataclasses.replace(found, **given)
    return found


def _rows(table: Mapping[str, Any], name: str) -> list[Mapping[str, Any]]:
    rows = _list(table, name)
    if not all(isinstance(row, Mapping) for row in rows):
        raise DesignError(
            f"{name} is {shown(rows)}", hint=f"write it as tables, [[{name}]]", at=name
        )
    return rows


def _list(table: Mapping[str, Any], name: str) -> list[Any]:
    found = table.get(name, [])
    if not isinstance(found, list):
        raise DesignError(f"{name} is {shown(found)}, expected a list", hint="see above", at=name)
    return found


def _scalar(table: Mapping[str, Any], name: str) -> Any:
    value, kind = table[name], SCALARS[name]
    if type(value) is not kind or (kind is int and value < 0):
        word = "true or false" if kind is bool else "a whole number, 0 or more"
        raise DesignError(f"{name} is {shown(value)}", hint=f"write {word}", at=name)
    return value


def _expect_known(table: Mapping[str, Any], names: Iterable[str], at: str) -> None:
    for name in table:
        if name not in set(names):
            where = f"{at}.{name}" if at else name
            raise DesignError(
                f"a search has no {shown(where)}", hint=suggest(name, names), at=where
            )


def number(value: object, at: str) -> float:
    """A finite number of the file.

    Raises:
        DesignError: If it is none.
    """
    from workbench.core.base.check import within

    return within(value, -1e12, 1e12, what=at, unit="", at=at)
