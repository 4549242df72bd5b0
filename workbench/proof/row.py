"""Rows of the validation and benchmark tables, and how they are judged and printed."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any, TypedDict, Unpack, overload

from workbench.core.base.errors import WorkbenchError
from workbench.system.record import Record


@dataclass(frozen=True, kw_only=True, slots=True)
class Row:
    """One measured number beside what it is compared with; what does not apply is None."""

    name: str
    case: str
    value: float | None
    unit: str
    reference: float | None = None
    null: float | None = None
    """What the trivial method scores."""
    ceiling: float | None = None
    """The best score that the reference itself allows."""
    error: float | None = None
    error_kind: str | None = None
    """`relative` or `absolute`."""
    limit: float | None = None
    """Bound on the error where there is one, else on the value."""
    sense: str | None = None
    """`max`: at most the limit is good; `min`: at least."""
    ok: bool = False
    against: str | None = None
    """What the row is judged by, `itself` for the product another way: see `proof.judge`."""
    stale: bool = False
    """Whether it rests on a record that other code made: never ok then."""


Measurement = float | Callable[[], float]
"""A number, or a function that finds it; one that raises a WorkbenchError makes a failed row."""


class Bounds(TypedDict, total=False):
    """What a score may be seen between."""

    null: Measurement | None
    ceiling: float | None
    record: Record | None
    """On which the row rests, for its reference or for its value; a stale one fails the row."""


class Scale(Bounds, total=False):
    """The same, and how an error is meant."""

    relative: bool
    """To the reference, which is the default; else in the unit of the value."""


def compared(
    name: str,
    case: str,
    value: Measurement,
    reference: Measurement,
    *,
    unit: str,
    limit: float,
    **scale: Unpack[Scale],
) -> Row:
    """A value beside its reference; passes when the error is at most `limit`."""
    try:
        value, reference = _measure(value), _measure(reference)
        null = _measure(scale.get("null"))
    except WorkbenchError as problem:
        return failed(name, case, unit=unit, why=problem.message)
    relative = scale.get("relative", True)
    error = abs(value - reference) / (abs(reference) if relative else 1.0)
    return _vouched(
        scale.get("record"),
        Row(
            name=name,
            case=case,
            value=value,
            unit=unit,
            reference=reference,
            null=null,
            ceiling=scale.get("ceiling"),
            error=error,
            error_kind="relative" if relative else "absolute",
            limit=limit,
            sense="max",
            ok=math.isfinite(error) and error <= limit,
        ),
    )


def bounded(
    name: str,
    case: str,
    value: Measurement,
    *,
    unit: str,
    limit: float,
    sense: str = "max",
    **bounds: Unpack[Bounds],
) -> Row:
    """A value that must stay on one side of a limit."""
    try:
        value, null = _measure(value), _measure(bounds.get("null"))
    except WorkbenchError as problem:
        return failed(name, case, unit=unit, why=problem.message)
    good = value <= limit if sense == "max" else value >= limit
    return _vouched(
        bounds.get("record"),
        Row(
            name=name,
            case=case,
            value=value,
            unit=unit,
            null=null,
            ceiling=bounds.get("ceiling"),
            limit=limit,
            sense=sense,
            ok=math.isfinite(value) and good,
        ),
    )


def stated(
    name: str,
    case: str,
    value: Measurement,
    *,
    unit: str,
    reference: float | None = None,
    **bounds: Unpack[Bounds],
) -> Row:
    """A value that nothing is asked of, for comparison; ok when there is one."""
    try:
        value, null = _measure(value), _measure(bounds.get("null"))
    except WorkbenchError as problem:
        return failed(name, case, unit=unit, why=problem.message)
    return _vouched(
        bounds.get("record"),
        Row(
            name=name,
            case=case,
            value=value,
            unit=unit,
            reference=reference,
            null=null,
            ceiling=bounds.get("ceiling"),
            ok=math.isfinite(value),
        ),
    )


@overload
def _measure(value: Measurement) -> float: ...
@overload
def _measure(value: Measurement | None) -> float | None: ...
def _measure(value: Measurement | None) -> float | None:
    found = value() if callable(value) else value
    # NumPy's numbers make verdicts that JSON cannot hold.
    return None if found is None else float(found)


def failed(name: str, case: str, *, unit: str = "", why: str = "") -> Row:
    """A row whose measurement could not be made: never ok."""
    return _told(
        Row(name=name, case=f"{case}; not measured: {why}" if why else case, value=None, unit=unit)
    )


_LISTENER: ContextVar[Callable[[Row], None] | None] = ContextVar("listener", default=None)


@contextlib.contextmanager
def listening(listener: Callable[[Row], None]) -> Iterator[None]:
    """Call `listener` with each row as soon as it is measured; a room may take minutes."""
    token = _LISTENER.set(listener)
    try:
        yield
    finally:
        _LISTENER.reset(token)


def _vouched(record: Record | None, row: Row) -> Row:
    """The row as it is, or not ok where the record that it rests on is stale."""
    why = "" if record is None else record.stale()
    if why:
        row = dataclasses.replace(row, case=f"{row.case}; {why}", ok=False, stale=True)
    return _told(row)


def _told(row: Row) -> Row:
    listener = _LISTENER.get()
    if listener is not None:
        listener(row)
    return row


def gathered(room: str, rows: Callable[[], Sequence[Row]]) -> Sequence[Row]:
    """The rows of a room, or one failed row where the room could not even begin."""
    try:
        return rows()
    except WorkbenchError as error:
        return [failed(room, "the whole room", why=error.message)]


def as_json(rows: Sequence[Row]) -> str:
    """The rows as a JSON list; numbers that are not finite become null.

    Raises:
        ValueError: If two rows have the same name and case; who reads them could not tell.
    """
    _expect_unique(rows)
    return json.dumps([_plain(dataclasses.asdict(row)) for row in rows], indent=1)


def _expect_unique(rows: Sequence[Row]) -> None:
    counts = Counter((row.name, row.case) for row in rows)
    twice = [row for row, count in counts.items() if count > 1]
    if twice:
        raise ValueError(f"rows with the same name and case: {twice}")


def _plain(row: dict[str, Any]) -> dict[str, Any]:
    return {k: None if isinstance(v, float) and not math.isfinite(v) else v for k, v in row.items()}


def as_text(rows: Sequence[Row]) -> str:
    """The rows as a table for people.

    Raises:
        ValueError: If two rows have the same name and case.
    """
    _expect_unique(rows)
    head = ("", "row", "against", "case", "value", "unit", "reference", "null", "error", "limit")
    body = [
        (
            "ok" if row.ok else "STALE" if row.stale else "FAIL",
            row.name,
            row.against or "-",
            row.case,
            _number(row.value),
            row.unit,
            _number(row.reference),
            _number(row.null),
            _error(row),
            _limit(row),
        )
        for row in rows
    ]
    widths = [max(len(line[i]) for line in (head, *body)) for i in range(len(head))]
    lines = [
        "  ".join(t.ljust(w) for t, w in zip(line, widths, strict=True)) for line in (head, *body)
    ]
    return "\n".join(line.rstrip() for line in lines)


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"


def _error(row: Row) -> str:
    if row.error is None:
        return "-"
    return f"{100 * row.error:.2f} %" if row.error_kind == "relative" else f"{row.error:.4g}"


def _limit(row: Row) -> str:
    if row.limit is None:
        return "-"
    sign = "<=" if row.sense == "max" else ">="
    number = f"{100 * row.limit:g} %" if row.error_kind == "relative" else f"{row.limit:g}"
    return f"{sign} {number}"
