"""Fields of a design as typed: `optics.ring.count=6`, `material.law=linear`, `shape.length_mm=40`.

A field is named by its dotted path as in a design file, items of lists by their number from 1. What
is typed is read by the field's type, put into the table that a design file would hold, and checked
as that file would be, all together: fields that depend on one another may come in any order.
Texts need no quotes and lists no brackets: `optics.ring.colours=#ff0000,#0000ff`.
"""

from __future__ import annotations

import dataclasses
import difflib
import enum
import re
import types
import typing
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import from_table, suggest, to_table
from workbench.core.design.design import SensorDesign
from workbench.edit.led_table import with_count
from workbench.project.design_toml import check_design
from workbench.project.moduli import CONSTANTS, MODULI, with_moduli
from workbench.project.photos import FIELDS, design_photos, with_photos, without_photos
from workbench.system.whole_files import toml_table

STEP = re.compile(r"(\w+)(?:\[(\d+)\])?")
COUNT, POWERS = "optics.ring.count", "optics.ring.powers"
BY_ITSELF = ("body", "schema")
"""Fields that come with the file of a design."""
ROOT = "design."
BOOLEANS = {"true": True, "on": True, "yes": True, "false": False, "off": False, "no": False}


def with_typed(design: SensorDesign, typed: Sequence[str]) -> SensorDesign:
    """The design with fields as typed, each `FIELD=VALUE`; the last word on a field counts.

    Raises:
        DesignError: For a word without a field, an unknown field (the hint has the nearest), or a
            value that is refused.
    """
    if not typed:
        return design
    table = to_table(without_photos(dataclasses.replace(design, body=None)))
    pictures: dict[str, Any] = dict(design_photos(design))
    named: dict[str, str] = {}
    given = dict(_parted(word) for word in typed)
    for path, text in given.items():
        if path in FIELDS:
            pictures.pop(path, None)
            named |= {path: text} if text else {}
        else:
            _assign(table, path, text)
    count = table["optics"]["ring"]["count"]
    if COUNT in given and POWERS not in given and isinstance(count, int):
        # The factors on single LEDs follow the number of LEDs.
        table["optics"]["ring"]["powers"] = list(with_count(design.optics.ring, count).powers)
    table["material"] = with_moduli(table["material"])
    found = from_table(SensorDesign, table)
    for path, picture in pictures.items():
        found = found.replace(path, picture)
    found = with_photos(found, named, roots=(Path(),))
    found = dataclasses.replace(found, body=design.body)
    check_design(found)
    return found


def sets(typed: Sequence[str], beginning: str) -> bool:
    """Whether a field that begins so is among those typed."""
    return any(word.strip().removeprefix(ROOT).startswith(beginning) for word in typed)


def _parted(word: str) -> tuple[str, str]:
    path, equals, text = word.partition("=")
    if not equals or not path.strip():
        raise DesignError(
            f"--set {shown(word)} is no FIELD=VALUE",
            hint="for example --set material.friction=0.5",
            at="--set",
        )
    return path.strip().removeprefix(ROOT), text.strip()


def _assign(table: dict[str, Any], path: str, text: str) -> None:
    """Put a value into the table of a design, read by the type of its field."""
    owner, kind, at = table, SensorDesign, ""
    *steps, last = _steps(path, table)
    for name, number in steps:
        kind, at = _field(kind, name, path, at, table)
        if not isinstance(owner.get(name), (dict, list)):
            raise _unknown(path, table)
        owner = owner[name]
        if number is not None:
            (kind, *_), owner = typing.get_args(kind), _items(owner, number, at)[number - 1]
    name, number = last
    kind, at = _field(kind, name, path, at, table)
    if number is not None:
        parts = typing.get_args(kind)
        items = _items(owner.get(name), number, at)
        kind = parts[0] if parts[-1] is Ellipsis else parts[number - 1]
        items[number - 1] = _read(kind, text, path)
        return
    owner[name] = _read(kind, text, path)
    if path.removeprefix("material.") in CONSTANTS:
        # They stand for the two moduli.
        for modulus in MODULI:
            owner.pop(modulus, None)


def _steps(path: str, table: Mapping[str, Any]) -> list[tuple[str, int | None]]:
    found = []
    for step in path.split("."):
        match = STEP.fullmatch(step)
        if match is None:
            raise _unknown(path, table)
        found.append((match[1], int(match[2]) if match[2] else None))
    return found


def _field(owner: Any, name: str, path: str, at: str, table: Mapping[str, Any]) -> tuple[Any, str]:
    """Type of a field of a table, and its path."""
    kinds = _kinds(owner, at, table)
    if name not in kinds or (not at and name in BY_ITSELF):
        raise _unknown(path, table)
    return _bare(kinds[name]), f"{at}.{name}" if at else name


def _kinds(owner: Any, at: str, table: Mapping[str, Any]) -> dict[str, Any]:
    """Types of the fields of a table by name; the shape's are those of the family."""
    if at == "shape":
        from designs.family import family

        owner = family(str(table["family"])).shape_type
    if not dataclasses.is_dataclass(owner):
        return {}
    hints = typing.get_type_hints(owner)
    own = {field.name: hints[field.name] for field in dataclasses.fields(owner)}
    return own | dict.fromkeys(CONSTANTS, float) if at == "material" else own


def _bare(kind: Any) -> Any:
    """The type of a field that may be missing."""
    if isinstance(kind, types.UnionType):
        (kind,) = (part for part in typing.get_args(kind) if part is not type(None))
    return kind


def _items(held: Any, number: int, at: str) -> list[Any]:
    count = len(held) if isinstance(held, list) else 0
    if not 1 <= number <= count:
        raise DesignError(
            f"{at} has {count} items, so there is no {at}[{number}]",
            hint=f"items count from 1; or write the whole list, {at}=[...], as in TOML",
            at=at,
        )
    return held


def _read(kind: Any, text: str, path: str) -> Any:
    """A value as a design file would have it; what cannot be read stays a text, and is refused."""
    kind = _bare(kind)
    if dataclasses.is_dataclass(kind):
        value = _toml(text)
        if isinstance(value, dict):
            return value
        raise DesignError(
            f"{path} is a table of fields",
            hint=f"name one of them, for example {path}.{dataclasses.fields(kind)[0].name}=...",
            at=path,
        )
    if kind is str or (isinstance(kind, type) and issubclass(kind, enum.Enum)):
        return text[1:-1] if len(text) > 1 and text[0] == text[-1] and text[0] in "\"'" else text
    if kind is bool:
        return BOOLEANS.get(text.lower(), text)
    if typing.get_origin(kind) is tuple:
        return _read_list(kind, text, path)
    value = _toml(text)
    return text if value is None else value


def _read_list(kind: Any, text: str, path: str) -> Any:
    value = _toml(text)
    if isinstance(value, list):
        return value
    parts = typing.get_args(kind)
    bare = text.removeprefix("[").removesuffix("]").strip()
    words = [word.strip() for word in bare.split(",")] if bare else []
    kinds = [parts[0]] * len(words) if parts[-1] is Ellipsis else parts
    if len(kinds) != len(words):
        # How many there must be is said where the table is read.
        return words
    return [_read(one, word, path) for one, word in zip(kinds, words, strict=True)]


def _toml(text: str) -> Any:
    """The one value of a line of TOML, None if it is none."""
    try:
        table = toml_table(f"value = {text}")
    except ValueError:
        return None
    return table["value"] if len(table) == 1 else None


def _unknown(path: str, table: Mapping[str, Any]) -> DesignError:
    if path.startswith("case."):
        hint = "the press is no part of a design: it has options of its own (see --help)"
    else:
        hint = nearest_field(path, table)
    return DesignError(f"the design has no field {shown(path)}", hint=hint, at="--set")


def nearest_field(path: str, table: Mapping[str, Any]) -> str:
    """A remedy for a misspelt field: the nearest path, by the whole or by its last name."""
    known = list(_paths(SensorDesign, "", table))
    near = difflib.get_close_matches(path[:80], known, n=1)
    if not near:
        lasts = {one.rpartition(".")[2]: one for one in reversed(known)}
        last = difflib.get_close_matches(path[:80].rpartition(".")[2], lasts, n=1)
        near = [lasts[name] for name in last]
    if near:
        return f"did you mean {near[0]!r}?"
    return suggest(path[:80], {one.partition(".")[0] for one in known})


def _paths(owner: Any, at: str, table: Mapping[str, Any]) -> Iterator[str]:
    """All fields by their paths, one item of each list of tables."""
    for name, kind in _kinds(owner, at, table).items():
        if not at and name in BY_ITSELF:
            continue
        path, kind = f"{at}.{name}" if at else name, _bare(kind)
        parts = typing.get_args(kind)
        if (dataclasses.is_dataclass(kind) and path not in FIELDS) or path == "shape":
            yield from _paths(kind, path, table)
        elif parts and dataclasses.is_dataclass(parts[0]):
            yield from _paths(parts[0], f"{path}[1]", table)
        else:
            yield path
