"""Running one call: its parts, its result into the store, what settled of a press that failed."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from workbench.core.base.errors import SolveError, Stopped, StoreError
from workbench.core.base.monitor import Monitor, part, silent
from workbench.pipeline.stage import Call, Outcome, Ref, Stage
from workbench.pipeline.store import Store, timed
from workbench.planning.stage_table import STAGES

PARTIAL = "press_partial"
"""Where the store keeps the settled frames of a press that failed, by the key of that press."""
PARTS_SHARE = 0.95
"""Share of the progress of a divided stage that its parts take."""


def run(store: Store, call: Call, monitor: Monitor = silent) -> Outcome:
    """Compute a call unless its result is stored, and store it.

    Raises:
        WorkbenchError: Whatever the stage raises. The frames that a press settled before it
            failed are then stored as `PARTIAL` under the same key, nothing else is.
    """
    stage = STAGES[call.stage]
    key = call.key
    if store.has(stage.name, key):
        return Outcome(stage=stage.name, key=key, cached=True, seconds=0.0)
    parts = stage.parts(call.inputs, store) if stage.parts else {}
    spent_s = _run_parts(store, _pieces(parts), monitor)
    given = _loaded(store, call.inputs, parts)
    rest = part(monitor, PARTS_SHARE, 1.0) if _pieces(parts) else monitor
    try:
        value, seconds = timed(stage.run, given, monitor=rest)
    except (SolveError, Stopped) as error:
        _keep_partial(store, stage, key, error)
        raise
    store.save(stage.name, key, value, seconds=spent_s + seconds, version=stage.version)
    return Outcome(stage=stage.name, key=key, cached=False, seconds=spent_s + seconds)


def _pieces(parts: Mapping[str, Any]) -> list[Call]:
    return [
        call
        for given in parts.values()
        for call in (given if isinstance(given, tuple) else (given,))
    ]


def _run_parts(store: Store, pieces: list[Call], monitor: Monitor) -> float:
    """Compute the parts of a call; returns the time they took [s]."""
    spent_s = 0.0
    for number, piece in enumerate(pieces):
        span = (PARTS_SHARE * number / len(pieces), PARTS_SHARE * (number + 1) / len(pieces))
        spent_s += run(store, piece, part(monitor, *span)).seconds
    return spent_s


def _loaded(store: Store, inputs: Any, parts: Mapping[str, Any]) -> Any:
    """The inputs with stored results in the place of the calls and references to them."""

    def load(value: Any) -> Any:
        if isinstance(value, tuple) and value and isinstance(value[0], Call):
            return tuple(load(call) for call in value)
        if isinstance(value, (Ref, Call)):
            return store.load(value.stage, value.key)
        return value

    held = {field.name: getattr(inputs, field.name) for field in dataclasses.fields(inputs)}
    return dataclasses.replace(
        inputs, **{name: load(value) for name, value in (held | dict(parts)).items()}
    )


def _keep_partial(store: Store, stage: Stage, key: str, error: SolveError | Stopped) -> None:
    """Store what settled, and leave its key in the error instead, which then is small to send."""
    if error.partial is None:
        return
    spent_s = float(error.partial.frame_seconds.sum())
    try:
        store.save(PARTIAL, key, error.partial, seconds=spent_s, version=stage.version)
    except StoreError as unsaved:
        # Why the press failed is what the designer must read first.
        error.hint = f"{error.hint}; what settled is lost: {unsaved.message}"
    else:
        error.kept = key
    finally:
        error.partial = None
