"""A stage, a call of it with its inputs, and what it leaves: names only, nothing is computed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from workbench.core.digest import digest
from workbench.store import Store


@dataclass(frozen=True, kw_only=True, slots=True)
class Stage:
    """One step of the chain."""

    name: str
    version: int
    lane: str
    """Worker process that runs it: `cad` or `sim`."""
    function: Callable[..., Any]
    parts: Callable[[Store, tuple[Any, ...]], Sequence[Call]] | None = None
    """Calls that the work is divided into, from its inputs. Each result is stored, so that work
    which was stopped goes on where it was, and others find it; the results follow the inputs."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Ref:
    """A stored result that a later stage reads."""

    stage: str
    key: str


@dataclass(frozen=True, slots=True)
class Call:
    """A stage with its inputs; upstream results stand as `Ref`, so keys need no computing."""

    stage: str
    inputs: tuple[Any, ...]

    @property
    def key(self) -> str:
        """Key of the result in the store."""
        # The table of stages names functions that make calls themselves.
        from workbench.stages import STAGES

        return digest((self.stage, STAGES[self.stage].version, self.inputs))

    @property
    def ref(self) -> Ref:
        """The result, as an input of a later stage."""
        return Ref(stage=self.stage, key=self.key)


@dataclass(frozen=True, kw_only=True, slots=True)
class Outcome:
    """A stage that is done."""

    stage: str
    key: str
    cached: bool
    seconds: float
    """Time spent now [s]; for a cached result the time of the look-up."""
