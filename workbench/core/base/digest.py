"""Content hash of dataclasses, arrays and scalars: the key of every stored result.

Floats are hashed by their exact bits (`float.hex`), so 0.1 + 0.2 and 0.3 differ; types and field
names take part, so that two dataclasses with equal values do not collide. A field with metadata
`cosmetic` (a name, a colour of the user interface) never changes a key; one with `later`, which
came after results had been stored, only where it is not at its default. Unknown types raise.
"""

from __future__ import annotations

import dataclasses
import enum
import hashlib
from collections.abc import Mapping
from typing import Any, TypeVar, cast

import numpy as np

Fields = TypeVar("Fields")

KEY_LENGTH = 32
"""Hexadecimal digits kept of sha256: 128 bits."""


def digest(value: Any) -> str:
    """Key of a value, stable across processes and machines.

    Raises:
        TypeError: If the value, or anything inside it, is of a type without a canonical form.
    """
    hasher = hashlib.sha256()
    _feed(hasher, value)
    return hasher.hexdigest()[:KEY_LENGTH]


def _feed(hasher: Any, value: Any) -> None:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        hasher.update(f"D{type(value).__name__}(".encode())
        for field in dataclasses.fields(value):
            if field.metadata.get("cosmetic"):
                continue
            held = getattr(value, field.name)
            if field.metadata.get("later") and held == field.default:
                continue
            hasher.update(f"{field.name}=".encode())
            _feed(hasher, held)
        hasher.update(b")")
    elif isinstance(value, np.ndarray):
        array: Any = np.ascontiguousarray(cast("Any", value))
        hasher.update(f"A{array.dtype.str}{array.shape}".encode())
        hasher.update(memoryview(array.reshape(-1).view(np.uint8)))
    elif isinstance(value, enum.Enum):
        hasher.update(f"E{type(value).__name__}.{value.name};".encode())
    elif isinstance(value, (tuple, list)):
        items = cast("tuple[Any, ...]", value)
        hasher.update(f"L{len(items)}".encode())
        for item in items:
            _feed(hasher, item)
    elif isinstance(value, Mapping):
        table = cast("Mapping[str, Any]", value)
        hasher.update(f"M{len(table)}".encode())
        for name in sorted(table):
            _feed(hasher, str(name))
            _feed(hasher, table[name])
    elif isinstance(value, float):
        hasher.update(f"F{float(value).hex()};".encode())
    elif value is None or isinstance(value, (bool, int, str)):
        text = f"{type(value).__name__}{value!r}"
        hasher.update(f"S{len(text)}:{text}".encode())
    else:
        raise TypeError(f"cannot hash {type(value).__name__} into a stage key")


def at_defaults(value: Fields, *names: str) -> Fields:
    """A dataclass with the fields that a stage does not read at their defaults.

    The stage's key then does not hold them, so that changing them cannot re-run it.
    """
    whole = cast("Any", value)
    fields = {item.name: item.default for item in dataclasses.fields(whole)}
    return dataclasses.replace(whole, **{name: fields[name] for name in names})
