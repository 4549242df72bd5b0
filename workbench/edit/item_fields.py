"""Fields of a design's numbered items, for example `optics.lamps[2].power`, counted from 1.

A dotted path reaches dataclasses and mappings by `replace` of the design; lamps and further
cameras are tuples of dataclasses, of which an edit makes a new tuple. Messages of an item do not
know its number: here it is put into their field.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import name_item, suggest
from workbench.core.design.design import SensorDesign
from workbench.edit.led_table import with_count

COUNT = "optics.ring.count"
ITEM = re.compile(r"([\w.]+)\[(\d+)\](?:\.([\w.]+))?")


def read_field(state: Any, path: str) -> Any:
    """Value of a dotted path through dataclasses, mappings and numbered items."""
    value = state
    for step in path.split("."):
        name, _, number = step.partition("[")
        value = value[name] if isinstance(value, Mapping) else getattr(value, name)
        if number:
            value = value[int(number.removesuffix("]")) - 1]
    return value


def with_field(design: SensorDesign, path: str, value: Any) -> SensorDesign:
    """A copy with one field changed, which may be one of a numbered item, or a whole item.

    Raises:
        DesignError: If there is no such field or item, or the value is refused.
    """
    if path == COUNT:
        # The factors on single LEDs follow the number of LEDs.
        return design.replace("optics.ring", with_count(design.optics.ring, value))
    found = ITEM.fullmatch(path)
    if found is None:
        return design.replace(path, value)
    owner, number, rest = found[1], int(found[2]), found[3]
    items = read_field(design, owner)
    if not 1 <= number <= len(items):
        raise DesignError(
            f"{owner} has {len(items)} items, so there is no {shown(path)}",
            hint="add one first",
            at=owner,
        )
    if rest:
        try:
            value = _replaced(items[number - 1], rest.split("."), value, f"{owner}[{number}]")
        except DesignError as error:
            name_item(error, owner, number)
            raise
    return design.replace(owner, (*items[: number - 1], value, *items[number:]))


def _replaced(item: Any, steps: list[str], value: Any, at: str) -> Any:
    head, *rest = steps
    names: list[str] = [*getattr(item, "__dataclass_fields__", ())]
    where = f"{at}.{head}"
    if head not in names:
        raise DesignError(f"there is no field {shown(where)}", hint=suggest(head, names), at=where)
    inner = _replaced(getattr(item, head), rest, value, where) if rest else value
    return dataclasses.replace(item, **{head: inner})


def without_item(items: tuple[Any, ...], number: int) -> tuple[Any, ...]:
    """The items but that of a number, counted from 1."""
    return (*items[: number - 1], *items[number:])
