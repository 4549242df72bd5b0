"""Sensor families: what one must offer, which ones there are, and reading their parameters.

A family is one module in `designs/` that defines `FAMILY`. Nothing else needs to be told: the
registry walks the package. The module docstring is the family's page of the manual.

The parameters of a family are the fields of its shape dataclass. Each field's metadata gives the
slider: `min`, `max`, `step`, `unit`, `label`, `hint` and, where a number comes from, `source`.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

from designs.bodies import Bodies, Fields
from designs.sequence import Sequence
from workbench.core.base.errors import DesignError, shown
from workbench.core.base.records import records
from workbench.core.design.design import Layers


@runtime_checkable
class Family(Protocol):
    """A parametric sensor shape."""

    name: str
    """Name in design files, for example `finger`."""
    title: str
    """Name for people."""
    shape_type: type
    """Frozen dataclass of the family's own parameters."""

    def check(self, shape: Any, layers: Layers) -> None:
        """Raise DesignError if the parameters contradict each other; takes microseconds."""
        ...

    def target(self, shape: Any, layers: Layers) -> tuple[float, float, float]:
        """Point near the skin where a first press makes sense [mm]."""
        ...

    def build(self, shape: Any, layers: Layers) -> Bodies:
        """Build the B-rep bodies.

        Raises:
            GeometryError: If the CAD kernel returned something else than asked for.
        """
        ...

    def soften(self, shape: Any) -> Any | None:
        """The shape with smaller fillets, tried once when `build` fails; None if it has none."""
        ...

    def fields(self, shape: Any, layers: Layers) -> Fields:
        """The same sensor as signed distance fields, for when the CAD kernel fails."""
        ...


@runtime_checkable
class Actuated(Protocol):
    """What a family with driven parts offers beyond `Family`."""

    def sequences(self, shape: Any, layers: Layers) -> Mapping[str, Sequence]:
        """What the parts do with an object, by name."""
        ...


@runtime_checkable
class Faced(Protocol):
    """What a family offers whose face is not where most have theirs, at +Y."""

    eye: tuple[float, float, float]
    """Direction from the body to the eye that sees its face."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Slider:
    """One parameter as a user interface shows it."""

    name: str
    label: str
    unit: str
    default: float
    minimum: float
    maximum: float
    step: float
    hint: str
    source: str


def families() -> dict[str, Family]:
    """All families by name."""
    return dict(_registry())


def family(name: str) -> Family:
    """The family of that name.

    Raises:
        DesignError: If there is none; the hint lists those there are.
    """
    known = _registry()
    if name not in known:
        raise DesignError(
            f"there is no sensor family {shown(name)}",
            hint=f"known families: {', '.join(sorted(known))}",
            at="family",
        )
    return known[name]


def sequences(name: str, shape: Any, layers: Layers) -> dict[str, Sequence]:
    """The sequences of a family by name; none where nothing is driven."""
    chosen = family(name)
    return dict(chosen.sequences(shape, layers)) if isinstance(chosen, Actuated) else {}


def eye(name: str) -> tuple[float, float, float] | None:
    """Direction from the body of a family to the eye; None where the drawing's own is good."""
    chosen = family(name)
    return chosen.eye if isinstance(chosen, Faced) else None


def sliders(name: str) -> list[Slider]:
    """The parameters of a family in their order of declaration."""
    return [_slider(field) for field in dataclasses.fields(family(name).shape_type)]


def resolve_shape(name: str, values: Mapping[str, Any]) -> Any:
    """The family's shape dataclass with these values; defaults for those not given.

    Raises:
        DesignError: For an unknown name, a value that is no number, or one out of its range.
    """
    shape_type = family(name).shape_type
    fields = {field.name: field for field in dataclasses.fields(shape_type)}
    for key in values:
        if key not in fields:
            raise DesignError(
                f"the {name} has no parameter {shown(key)}",
                hint=f"parameters of the {name}: {', '.join(fields)}",
                at=f"shape.{key}",
            )
    return shape_type(**{key: _number(fields[key], value) for key, value in values.items()})


def _registry() -> dict[str, Family]:
    return {found.name: found for found in records("designs", "FAMILY").values()}


def _slider(field: dataclasses.Field[Any]) -> Slider:
    about = field.metadata
    return Slider(
        name=field.name,
        label=about["label"],
        unit=about["unit"],
        default=float(field.default),  # pyright: ignore[reportArgumentType]
        minimum=float(about["min"]),
        maximum=float(about["max"]),
        step=float(about["step"]),
        hint=about["hint"],
        source=about.get("source", ""),
    )


def _number(field: dataclasses.Field[Any], value: Any) -> float:
    slider = _slider(field)
    unit = f" {slider.unit}" if slider.unit else ""
    span = f"{slider.minimum:g} to {slider.maximum:g}{unit}"
    at = f"shape.{slider.name}"
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not number or not math.isfinite(value):
        raise DesignError(
            f"{slider.label} is {shown(value)}, which is not a finite number",
            hint=f"choose a value from {span}",
            at=at,
        )
    if not slider.minimum <= value <= slider.maximum:
        raise DesignError(
            f"{slider.label} {value:g}{unit} is outside {span}",
            hint=f"choose a value from {span}; {slider.hint.lower()}",
            at=at,
        )
    return float(value)
