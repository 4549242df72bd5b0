"""Fields that a search varies or links: found among those of the design, their values tried."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from workbench.core.base.check import within
from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest, to_table
from workbench.edit.item_fields import read_field
from workbench.edit.typed_fields import nearest_field
from workbench.project.design_toml import design_table
from workbench.project.state import State
from workbench.search.applying import CASE, DESIGN, text_of, with_values
from workbench.search.problem import Link, Vary
from workbench.variants.sweep_fields import SweepField, field_value, sweep_fields

VARY = ("field", "low", "high", "log", "choices")
LINK = ("field", "follows", "factor", "offset")
FEWEST = 2
"""Choices."""


def read_vary(row: Mapping[str, Any], base: State) -> Vary:
    """A `[[vary]]` of the file.

    Raises:
        DesignError: If the field is unknown or no number, the range empty, or a choice refused.
    """
    _expect_known(row, VARY, "vary")
    path = known_path(row.get("field"), base, "vary.field")
    field = _fields(base).get(path)
    title = field.title if field is not None else path.removeprefix(DESIGN)
    if "choices" in row:
        return Vary(path=path, title=title, choices=_choices(row, path, base))
    low, high = (_number(row, end, path) for end in ("low", "high"))
    log = row.get("log", False) is True
    if not low < high or (log and low <= 0.0):
        unit = f" {field.unit}" if field is not None and field.unit else ""
        raise DesignError(
            f"{path} from {low:g} to {high:g}{unit} is an empty range",
            hint="give a low that is less than high" + (", above 0 with log" if log else ""),
            at=path,
        )
    whole = field.whole if field is not None else isinstance(_numeric(base, path), int)
    if field is None:
        _numeric(base, path)
    vary = Vary(path=path, title=title, low=low, high=high, whole=whole, log=log)
    _expect_some(vary, base)
    return vary


def read_link(row: Mapping[str, Any], base: State) -> Link:
    """A `[[link]]` of the file; without factor and offset the fields keep their distance.

    Raises:
        DesignError: If a field is unknown or no number.
    """
    _expect_known(row, LINK, "link")
    path = known_path(row.get("field"), base, "link.field")
    leader = known_path(row.get("follows"), base, "link.follows")
    follower_now, leader_now = (float(_numeric(base, each)) for each in (path, leader))
    factor = _number(row, "factor", path) if "factor" in row else 1.0
    kept = follower_now - factor * leader_now if "factor" not in row else 0.0
    offset = _number(row, "offset", path) if "offset" in row else kept
    return Link(path=path, follows=leader, factor=factor, offset=offset)


def known_path(name: object, base: State, at: str) -> str:
    """The full path of a field as people may write it.

    Raises:
        DesignError: If there is none; the hint has the nearest.
    """
    known = _fields(base)
    if isinstance(name, str):
        full = next((p + name for p in ("", DESIGN, CASE) if p + name in known), "")
        if full:
            return full
        rest = name.removeprefix(DESIGN)
        if not name.startswith(CASE) and _exists(base, rest):
            return DESIGN + rest
    text = str(name)
    table = to_table(design_table(base.design))
    hint = suggest(text, known) if text.startswith(CASE) else nearest_field(text, table)
    raise DesignError(f"there is no field {shown(name)} to vary", hint=hint, at=at)


def _exists(base: State, path: str) -> bool:
    try:
        read_field(base.design, path)
    except (AttributeError, KeyError, IndexError, TypeError, ValueError):
        return False
    return True


def _fields(base: State) -> dict[str, SweepField]:
    return {field.path: field for field in sweep_fields(base)}


def _numeric(base: State, path: str) -> float | int:
    """The number that the base has in a field.

    Raises:
        DesignError: If it has none.
    """
    value = field_value(base, path) if path in _fields(base) else read_field(base, path)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise DesignError(
            f"{path} is {shown(value)}, which is no number",
            hint="name its choices = [...] instead of a range",
            at=path,
        )
    return value


def _choices(row: Mapping[str, Any], path: str, base: State) -> tuple[str, ...]:
    given = row["choices"]
    if not isinstance(given, list) or len(given) < FEWEST or {"low", "high"} & set(row):
        raise DesignError(
            f"the choices of {path} are {shown(given)}",
            hint="give a list of two or more, and no low and high",
            at=path,
        )
    texts = tuple(dict.fromkeys(text_of(choice) for choice in given))
    for text in texts:
        with_values(base, {path: text})
    return texts


def _expect_some(vary: Vary, base: State) -> None:
    """Refuse a range of which the design takes neither end nor middle, beside the base's values."""
    refused = []
    values = (vary.low, 0.5 * (vary.low + vary.high), vary.high)
    for value in values:
        try:
            with_values(base, {vary.path: round(value) if vary.whole else value})
        except DesignError as error:
            refused.append(error)
    if len(refused) == len(values):
        raise refused[0]


def _number(row: Mapping[str, Any], name: str, path: str) -> float:
    if name not in row:
        raise DesignError(
            f"{path} has no {name}", hint="give low and high, or choices = [...]", at=path
        )
    return within(row[name], -1e12, 1e12, what=f"{name} of {path}", unit="", at=path)


def _expect_known(row: Mapping[str, Any], names: tuple[str, ...], at: str) -> None:
    for name in row:
        if name not in names:
            where = f"{at}.{name}"
            raise DesignError(
                f"a search has no {shown(where)}", hint=suggest(name, names), at=where
            )
