"""The same task learned from the user's photographs themselves, where there are enough.

It says what the photographs allow: a network of renders that comes near it has lost little on the
way to the real sensor. Held out are whole places.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from workbench.core.base.monitor import Monitor
from workbench.tasks.examples import Examples
from workbench.tasks.lessons import Lessons
from workbench.tasks.outcome import Trial
from workbench.tasks.splits import FEWEST_PLACES

FEWEST_PHOTOS = 100
"""From which on networks learn from photographs: fewer teach them nothing but these."""


def on_photos(lessons: Lessons, seen: Examples, monitor: Monitor) -> dict[str, Any]:
    """Scores of networks that learned from photographs, by place; else why there are none.

    Args:
        lessons: Those of the renders.
        seen: The photographs.
        monitor: Progress and cancellation.
    """
    places = len(np.unique(seen.places))
    if len(seen) < FEWEST_PHOTOS or places < FEWEST_PLACES:
        return {
            "why_not": f"{len(seen)} photographs at {places} named places; {FEWEST_PHOTOS} at "
            f"{FEWEST_PLACES} or more would be learned from"
        }
    folder = lessons.trainer.folder / "photos"
    trainer = dataclasses.replace(lessons.trainer, folder=folder)
    own = dataclasses.replace(lessons, trainer=trainer, found=seen)
    told = own.on_renders(Trial.PLACE, own.learned(Trial.PLACE, monitor))
    return {
        "split": "by place",
        "scores": [
            {"metric": row.metric, "value": row.value, "spread": row.spread, "null": row.null}
            for row in told.rows
        ],
        **told.details,
    }
