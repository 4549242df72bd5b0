"""Whether a camera sees the skin at rest."""

from __future__ import annotations

import numpy as np

from sim.optics.maps.judging import mean_percent
from sim.optics.maps.map_kind import MapKind, Scene


def measure(scene: Scene) -> np.ndarray:
    """1 where it does."""
    return scene.look.visible


MAP = MapKind(
    place=1,
    label="Seen by a camera",
    unit="1",
    meaning="1 where a camera sees the skin at rest; the rest is blind.",
    measure=measure,
    more_is_better=True,
    score=mean_percent,
    figure="skin_seen_percent",
    figure_label="skin seen",
    figure_unit="%",
    why="what the camera does not see cannot be felt",
    chief=True,
    yes_no=("seen", "blind"),
)
