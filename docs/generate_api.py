"""Write `api.md` from the docstrings of the front door: every name of `import workbench as wb`."""

from __future__ import annotations

import dataclasses
import enum
import inspect
import re
import typing
from collections.abc import Iterator
from typing import Any

import workbench as wb
from docs.field_words import choices, field_docs

HEAD = """# From Python

Made from the docstrings by `make docs`; `help(wb.evaluate)` says the same. These names are
stable, everything else is private. Lengths are mm, forces N, pressures MPa. The
[README](../README.md) has a first example, [examples/](../examples) more.
"""
SECTION = re.compile(r"^(Args|Returns|Raises|Attributes):$")
VERSION = "__version__"


def page() -> str:
    """The whole page."""
    names = [name for name in wb.__all__ if name != VERSION]
    index = " ".join(f"[`{name}`](#wb{name.lower()})" for name in names)
    parts = [HEAD, f"{index}, and `wb.{VERSION}`.\n", *map(_entry, names)]
    return "\n".join(parts)


def _entry(name: str) -> str:
    found = getattr(wb, name)
    lines = [f"## `wb.{name}`", ""]
    if inspect.isclass(found):
        if "__init__" in vars(found) and not dataclasses.is_dataclass(found):
            lines += _call(f"wb.{name}", found)
        lines += [*_prose(found), *_fields(found), *_members(found, name)]
    else:
        lines += [*_call(f"wb.{name}", found), *_prose(found)]
    return "\n".join(lines)


def _call(name: str, function: Any, *, bound: bool = False) -> list[str]:
    """How a function is called, with types and defaults."""
    signature = inspect.signature(function)
    if bound:
        own = list(signature.parameters.values())[1:]
        signature = signature.replace(parameters=own)
    return ["```python", *_wrapped(name, signature), "```", ""]


def _wrapped(name: str, signature: inspect.Signature) -> list[str]:
    """A signature on one line, or with one argument a line where it is long."""
    whole = _plain(f"{name}{signature}")
    if len(whole) <= 100:
        return [whole]
    shown, star = [], False
    for each in signature.parameters.values():
        if each.kind is each.KEYWORD_ONLY and not star:
            shown.append("*")
            star = True
        shown.append(_plain(str(each)))
    back = signature.return_annotation
    answer = "" if back is signature.empty else f" -> {_plain(str(back))}"
    return [f"{name}(", *(f"    {each}," for each in shown), f"){answer}"]


def _plain(words: str) -> str:
    """Types as the source writes them, without quotes, and a choice by its name."""
    words = re.sub(r"<(\w+\.\w+): '\w+'>", r"\1", words)
    return re.sub(r"(: |-> |^)'([^']*)'", r"\1\2", words)


def _prose(found: Any) -> list[str]:
    """A docstring; its lists of arguments, returns and errors as lists."""
    lines, listing = [], False
    for line in (inspect.getdoc(found) or "").splitlines():
        head = SECTION.match(line)
        if head:
            listing = True
            lines += [f"{head[1]}:", ""]
        elif listing and re.match(r"^    \S", line):
            name, colon, rest = line.strip().partition(": ")
            named = colon and re.fullmatch(r"[\w, ]+", name)
            lines.append(f"- `{name}`: {rest}" if named else f"- {line.strip()}")
        elif listing and line.startswith("     "):
            lines[-1] += f" {line.strip()}"
        else:
            listing = listing and not line.strip()
            lines.append(line)
    return [*lines, ""]


def _fields(cls: Any) -> list[str]:
    """The fields of a dataclass, with what their source says below them."""
    if not dataclasses.is_dataclass(cls):
        return []
    hints, rows = typing.get_type_hints(cls), []
    for item in dataclasses.fields(cls):
        if item.name.startswith("_"):
            continue
        kind, words = (
            hints[item.name],
            field_docs(cls).get(item.name) or item.metadata.get("hint", ""),
        )
        if isinstance(kind, type) and issubclass(kind, enum.Enum):
            words = " ".join(filter(None, (words, f"{choices(kind)}.")))
        rows.append(f"| `{item.name}` | {_default(item)} | {words} |")
    return ["| field | default | |", "|---|---|---|", *rows, ""] if rows else []


def _default(item: Any) -> str:
    if item.default is dataclasses.MISSING:
        if item.default_factory is dataclasses.MISSING:
            return "needed"
        return f"`{getattr(item.default_factory, '__name__', 'dict')}()`"
    if dataclasses.is_dataclass(item.default):
        return f"`{type(item.default).__name__}()`"
    value = item.default.value if isinstance(item.default, enum.Enum) else item.default
    return f"`{value!r}`"


def _members(cls: Any, name: str) -> Iterator[str]:
    """Public methods and properties of a class's own that say what they do."""
    for member, found in vars(cls).items():
        if member.startswith("_"):
            continue
        title = f"### `{name}.{member}`"
        if isinstance(found, property) and found.__doc__:
            yield from (title, "", *_prose(found))
        elif isinstance(found, staticmethod | classmethod):
            yield from (title, "", *_call(f"wb.{name}.{member}", getattr(cls, member)))
            yield from _prose(found.__func__)
        elif inspect.isfunction(found):
            yield from (title, "", *_call(f".{member}", found, bound=True), *_prose(found))
