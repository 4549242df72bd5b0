"""`workbench validate`: each room's numbers beside closed forms, limits and nulls.

Every row is measured when it is asked for; a measurement that fails is a row that is not ok.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path

from workbench.core.base.errors import DesignError, shown
from workbench.proof.row import Row
from workbench.proof.validation.contact import robustness
from workbench.proof.validation.contact import room as contact
from workbench.proof.validation.fem import calculix
from workbench.proof.validation.fem import room as fem
from workbench.proof.validation.geometry import part_sets
from workbench.proof.validation.geometry import room as geometry
from workbench.proof.validation.learned import forces
from workbench.proof.validation.optics import mitsuba_witness
from workbench.proof.validation.optics import room as optics
from workbench.proof.validation.published import room as published
from workbench.proof.validation.reading import room as reading
from workbench.proof.validation.search import room as search
from workbench.proof.validation.sensor import room as sensor
from workbench.proof.validation.tasks import room as tasks

ROOMS: dict[str, Callable[[], list[Row]]] = {
    "geometry": geometry.rows,
    "parts": part_sets.rows,
    "contact": contact.rows,
    "optics": optics.rows,
    "fem": fem.rows,
    "fem_fine": fem.fine_rows,
    "fem_calculix": calculix.rows,
    "forces": forces.rows,
    "robustness": robustness.rows,
    "robustness_sample": robustness.sample_rows,
    "optics_mitsuba": mitsuba_witness.rows,
    "published": published.rows,
    "reading": reading.rows,
    "tasks": tasks.rows,
    "sensor": sensor.rows,
    "search": search.rows,
}

REFERENCES = (("optics", "mitsuba"), ("fem", "calculix"))
"""Rooms and the independent programs that they are compared with; each pair is a room too."""


def room_of(room: str, reference: str) -> str:
    """The room that compares a room with an independent program.

    Raises:
        DesignError: If there is none, naming those there are.
    """
    if (room, reference) in REFERENCES:
        return f"{room}_{reference}"
    known = ", ".join(f"{room} has {name}" for room, name in REFERENCES)
    raise DesignError(
        f"the room {shown(room)} has no reference {shown(reference)}",
        hint=f"of the rooms {known}",
        at="--reference",
    )


def with_data(room: str, data: Path) -> dict[str, Callable[[], list[Row]]]:
    """The rooms, one of which measures on a data set of the user's instead of what ships.

    Raises:
        DesignError: If the room measures on none.
    """
    if room != "forces":
        raise DesignError(
            f"the room {shown(room)} measures on no data set",
            hint="use --data with forces",
            at="--data",
        )
    return {**ROOMS, room: functools.partial(forces.rows, data)}
