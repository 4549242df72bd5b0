"""Which source of forces to trust for a press, from errors that were measured on held-out presses.

The record `held_out_errors.json` ships with the weights: errors of each source by kind of contact,
against finite elements on the mesh of the data set, or against converged limits. A source of which
nothing was measured for the kind of a press is said to be so, and is not advised; nor is a network
that does not know the press in another way than that its object is new. Sources are told to be
nearer only to the same truth.

    field       mean error of the force at a vertex, over that of predicting no force at all
    total       mean error of the total force, over its mean size
    peak bias   mean of the largest pressure over the true one, less 1
"""

from __future__ import annotations

import dataclasses
import enum
import functools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from sim.forces.contact_kind import ContactKind, Touch, Width
from sim.forces.network.weights import SUFFIX
from workbench.core.base.errors import StoreError
from workbench.core.press.fem import DRAFT_MM, QUALITY_MM
from workbench.pipeline import shipped
from workbench.system.record import ROOT, Record

ERRORS = Record(
    path=shipped.FOLDER / "held_out_errors.json",
    command="python -m workbench.learning.evaluation.held_out_errors",
    sources=(
        "workbench.learning.evaluation.held_out_errors",
        "workbench.core.objects.kinds",
        "designs.finger",
    ),
    apart=(
        "workbench.pipeline.advice",
        "workbench.pipeline.stages.press",
        "workbench.pipeline.stages.lattice",
        "workbench.pipeline.store",
        "workbench.pipeline.write_once",
        "workbench.proof.row",
        "workbench.project",
        "workbench.system",
        "workbench.core.design.camera",
        "workbench.core.design.lighting",
        "workbench.core.design.optics",
        "workbench.core.design.photo",
        "sim.optics",
    ),
    files=(
        *sorted(shipped.FOLDER.glob(f"*{SUFFIX}")),
        *sorted((shipped.FOLDER / shipped.HELD_OUT).glob("*.npz")),
        ROOT / "workbench/proof/validation/contact/finger_figures.json",
        ROOT / "workbench/proof/validation/fem/axisymmetric_limits.json",
    ),
)
"""The contact solver's own code is no source: its answers lie in the held-out sets. The last two
files hold the limits of finite elements."""


PLAIN = ("presses", "field", "total", "peak_bias", "against")
"""Fields of a row that are numbers or words."""


class ForceSource(enum.StrEnum):
    """Sources as they are told apart here, in words for people."""

    LEARNED = "learned"
    MPM = "contact solver"
    DRAFT = f"finite elements of {DRAFT_MM:g} mm"
    QUALITY = f"finite elements of {QUALITY_MM:g} mm"


@dataclass(frozen=True, kw_only=True, slots=True)
class Measured:
    """Errors of one source on one kind of contact; None where there is none to be had."""

    source: ForceSource
    kind: ContactKind
    seen: bool | None
    """Whether the objects were among those of the training; None of sources without one."""
    presses: int
    total: float
    field: float | None = None
    peak_bias: float | None = None
    against: str = ""
    """What is taken for the truth."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Asked:
    """A press, as far as errors depend on it."""

    kind: ContactKind | None
    """None where its object or path is of no kind."""
    network: str = ""
    """Name of the weights; empty where there is no network."""
    seen: bool = True
    """Whether the network was trained with such an object."""
    foreign: bool = False
    """Whether the network does not know something else of it."""
    grid_mm: float = 0.0
    """Of the contact solver; 0 of another method than that of the data."""
    solvable: bool = True
    """Whether finite elements take it."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Table:
    """What was measured."""

    rows: tuple[Measured, ...] = ()
    network: str = ""
    """Name of the weights that were scored."""
    grid_mm: float = 0.0
    """Of the contact solver."""
    place: str = ""
    """On what was pressed, for people."""
    stale: bool = False
    """Whether other code or data were measured."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Advice:
    """What is to be said of a press."""

    text: str
    rows: tuple[Measured, ...]
    """What was measured on presses like it."""
    missing: tuple[ForceSource, ...]
    """Sources of which nothing was."""

    def as_json(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "text": self.text,
            "measured": [{"source": row.source.value, **_plain(row)} for row in self.rows],
            "not_measured": [source.value for source in self.missing],
        }


@functools.lru_cache(maxsize=4)
def table(record: Record = ERRORS) -> Table:
    """What is on record, read once; an empty table where there is none."""
    try:
        figures = record.figures()
        return Table(
            rows=tuple(_measured(row) for row in figures["rows"]),
            network=str(figures["network"]),
            grid_mm=float(figures["grid_mm"]),
            place=str(figures["place"]),
            stale=bool(record.stale()),
        )
    except (StoreError, KeyError, TypeError, ValueError):
        return Table()


def advice(asked: Asked, known: Table) -> Advice:
    """Errors of each source on presses like one, and which is the nearest."""
    offered = list(_offered(asked))
    rows = tuple(row for source in offered for row in _rows(source, asked, known))
    missing = tuple(source for source in offered if source not in {row.source for row in rows})
    return Advice(
        text=" ".join(_sentences(asked, rows, missing, known)), rows=rows, missing=missing
    )


def _offered(asked: Asked) -> Iterator[ForceSource]:
    if asked.network:
        yield ForceSource.LEARNED
    yield ForceSource.MPM
    if asked.solvable:
        yield from (ForceSource.DRAFT, ForceSource.QUALITY)


def _rows(source: ForceSource, asked: Asked, known: Table) -> Iterator[Measured]:
    """What was measured of a source on such presses, one row for each truth."""
    learned = source is ForceSource.LEARNED
    if learned and (asked.foreign or asked.network != known.network):
        return
    if source is ForceSource.MPM and asked.grid_mm != known.grid_mm:
        return
    for row in known.rows:
        if row.source is source and row.kind == asked.kind:
            if not learned or row.seen is asked.seen:
                yield row


def _sentences(
    asked: Asked,
    rows: Sequence[Measured],
    missing: Sequence[ForceSource],
    known: Table,
) -> Iterator[str]:
    kind = "objects or paths of this kind" if asked.kind is None else asked.kind.words
    if not rows:
        yield f"Nothing was measured of forces on {kind}."
        return
    yield f"Errors measured on {kind} into {known.place}."
    for truth in dict.fromkeys(row.against for row in rows):
        members = [row for row in rows if row.against == truth]
        yield f"Against {truth}: {'; '.join(map(_words, members))}."
        if len(members) > 1:
            yield _nearest(members)
    if missing:
        yield f"Not measured on such a press: {', '.join(missing)}."
    if known.stale:
        yield "These are errors of an earlier program or network."


def _words(row: Measured) -> str:
    parts = []
    if row.field is not None:
        parts.append(f"force field {100 * row.field:.0f} %")
    parts.append(f"total force {100 * row.total:.2g} %")
    if row.peak_bias is not None:
        parts.append(f"peak pressure {100 * row.peak_bias:+.0f} %")
    new = " of unseen objects" if row.seen is False else ""
    count = f"{row.presses} press{'es' if row.presses > 1 else ''}{new}"
    return f"{row.source.value} {', '.join(parts)} ({count})"


def _nearest(rows: Sequence[Measured]) -> str:
    """The source with the least error of the field and of the total."""
    in_total = min(rows, key=lambda row: row.total).source
    fields = [(row.field, row.source) for row in rows if row.field is not None]
    in_field = min(fields)[1] if fields else in_total
    if in_field is in_total:
        return f"Nearest: {in_total.value}."
    return f"Nearest in the force field: {in_field.value}; in total force: {in_total.value}."


def row_table(row: Measured) -> dict[str, Any]:
    """A row for the record."""
    kind = dataclasses.asdict(row.kind)
    return {"source": row.source.name.lower(), **kind, **_plain(row), "seen": row.seen}


def _plain(row: Measured) -> dict[str, Any]:
    return {name: getattr(row, name) for name in PLAIN}


def _measured(row: dict[str, Any]) -> Measured:
    kind = ContactKind(touch=Touch(row["touch"]), width=Width(row["width"]), sheared=row["sheared"])
    plain = {name: row[name] for name in PLAIN}
    return Measured(source=ForceSource[row["source"].upper()], kind=kind, seen=row["seen"], **plain)
