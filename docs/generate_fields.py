"""Write `fields.md` from the dataclasses: every field of a design file with its default."""

from __future__ import annotations

import dataclasses
import enum
import types
import typing
from collections.abc import Iterator
from typing import Any

from designs.family import families, sliders
from docs.field_words import choices, field_docs, one_line
from workbench.core.design.design import SensorDesign
from workbench.core.design.imported import IMPORTED, ImportedBody
from workbench.core.design.photo import Photo
from workbench.core.design.unit import Unit
from workbench.core.press.indenter import IndenterMesh
from workbench.core.press.press_case import PressCase
from workbench.core.press.texture import HeightImage

HEAD = """# Every field of a design file

Made from the program by `make docs`. A design is a text file in TOML ([designs.md](designs.md));
each heading below is a table of it, and what is left out has the default. A heading in double
brackets may stand several times. On the command line `--set` takes a field by its table and name:
`--set optics.ring.count=6`.
"""
FILES = (Photo, Unit, ImportedBody)
"""Fields that a design file gives by the name of a file."""
ARRAYS = (IndenterMesh, HeightImage)
"""Fields that the workbench keeps for itself, beside the design."""
UNWRITTEN = {"body", "shape", "schema"}
"""Told elsewhere: `[body]` and `schema` in designs.md, `[shape]` at the end of the page."""


def page() -> str:
    """The whole page."""
    tables = [*_tables(SensorDesign, "", {}), *_tables(PressCase, "press_case", {})]
    shapes = [_shape(name) for name in families()]
    between = "## `[shape]`\n\nThe parameters of each family.\n"
    return "\n".join([HEAD, *tables, between, *shapes])


def _tables(cls: Any, at: str, known: dict[Any, str], *, repeated: bool = False) -> Iterator[str]:
    """The table of a dataclass, then those of the dataclasses in it; of a known one its name."""
    title = f"[[{at}]]" if repeated else f"[{at}]"
    if cls in known:
        yield f"## `{title}`\n\nThe fields of `{known[cls]}`, and its tables.\n"
        return
    known[cls] = title
    hints, inner, rows = typing.get_type_hints(cls), [], []
    for item in dataclasses.fields(cls):
        part, several = _part(hints[item.name])
        if (not at and item.name in UNWRITTEN) or part in ARRAYS:
            continue
        if dataclasses.is_dataclass(part) and part not in FILES:
            inner.append((part, f"{at}.{item.name}".lstrip("."), several))
        else:
            rows.append(_row(cls, item, part))
    if rows:
        yield f"## `{title}`\n" if at else "## At the head\n"
        yield _table(rows)
    for part, place, several in inner:
        yield from _tables(part, place, known, repeated=several)


def _part(hint: Any) -> tuple[Any, bool]:
    """What a field holds, without `None` and the list around it; and whether it is a list."""
    if isinstance(hint, types.UnionType):
        (hint,) = (one for one in typing.get_args(hint) if one is not type(None))
    arguments = typing.get_args(hint)
    several = len(arguments) == 2 and arguments[1] is Ellipsis
    if several and dataclasses.is_dataclass(arguments[0]):
        return arguments[0], True
    return hint, False


def _row(cls: Any, item: Any, part: Any) -> str:
    meaning = field_docs(cls).get(item.name) or item.metadata.get("hint", "")
    if isinstance(part, type) and issubclass(part, enum.Enum):
        meaning = " ".join(filter(None, (meaning, f"{choices(part)}.")))
    return f"| `{item.name}` | {_default(item.default)} | {meaning} |"


def _default(value: Any) -> str:
    if value is dataclasses.MISSING:
        return "needed"
    if value is None or value in ("", ()):
        return "none"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return ", ".join(_default(one) for one in value)
    return f"{value:g}" if isinstance(value, float) else str(value)


def _table(rows: list[str]) -> str:
    return "\n".join(["| field | default | |", "|---|---|---|", *rows, ""])


def _shape(name: str) -> str:
    rows = [
        f"| `{each.name}` | {each.default:g} | {each.minimum:g} to {each.maximum:g} {each.unit} "
        f"| {one_line(each.hint)} |"
        for each in sliders(name)
    ]
    title = f"### `{name}`: {families()[name].title}\n"
    if name == IMPORTED:
        title += "\nIts body is a file: see [designs.md](designs.md#a-body-of-your-own).\n"
    return "\n".join([title, "| field | default | slider | |", "|---|---|---|---|", *rows, ""])
