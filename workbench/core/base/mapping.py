"""Plain tables (as TOML holds them) to validated dataclasses, and back.

Every complaint names the dotted field, so that a designer who edits a file by hand is told where.
"""

from __future__ import annotations

import dataclasses
import difflib
import enum
import types
import typing
from collections.abc import Mapping
from typing import Any, cast

from workbench.core.base.errors import DesignError, shown

LARGEST_INTEGER = 2**53
"""Beyond it a float no longer holds every integer, and far beyond none at all."""


def from_table(cls: type[Any], table: Any, *, at: str = "") -> Any:
    """Build a dataclass from a table; missing fields keep their defaults.

    Raises:
        DesignError: For an unknown field, a wrong type or a refused value, with `at`.
    """
    if not isinstance(table, Mapping):
        raise DesignError(
            f"{at or 'the design'} is {shown(table)}, expected a table of fields",
            hint="write it as [table] in TOML",
            at=at,
        )
    hints = typing.get_type_hints(cls)
    names = {f.name for f in dataclasses.fields(cls)}
    values: dict[str, Any] = {}
    for name, raw in cast("Mapping[str, Any]", table).items():
        where = f"{at}.{name}" if at else name
        if name not in names:
            raise DesignError(
                f"there is no field {shown(where)}", hint=suggest(name, names), at=where
            )
        values[name] = _convert(hints[name], raw, where)
    missing = dataclasses.MISSING
    for field in dataclasses.fields(cls):
        if field.name not in values and field.default is field.default_factory is missing:
            raise DesignError(
                f"{at or 'the design'} has no {shown(field.name)}",
                hint=f"add {field.name} = ... to it",
                at=f"{at}.{field.name}" if at else field.name,
            )
    return cls(**values)


def to_table(value: Any) -> Any:
    """A dataclass as nested plain tables, lists, numbers and strings; TOML has no None."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        held = {f.name: getattr(value, f.name) for f in dataclasses.fields(value)}
        return {name: to_table(item) for name, item in held.items() if item is not None}
    if isinstance(value, enum.Enum):
        return value.value
    if isinstance(value, Mapping):
        return {name: to_table(v) for name, v in cast("Mapping[str, Any]", value).items()}
    if isinstance(value, (tuple, list)):
        return [to_table(item) for item in cast("tuple[Any, ...]", value)]
    return value


def suggest(name: str, known: typing.Iterable[str]) -> str:
    """A remedy for a misspelt name: the nearest known one, else all of them."""
    choices = sorted(known)
    near = difflib.get_close_matches(name, choices, n=1)
    return f"did you mean '{near[0]}'?" if near else f"known: {', '.join(choices)}"


def _convert(hint: Any, raw: Any, at: str) -> Any:
    if isinstance(hint, types.UnionType):
        # A field that may be missing: X | None.
        (hint,) = (part for part in typing.get_args(hint) if part is not type(None))
    origin = typing.get_origin(hint)
    if dataclasses.is_dataclass(hint):
        return from_table(cast("type[Any]", hint), raw, at=at)
    if isinstance(hint, type) and issubclass(hint, enum.Enum):
        values = [str(member.value) for member in hint]
        if raw not in values:
            raise DesignError(f"{at} is {shown(raw)}", hint=suggest(str(raw), values), at=at)
        return hint(raw)
    if origin is tuple:
        return _tuple(typing.get_args(hint), raw, at)
    if origin is Mapping:
        return _table(raw, at)
    if isinstance(raw, int) and abs(raw) > LARGEST_INTEGER:
        raise DesignError(
            f"{at} is an integer of {len(str(raw))} digits, beyond 2^53",
            hint="see docs/fields.md",
            at=at,
        )
    if hint is float and isinstance(raw, int) and not isinstance(raw, bool):
        return float(raw)
    if isinstance(hint, type) and (
        not isinstance(raw, hint)
        or (hint is int and raw in (True, False) and isinstance(raw, bool))
    ):
        raise DesignError(
            f"{at} is {shown(raw)}, expected {hint.__name__}", hint="see docs/fields.md", at=at
        )
    return raw


def _table(raw: Any, at: str) -> Mapping[str, Any]:
    if not isinstance(raw, Mapping):
        raise DesignError(
            f"{at} is {shown(raw)}, expected a table", hint=f"write it as [{at}] in TOML", at=at
        )
    return cast("Mapping[str, Any]", raw)


def _tuple(parts: tuple[Any, ...], raw: Any, at: str) -> tuple[Any, ...]:
    given: Any = raw
    items = cast("list[Any]", raw) if isinstance(raw, (list, tuple)) else None
    open_ended = len(parts) == 2 and parts[1] is Ellipsis
    if items is None or (not open_ended and len(items) != len(parts)):
        count = "values" if open_ended else f"{len(parts)} values"
        raise DesignError(
            f"{at} is {shown(given)}, expected a list of {count}", hint="see docs/fields.md", at=at
        )
    kinds = [parts[0]] * len(items) if open_ended else list(parts)
    if open_ended and dataclasses.is_dataclass(parts[0]):
        return tuple(_item(kinds[0], item, at, k) for k, item in enumerate(items, start=1))
    return tuple(_convert(k, item, at) for k, item in zip(kinds, items, strict=True))


def _item(hint: Any, raw: Any, owner: str, number: int) -> Any:
    try:
        return _convert(hint, raw, f"{owner}[{number}]")
    except DesignError as error:
        name_item(error, owner, number)
        raise


def name_item(error: DesignError, owner: str, number: int) -> None:
    """Let a message of one item of a list say which: `optics.lamps[1].power`, from 1.

    Args:
        error: The message; an item, which does not know its number, names the list
            (`optics.lamps.power`) or the first of its kind (`optics.camera.fov_x_deg`).
        owner: Field of the list, for example `optics.cameras`.
        number: Of the item, from 1.
    """
    for spoken in (owner, owner.removesuffix("s")):
        rest = error.at.removeprefix(spoken)
        if error.at.startswith(spoken) and rest[:1] in ("", "."):
            error.at = f"{owner}[{number}]{rest}"
            return
