"""Dataclasses to arrays plus a JSON tree, and back: how results are stored and sent.

Arrays leave the tree and are named by their path (`membrane.points_mm`), so that a store can keep
each in its own file and map it without reading. Only dataclasses of `workbench.core` are rebuilt.
"""

from __future__ import annotations

import dataclasses
import enum
import importlib
from collections.abc import Mapping
from typing import Any, cast

import numpy as np

_MODULES = (
    "workbench.core.result.results",
    "workbench.core.result.quality",
    "workbench.core.result.sensing",
    "workbench.core.result.light",
    "workbench.core.result.maps",
    "workbench.core.result.fabrication",
    "workbench.core.design.imported",
    "workbench.core.design.design",
    "workbench.core.design.camera",
    "workbench.core.design.lighting",
    "workbench.core.design.optics",
    "workbench.core.design.photo",
    "workbench.core.press.press",
    "workbench.core.design.inclusion",
    "workbench.core.press.indenter",
    "workbench.core.press.texture",
    "workbench.core.press.actuation",
    "workbench.core.press.motion",
    "workbench.core.press.trajectory",
    "workbench.core.result.sampled",
    "workbench.core.press.fem",
    "workbench.core.result.force_field",
    "workbench.core.result.condensed",
)

Arrays = dict[str, np.ndarray]


def pack(value: Any) -> tuple[Arrays, Any]:
    """Split a value into named arrays and a tree that `json.dumps` accepts."""
    arrays: Arrays = {}
    return arrays, _pack(value, "value", arrays)


def unpack(arrays: Mapping[str, np.ndarray], tree: Any) -> Any:
    """Inverse of `pack`.

    Raises:
        KeyError: If an array that the tree names is missing.
        TypeError: If the tree names an unknown class.
    """
    if isinstance(tree, list):
        return tuple(unpack(arrays, item) for item in cast("list[Any]", tree))
    if not isinstance(tree, dict):
        return tree
    node = cast("dict[str, Any]", tree)
    if "array" in node:
        return arrays[node["array"]]
    if "map" in node:
        return {name: unpack(arrays, item) for name, item in node["map"].items()}
    cls = _class(node["class"])
    if "enum" in node:
        return cls[node["enum"]]
    return cls(**{name: unpack(arrays, item) for name, item in node["fields"].items()})


def _pack(value: Any, path: str, arrays: Arrays) -> Any:
    if isinstance(value, np.ndarray):
        arrays[path] = value
        return {"array": path}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = {
            f.name: _pack(getattr(value, f.name), f"{path}.{f.name}", arrays)
            for f in dataclasses.fields(value)
        }
        return {"class": type(value).__name__, "fields": fields}
    if isinstance(value, enum.Enum):
        return {"class": type(value).__name__, "enum": value.name}
    if isinstance(value, (tuple, list)):
        items = cast("tuple[Any, ...]", value)
        return [_pack(item, f"{path}.{i}", arrays) for i, item in enumerate(items)]
    if isinstance(value, Mapping):
        mapping = cast("Mapping[str, Any]", value)
        # A store makes each array a file, so a slash in a name must not become a folder.
        return {
            "map": {
                name: _pack(item, f"{path}.{name.replace('/', '%2F')}", arrays)
                for name, item in mapping.items()
            }
        }
    if isinstance(value, np.generic):
        return cast("Any", value).item()
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise TypeError(f"cannot store {type(value).__name__} at {path}")


def _class(name: str) -> Any:
    for module in _MODULES:
        found = getattr(importlib.import_module(module), name, None)
        if found is not None:
            return found
    raise TypeError(f"unknown class {name!r} in a stored result")
