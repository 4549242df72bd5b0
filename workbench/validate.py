"""`workbench validate`: each room's numbers beside closed forms, limits and nulls.

Every row is measured when it is asked for; a measurement that fails is a row that is not ok.
"""

from __future__ import annotations

from collections.abc import Callable

from workbench.rows import Row
from workbench.validation import contact, fem, forces, geometry, optics, robustness

ROOMS: dict[str, Callable[[], list[Row]]] = {
    "geometry": geometry.rows,
    "contact": contact.rows,
    "optics": optics.rows,
    "fem": fem.rows,
    "forces": forces.rows,
    "robustness": robustness.rows,
    "robustness_sample": robustness.sample_rows,
}
