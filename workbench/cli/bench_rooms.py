"""`workbench bench`: how long the parts take here, beside the promises made to the designer.

Each time is the median of five runs after a warm-up, unless the case says `cold`. Machines differ:
the limits are those of two CPU cores without a GPU.
"""

from __future__ import annotations

from collections.abc import Callable

from workbench.proof.benchmarks import (
    browser,
    contact,
    efficiency,
    forces,
    geometry,
    optics,
    pipeline,
    reading,
    sensor,
    stages,
)
from workbench.proof.row import Row, gathered

PARTS: dict[str, Callable[[], list[Row]]] = {
    "geometry": geometry.rows,
    "contact": contact.rows,
    "optics": optics.rows,
    "forces": forces.rows,
    "pipeline": pipeline.rows,
    "browser": browser.rows,
}


def everything() -> list[Row]:
    """The rows of all rooms."""
    return [row for room, rows in PARTS.items() for row in gathered(room, rows)]


ROOMS = {
    **PARTS,
    "efficiency": efficiency.rows,
    "reading": reading.rows,
    "sensor": sensor.rows,
    "stages": stages.rows,
    "all": everything,
}
"""`efficiency` measures what others do again, in the paper's sizes, `reading` bakes a design's
light first, `sensor` needs a design that was condensed, and `stages` a cluster and many minutes, so
`all` leaves them out."""
