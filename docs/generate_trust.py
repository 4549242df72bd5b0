"""Write `trust.md` from records of `workbench validate`: what was compared with what.

Rows of one name, unit and judge stand on one line, with the one that is nearest to its limit; the
records in `docs/validation` hold every row.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import Any

from docs.trust_record import records
from workbench.proof.benchmarks.records import RoomRecord
from workbench.proof.judge import Judge, judge

ROOMS = {
    "geometry": ("bodies, meshes and moulds against closed forms; 1400 random sensors", "10 min"),
    "parts": ("sets of parts of random sensors, looked at from their files", "an hour"),
    "contact": (
        "the contact solver: bonded layers, friction, balance, invariances",
        "an hour or more",
    ),
    "optics": (
        "lenses, lobes, refraction, photons, every light model, Mitsuba's figures, photographs",
        "20 min",
    ),
    "fem": ("the finite elements, and the contact solver beside them", "5 min"),
    "fem_fine": ("the same on the finest meshes", "10 min more"),
    "fem_calculix": ("our finite elements beside CalculiX; needs `ccx`", "minutes"),
    "forces": ("forces under what cannot change them; learned forces on held-out presses", "5 min"),
    "robustness": ("630 presses, then 500 to see that memory stays flat", "wants a GPU"),
    "robustness_sample": ("40 of these presses", "minutes"),
    "optics_mitsuba": ("the photon tracer beside Mitsuba 3; needs the extra `mitsuba`", "4 min"),
    "published": ("bodies of the presets and heads of objects beside those released", "2 min"),
    "reading": ("touch read from renders, from photons, and from twins, by records", "seconds"),
    "tasks": ("objects, slip and safety told by touch, by records", "seconds"),
    "sensor": ("fast contact beside the contact solver, by a record", "seconds"),
    "search": ("the search beside Sobol, random and TPE on two problems, by a record", "seconds"),
}
"""What each room of `workbench validate` measures, and about how long that takes undisturbed."""
EACH = ("hybrid", "mpm_against_fem", "finger_45")
"""Rows of which every case is shown: what most results rest on."""
MEANING = {
    Judge.EXACT: "an exact answer: a formula, a law, a definition",
    Judge.OUTSIDE: "another program, a publication or a photograph",
    Judge.LIMIT: "what our own values tend to on ever finer meshes",
    Judge.ITSELF: "the product another way: consistent, which need not be right",
    Judge.NONE: "a number that the project set itself: a count, a time, a rate",
}
HEAD = """# How far to trust it

Made by `make docs` from records of `workbench validate ROOM`; measure them on your own
machine by the same command, which exits with 1 if a row is not met. `--record
docs/validation/ROOM.json` keeps a record, where every single row stands.

A record is *stale* once the code that its rows rest on computes otherwise: its figures are then
those of an earlier program. So is one that does not say which code made it. A row is stale where it
rests on such a record, and is not met.

*Null* is what a trivial answer scores there (no friction, no displacement, the background alone):
a row that is no better than its null shows nothing. Rows that are only *stated* have no limit. Of
several rows of one name the one nearest to its limit is shown; where there is none, the first.

Each row says what it is judged by:

"""
GAPS = """## What no row shows

- No image has been compared with a photograph of a contact on a real sensor.
- References of the light models come from the same tracer as the bake, so they show what the
  models lose, not what the tracer leaves out; for that there are figures that Mitsuba recorded
  (`mitsuba_recorded`) and, where it is installed, the room `optics_mitsuba`.
- Images leave out mirror images of skin and LEDs in the wall of the cavity (5 to 17 % of the light,
  which a path tracer and a real sensor show: `mitsuba_recorded_whole`), shadows of a dent on skin
  that did not move (unless `composition = "absolute"`), absorption in the elastomer, polarisation
  and lens flare.
- Defaults that are our choice and not sourced: camera and LED positions, coating reflectances,
  Phong constants.
- Learned forces are judged by our finite elements, not by a force sensor.
- A rate depends on what else ran on the machine; its case says the load.
- Contact is quasi-static: no inertia, no viscosity, no adhesion.

Speed is measured apart, by `workbench bench ROOM`; the paper's frame rates beside ours are on the
page [speed](speed.md).
"""


def page() -> str:
    """The whole page."""
    known = records()
    judges = "".join(f"- **{kind}**: {words}\n" for kind, words in MEANING.items())
    parts = [f"{HEAD}{judges}", GAPS, _missed(known), _rooms(known), *map(_room, known)]
    return "\n".join(parts)


def _missed(known: Sequence[RoomRecord]) -> str:
    """Every row that is beyond its limit, or could not be measured."""
    lines = ["## Not met", "", "Rows of the records that are beyond their limits:", ""]
    for record in known:
        for row in record.rows:
            if not row["ok"]:
                measured, asked = _measured(row, row["unit"]), _asked(row)
                measured = f"stale, {measured}" if row.get("stale") else measured
                line = f"- `{row['name']}` of `{record.room}`: {measured}, asked {asked}"
                lines.append(f"{line}; {row['case']}".replace("|", "\\|"))
    return "\n".join([*lines, ""])


def _rooms(known: Sequence[RoomRecord]) -> str:
    made = {record.room: record for record in known}
    rows = []
    for room, (words, takes) in ROOMS.items():
        state = "not recorded"
        if room in made:
            record = made[room]
            good = sum(row["ok"] for row in record.rows)
            old = ", **stale**" if record.kept.stale() else ""
            state = f"[{good} of {len(record.rows)} rows met](#room-{room}){old}"
        rows.append(f"| `{room}` | {words} | {takes} | {state} |")
    head = ["## Rooms", "", "| room | what it measures | takes | record |", "|---|---|---|---|"]
    return "\n".join([*head, *rows, ""])


def _room(record: RoomRecord) -> str:
    lines = [
        f"## Room `{record.room}`",
        "",
        f"Version {record.version}, {record.made}, {record.device}.",
        *_doubt(record),
        "",
        "| row | judged by | met | nearest to its limit | asked | null | case |",
        "|---|---|---|---|---|---|---|",
    ]
    return "\n".join([*lines, *_lines(record.rows), ""])


def _doubt(record: RoomRecord) -> Iterator[str]:
    """That the rows are those of another program, and what measures them anew."""
    if record.kept.stale():
        command = f"workbench validate {record.room} --record docs/validation/{record.room}.json"
        yield f"**Stale**: not measured with the code of today; measure it anew: `{command}`"


def _lines(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """A line for rows of the same name, judge and unit."""

    def kind(row: Mapping[str, Any]) -> tuple[str, str, str, str]:
        by, alone = judge(row["name"], row["case"]), row["name"] in EACH
        return row["name"], by.value, row["unit"], row["case"] if alone else ""

    order = {key: number for number, key in enumerate(dict.fromkeys(map(kind, rows)))}
    for key, members in groupby(sorted(rows, key=lambda row: order[kind(row)]), key=kind):
        group = list(members)
        worst = max(group, key=_strain)
        met = f"{sum(row['ok'] for row in group)} of {len(group)}"
        old = sum(row.get("stale", False) for row in group)
        met += f", {old} stale" if old else ""
        case = worst["case"].replace("|", "\\|")
        name, by, unit, _ = key
        yield (
            f"| `{name}` | {by} | {met} | {_measured(worst, unit)} | {_asked(worst)} "
            f"| {_number(worst['null'])} | {case} |"
        )


def _strain(row: Mapping[str, Any]) -> float:
    """Share of its limit that a row uses: above 1 it is broken; 0 where nothing is asked."""
    if row["value"] is None:
        return math.inf
    if row["limit"] is None:
        return 0.0
    measured = row["value"] if row["error"] is None else row["error"]
    if row["sense"] == "min":
        return row["limit"] / measured if measured > 0.0 else math.inf
    return measured / row["limit"] if row["limit"] > 0.0 else (math.inf if measured else 0.0)


def _measured(row: Mapping[str, Any], unit: str) -> str:
    """The value, what it is compared with, and how far they are apart."""
    if row["value"] is None:
        return "not measured"
    shown = f"{_number(row['value'])}{'' if unit == '1' else f' {unit}'}"
    if row["reference"] is not None:
        shown += f" for {_number(row['reference'])}"
    if row["error"] is not None:
        shown += f" ({_percent(row, 'error')})"
    return shown


def _asked(row: Mapping[str, Any]) -> str:
    """The limit, or nothing where the row is only stated."""
    if row["limit"] is None:
        return "stated"
    return f"{'at most' if row['sense'] == 'max' else 'at least'} {_percent(row, 'limit')}"


def _percent(row: Mapping[str, Any], field: str) -> str:
    relative = row["error_kind"] == "relative"
    return f"{100 * row[field]:.2g} %" if relative else _number(row[field])


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"
