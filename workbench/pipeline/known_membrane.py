"""How the membrane of a design differs from those that weights were trained on, by the designs.

Wall, shape and a body from a file decide how a skin gives way; the mesh of the outer skin alone
would not tell of another wall. All else of a design leaves the membrane as it is.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from typing import Any

from designs.family import resolve_shape
from sim.forces.acquaintance import membranes_of
from workbench.core.base.errors import WorkbenchError
from workbench.core.base.mapping import from_table, to_table
from workbench.core.base.units import split_unit
from workbench.core.design.design import Layers, SensorDesign

MOST = 3
"""Differences that are named; what is more is counted."""


def membrane_differences(card: Mapping[str, Any], design: SensorDesign) -> tuple[str, ...] | None:
    """What differs from the membrane that is most alike, in words; none of a membrane it knows.

    None where the data card has no design to compare with.
    """
    trained = [one["design"] for one in membranes_of(card) if one.get("design")]
    if not trained:
        return None
    families = list(dict.fromkeys(str(one.get("family")) for one in trained))
    alike = [one for one in trained if one.get("family") == design.family]
    if not alike:
        return (f"the sensor is a {design.family}, trained on a {' and a '.join(families)}",)
    return min((_differences(one, design) for one in alike), key=len)


def _differences(trained: Mapping[str, Any], design: SensorDesign) -> tuple[str, ...]:
    """From one design of the same family."""
    try:
        then = _numbers(design.family, trained.get("shape", {}), trained.get("layers", {}))
    except WorkbenchError:
        return ("the sensor was trained on with parameters that this version does not have",)
    now = _numbers(design.family, design.shape, to_table(design.layers))
    found = list(_differing(now, then))
    if _body(design) != dict(trained.get("body", {})):
        found.append("the body comes from another file, or its faces are labelled otherwise")
    if len(found) > MOST:
        found[MOST:] = [f"{len(found) - MOST} more parameters of the membrane differ"]
    return tuple(found)


def _numbers(family: str, shape: Any, layers: Any) -> dict[str, Any]:
    """Parameters of the membrane by name, defaults filled in."""
    resolved = resolve_shape(family, shape)
    parts = (resolved, from_table(Layers, layers, at="layers"))
    return {f.name: getattr(part, f.name) for part in parts for f in dataclasses.fields(part)}


def _differing(now: Mapping[str, Any], then: Mapping[str, Any]) -> Iterator[str]:
    for name, value in now.items():
        if value != then[name]:
            label, unit = split_unit(name)
            yield f"{label} is {_text(value, unit)}, trained with {_text(then[name], unit)}"


def _text(value: Any, unit: str) -> str:
    number = f"{value:g}" if isinstance(value, (int, float)) else str(value)
    return f"{number} {unit}".strip()


def _body(design: SensorDesign) -> dict[str, Any]:
    from workbench.core.design.imported import body_table

    return {} if design.body is None else dict(body_table(design.body))
