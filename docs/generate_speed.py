"""Write `speed.md` from records of `workbench bench efficiency`: the paper's rates beside ours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from workbench.proof.benchmarks.paces import ALL, GPU
from workbench.proof.benchmarks.records import RoomRecord, shipped_records

HEAD = f"""# How fast it is

Made by `make docs` from records of `workbench bench efficiency`, which ship with the program in
`workbench/proof/benchmarks/records`. Measure your own machine by the same command; `--record FILE`
keeps the rows with its name and the date.

The paper reports nine frame rates, on an {GPU}. A frame of its deformation is one substep of
the released code; a press takes hundreds of them until forces balance, so settled presses stand
beside the substeps: 1 mm deep, the whole finger, one after the other. Images are of a travelling
dent by looked-up light. The network is the published one, in the fastest type of the device, its
maps at hand; learned forces are of a network as large as the one that ships, which looks at the
surroundings of the contact, found anew in each frame.

*Load* is the number of processes that wanted to run: above the number of cores, a rate is too low.
That of a network is then far too low: its two threads wait for each other at every product. Alone
on one of two cores that were as busy, 1,000, 5,000 and 25,000 points took 20, 54 and 250 ms of it.
A record is *stale* once the code that its rows rest on computes otherwise.
"""


def page() -> str:
    """The whole page."""
    known = shipped_records()
    heads = [f"paper: {GPU}", *(_title(record) for record in known)]
    lines = [
        "| what | a frame is | " + " | ".join(f"{head} [1/s]" for head in heads) + " |",
        "|---|---|" + "---|" * len(heads),
        *_lines(known),
        "",
        "How each was measured:",
        "",
        *_cases(known),
    ]
    return "\n".join([HEAD, *lines, ""])


def _title(record: RoomRecord) -> str:
    return f"{record.title}, **stale**" if record.kept.stale() else record.title


def _lines(known: Sequence[RoomRecord]) -> Iterator[str]:
    for pace in ALL:
        values = [pace.fps, *(record.value(pace.row) for record in known)]
        cells = " | ".join("" if value is None else _number(value) for value in values)
        yield f"| {pace.what}, {pace.size} | {pace.meaning} | {cells} |"


def _cases(known: Sequence[RoomRecord]) -> Iterator[str]:
    for record in known:
        yield f"- {record.title}, version {record.version}:"
        yield from (f"  - `{row['name']}`: {row['case']}" for row in record.rows)


def _number(value: float) -> str:
    return f"{value:.3g}" if value < 1000 else f"{value:,.0f}"
