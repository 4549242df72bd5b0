"""Readings of a twin's photographs beside what they really show, as `workbench read` tells them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from workbench.core.base.monitor import silent
from workbench.core.design.design import SensorDesign
from workbench.pipeline.store import Store
from workbench.reading.learned_reader import LearnedReading
from workbench.reading.read_photo import Reading
from workbench.twin.scoring import ReadingScore, Scorer, mean_score
from workbench.twin.truth import Truth


class ScoredReadings:
    """Scores as they come, whichever reader read."""

    def __init__(
        self, design: SensorDesign, idle: np.ndarray, truths: Mapping[str, Truth], store: Store
    ) -> None:
        """Keep what is known.

        Args:
            design: That the readings are of.
            idle: The photograph at rest, shape (H, W, 3), uint8.
            truths: By the photographs' names without ending; empty: nothing is scored.
            store: Keeps mesh and light.
        """
        self._of = design, idle, store
        self._truths = truths
        self._scorer: Scorer | None = None
        self._scores: list[ReadingScore] = []

    def figures(self, reading: Reading | LearnedReading, name: str) -> dict[str, Any]:
        """The score of a reading as `reading.json` holds it; empty where nothing is known."""
        if name not in self._truths:
            return {}
        if self._scorer is None:
            self._scorer = self._opened()
        self._scores.append(self._scorer.score(reading, self._truths[name]))
        return {"score": self._scores[-1].figures}

    def lines(self) -> list[str]:
        """The mean of all scores, for people."""
        if not self._scores:
            return []
        mean = mean_score(self._scores)
        return [
            f"depth off by {mean.depth_mm:.3f} mm (nothing read: {mean.depth_null_mm:.3f}, normals "
            f"known: {mean.depth_ceiling_mm:.3f}), normals by {mean.normal_deg:.1f} degrees "
            f"({mean.normal_null_deg:.1f}), contact IoU {mean.contact_iou:.2f}, force off by "
            f"{100.0 * mean.force_error:.0f} %, {100.0 * mean.within_sigma:.0f} % of depths within "
            "one standard deviation"
        ]

    def _opened(self) -> Scorer:
        """A scorer: it sees the skin as the design's own reader does."""
        from workbench.pipeline.devices import open_device
        from workbench.reading.design_reader import open_reader

        open_device()
        design, idle, store = self._of
        return Scorer(open_reader(design, idle, store, monitor=silent))
