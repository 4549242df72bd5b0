"""A stage of the chain, a call of it with its inputs, and what it leaves; nothing is computed here.

A stage is one file of `workbench.pipeline.stages`: a dataclass of its inputs, a pure function of
them, and a `STAGE` that says what people and programs ask of it. The key of a result holds the
stage's name, its version and its inputs, in their order: give a stage the part of the design that
it needs, never the whole, and a camera move cannot re-run contact.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

from workbench.core.base.digest import digest
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.pipeline.store import Store

IF_GIVEN = {"if_given": True}
"""Metadata of an input that is in the key only where it is not None: it came later, or is rare."""
PART = {"part": True}
"""Metadata of an input that the stage finds itself (`Stage.parts`): other inputs say which."""


class Chain(Protocol):
    """What a stage takes its inputs from."""

    @property
    def design(self) -> SensorDesign:
        """The sensor."""
        ...

    @property
    def shape(self) -> Any:
        """Its shape with all parameters, a dataclass of its family."""
        ...

    @property
    def case(self) -> PressCase:
        """What is pressed, where, and how it is computed."""
        ...

    def result(self, stage: str) -> Any:
        """A `Ref` to what a stage makes of the same design; None where it makes nothing of it."""
        ...


@dataclass(frozen=True, kw_only=True, slots=True)
class Stage:
    """One step of the chain."""

    name: str
    """That of its file; results lie in the store under it."""
    label: str
    """What people read."""
    version: int
    """Of what it makes: raise it when that changes, and stored results are made anew."""
    place: int
    """Where it stands among the others in lists; what it reads comes before it in any case."""
    lane: str
    """Worker process that runs it: `cad` or `sim`."""
    run: Callable[..., Any]
    """Pure function of the inputs and `monitor`."""
    inputs: Callable[[Chain], Any] | None = None
    """Its inputs for a design and a press, results as `Ref`; None where it has none to do. A stage
    without it belongs to no plan: another divides its work into it, or a list asks for it."""
    parts: Callable[[Any, Store], Mapping[str, Any]] | None = None
    """Calls that the work is divided into, by the input that takes the result: a call, or a tuple
    of calls. Each result is stored: work that was stopped goes on, and others find it."""
    in_run: bool = False
    """Whether a whole run makes it without being asked."""
    on_strip: bool = False
    """Whether the strip at the top of the browser shows it."""
    shown: bool = True
    """Whether the browser shows a stored result without being asked."""
    heavy: bool = False
    """Whether unpacking a result takes so long that it is read in a thread."""

    def call(self, inputs: Any) -> Call:
        """The call of this stage with these inputs."""
        return Call(stage=self.name, version=self.version, inputs=inputs)


@dataclass(frozen=True, kw_only=True, slots=True)
class Ref:
    """A stored result that a later stage reads."""

    stage: str
    key: str


@dataclass(frozen=True, kw_only=True)
class Call:
    """A stage with its inputs; upstream results stand as `Ref`, so keys need no computing."""

    stage: str
    version: int
    inputs: Any
    """Dataclass of the stage's own."""

    @property
    def values(self) -> tuple[Any, ...]:
        """The inputs that are in the key, in their order."""
        return tuple(_keyed(self.inputs))

    @cached_property
    def key(self) -> str:
        """Key of the result in the store; found once, since the browser asks at every event."""
        return digest((self.stage, self.version, self.values))

    @property
    def ref(self) -> Any:
        """The result, as an input of a later stage, whose field has the type of the result."""
        return Ref(stage=self.stage, key=self.key)

    @property
    def reads(self) -> tuple[Ref, ...]:
        """Stored results among the inputs."""
        return tuple(value for value in self.values if isinstance(value, Ref))

    def reading(self, before: Ref, after: Ref) -> Call:
        """The same call with another result in the place of one."""
        held = {field.name: getattr(self.inputs, field.name) for field in _fields(self.inputs)}
        changed = {name: after for name, value in held.items() if value == before}
        return dataclasses.replace(self, inputs=dataclasses.replace(self.inputs, **changed))


@dataclass(frozen=True, kw_only=True, slots=True)
class Outcome:
    """A stage that is done."""

    stage: str
    key: str
    cached: bool
    seconds: float
    """Time spent now [s]; for a cached result the time of the look-up."""


def _fields(inputs: Any) -> Iterator[dataclasses.Field[Any]]:
    return (field for field in dataclasses.fields(inputs) if not field.metadata.get("part"))


def _keyed(inputs: Any) -> Iterator[Any]:
    for field in _fields(inputs):
        value = getattr(inputs, field.name)
        if value is not None or not field.metadata.get("if_given"):
            yield value
