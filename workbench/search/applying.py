"""From values of varied fields to a design and its press; links follow, the press is aimed anew."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterable, Mapping

from workbench.core.base.errors import DesignError, shown
from workbench.edit.item_fields import read_field
from workbench.edit.typed_fields import with_typed
from workbench.project.design_toml import design_table
from workbench.project.state import State
from workbench.search.problem import Link, Problem, Value
from workbench.variants.sweep_fields import (
    aimed,
    field_value,
    find_field,
    sweep_fields,
    with_value,
)

DESIGN, CASE = "design.", "case."


def state_of(problem: Problem, values: Mapping[str, Value], *, draft: bool = False) -> State:
    """The base with these values, and what follows them.

    Args:
        problem: The search.
        values: By the path of the field; those that are left out stay as the base has them.
        draft: Whether with the settings of trials.

    Raises:
        DesignError: If the design refuses them together.
    """
    state = with_values(problem.base, {**values, **followed(problem, values)})
    return with_settings(state, problem.draft) if draft else state


def base_parameters(problem: Problem) -> dict[str, Value]:
    """What the base has in the varied fields; choices as they are typed."""
    numbers = {field.path for field in sweep_fields(problem.base)}
    found: dict[str, Value] = {}
    for vary in problem.vary:
        if vary.path not in numbers:
            table = {"design": design_table(problem.base.design)}
            found[vary.path] = text_of(read_field(table, vary.path))
        else:
            value = field_value(problem.base, vary.path)
            found[vary.path] = f"{value:g}" if vary.choices else value
    return found


def followed(problem: Problem, values: Mapping[str, Value]) -> dict[str, Value]:
    """Values of the fields that follow others."""
    return {link.path: _followed(problem.base, link, values) for link in problem.links}


def _followed(base: State, link: Link, values: Mapping[str, Value]) -> float:
    leader = values.get(link.follows)
    leader = field_value(base, link.follows) if leader is None else float(leader)
    # Rounded, so that the same design has the same key.
    return float(f"{link.factor * leader + link.offset:.9g}")


def with_values(state: State, values: Mapping[str, Value]) -> State:
    """A state with fields changed, those of the design all together.

    Raises:
        DesignError: If there is no such field, or a value is refused.
    """
    typed = [
        f"{path.removeprefix(DESIGN)}={text_of(value)}"
        for path, value in values.items()
        if path.startswith(DESIGN)
    ]
    if typed:
        design = with_typed(state.design, typed)
        case = aimed(state, dataclasses.replace(state, design=design))
        state = State(design=design, case=case)
    for path, value in values.items():
        if path.startswith(CASE):
            state = with_value(state, find_field(state, path), _number(path, value))
    return state


def with_settings(state: State, settings: Iterable[str]) -> State:
    """A state with settings as `FIELD=VALUE`.

    Raises:
        DesignError: If one is none, or is refused.
    """
    pairs = [setting.partition("=") for setting in settings]
    return with_values(state, {_full(path.strip()): text.strip() for path, _, text in pairs})


def _full(path: str) -> str:
    """The path of a field that may be written without `design`."""
    return path if path.startswith((DESIGN, CASE)) else DESIGN + path


def text_of(value: object) -> str:
    """A value as it is typed: texts as they are, all else as in TOML."""
    return value if isinstance(value, str) else json.dumps(value)


def _number(path: str, value: Value) -> float:
    try:
        return float(value)
    except ValueError:
        raise DesignError(
            f"{path} is {shown(value)}, expected a number",
            hint="of a press only numbers can vary",
            at=path,
        ) from None
