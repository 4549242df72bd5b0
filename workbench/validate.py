"""`workbench validate`: each room's numbers beside closed forms, limits and nulls.

Every row is measured when it is asked for; a measurement that fails is a row that is not ok.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path

from workbench.core.errors import DesignError
from workbench.rows import Row
from workbench.validation import (
    contact,
    fem,
    forces,
    geometry,
    mitsuba_witness,
    optics,
    robustness,
)

ROOMS: dict[str, Callable[[], list[Row]]] = {
    "geometry": geometry.rows,
    "contact": contact.rows,
    "optics": optics.rows,
    "fem": fem.rows,
    "fem_fine": fem.fine_rows,
    "forces": forces.rows,
    "robustness": robustness.rows,
    "robustness_sample": robustness.sample_rows,
    "optics_mitsuba": mitsuba_witness.rows,
}


def room_of(room: str, reference: str) -> str:
    """The room that compares a room with an independent program.

    Raises:
        DesignError: If there is none, naming those there are.
    """
    found = f"{room}_{reference}"
    if found in ROOMS:
        return found
    known = sorted(name.removeprefix("optics_") for name in ROOMS if name.startswith("optics_"))
    raise DesignError(
        f"the room {room!r} has no reference {reference!r}",
        hint=f"the room optics has {', '.join(known)}",
        at="--reference",
    )


def with_data(room: str, data: Path) -> dict[str, Callable[[], list[Row]]]:
    """The rooms, one of which measures on a data set of the user's instead of what ships.

    Raises:
        DesignError: If the room measures on none.
    """
    if room != "forces":
        raise DesignError(
            f"the room {room!r} measures on no data set", hint="use --data with forces", at="--data"
        )
    return {**ROOMS, room: functools.partial(forces.rows, data)}
