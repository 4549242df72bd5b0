"""From a design and a press to every result: used by the command line and the browser alike.

`plan` names all calls and keys without computing anything; `evaluate` runs them in order through a
runner (in this process, or in worker lanes) and yields each outcome.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, Protocol

from workbench.core.base.errors import DamagedError
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.design import SensorDesign, check_body
from workbench.core.press.press_case import PressCase
from workbench.pipeline.stage import Call, Outcome
from workbench.pipeline.store import Store
from workbench.planning.running import run
from workbench.planning.stage_table import IN_RUN, STAGES


class Runner(Protocol):
    """Executes calls somewhere."""

    def run(self, call: Call, monitor: Monitor) -> Outcome:
        """Compute the call unless it is stored."""
        ...


class InlineRunner:
    """Runs calls in this process."""

    def __init__(self, store: Store) -> None:
        self.store = store

    def run(self, call: Call, monitor: Monitor) -> Outcome:
        """Compute the call here unless it is stored."""
        return run(self.store, call, monitor)


class StageMonitor(Protocol):
    """Progress of one named stage."""

    def __call__(self, stage: str, fraction: float, note: str) -> None:
        """Report that `fraction` of `stage` is done."""
        ...


@dataclass(frozen=True, kw_only=True, slots=True)
class _Planned:
    """The `Chain` that stages take their inputs from: what one reads is planned before it."""

    design: SensorDesign
    shape: Any
    case: PressCase
    calls: dict[str, Call] = field(default_factory=dict)

    def result(self, stage: str) -> Any:
        """A `Ref` to the result of a stage; None where the design has no such call."""
        if stage not in self.calls:
            self.add(stage)
        return self.calls[stage].ref if stage in self.calls else None

    def add(self, stage: str) -> None:
        """Plan a stage, and before it all that it reads."""
        record = STAGES[stage]
        inputs = None if record.inputs is None else record.inputs(self)
        if inputs is not None:
            self.calls[stage] = record.call(inputs)


def plan(design: SensorDesign, case: PressCase) -> dict[str, Call]:
    """Every call of the chain by stage name, each after those that it reads.

    A stage that has nothing to do for this design and press is left out: without a body of its own
    a design has no `intake`; an object whose signed distance is quickly found needs no `object`;
    where there is no trained network there is no `learned`.

    Raises:
        DesignError: If the family or the silicone is unknown, or the family refuses the shape.
    """
    from designs.family import family, resolve_shape
    from geometry.body.silicones import silicone

    shape = resolve_shape(design.family, design.shape)
    family(design.family).check(shape, design.layers)
    check_body(design)
    silicone(design.casting.silicone)
    chain = _Planned(design=design, shape=shape, case=case)
    for stage in STAGES:
        chain.result(stage)
    return chain.calls


def needed(calls: dict[str, Call], wanted: Iterable[str]) -> list[str]:
    """The wanted stages and all they depend on, in order; those a design has not are left out."""
    todo: set[str] = set()

    def visit(name: str) -> None:
        todo.add(name)
        for read in calls[name].reads:
            if read.stage in calls:
                visit(read.stage)

    for name in wanted:
        if name in calls or name not in STAGES:
            visit(name)
    return [name for name in calls if name in todo]


def evaluate(
    design: SensorDesign,
    case: PressCase,
    runner: Runner,
    *,
    wanted: Iterable[str] = IN_RUN,
    monitor: StageMonitor | None = None,
) -> Iterator[Outcome]:
    """Run the wanted stages and what they need; yield each outcome as it comes.

    A result that turns out to be damaged when a later stage reads it is computed again.

    Raises:
        WorkbenchError: From the first stage that fails; earlier results stay stored.
    """
    calls = plan(design, case)
    names = needed(calls, wanted)
    waiting, healed = list(names), 0
    while waiting:
        try:
            yield runner.run(calls[waiting[0]], stage_monitor(monitor, waiting[0]))
        except DamagedError as error:
            # Each time one is set aside: more often than there are stages is another fault.
            healed += 1
            if healed > len(names):
                raise
            waiting = [name for name in (error.at,) if name in calls] + waiting
        else:
            del waiting[0]


def stage_monitor(monitor: StageMonitor | None, stage: str) -> Monitor:
    """A stage's own monitor that reports under its name."""
    if monitor is None:
        return silent
    return lambda fraction, note="": monitor(stage, fraction, note)


def results(store: Store, calls: dict[str, Call], names: Iterable[str]) -> dict[str, Any]:
    """Stored results by stage name; stages that have not run are left out."""
    return {
        name: store.load(name, calls[name].key)
        for name in names
        if store.has(name, calls[name].key)
    }
