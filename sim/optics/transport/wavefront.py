"""The driver for processors: Embree finds what all rays meet, a kernel lets the event happen.

One scene holds both surfaces. Embree runs in as many threads as there are cores, each on its part
of the rays; photons that ended are dropped from the arrays after each event.
"""

from __future__ import annotations

import itertools
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from geometry.surface.rays import RayCaster
from sim.optics.transport.constants import EVENTS
from sim.optics.transport.scene import Scene
from sim.optics.transport.sources import Sources
from sim.optics.transport.tally import Tally
from workbench.system.processes import cores

BATCH = 120_000
"""Photons that fly together: 5 MB, and under a second between two reports of progress."""
LEAST_PART = 20_000
"""Rays that are worth a thread of their own."""


class Wavefront:
    """Traces batches of photons through one scene."""

    batch = BATCH

    def __init__(self, scene: Scene, sources: Sources, tally: Tally) -> None:
        from sim.optics.transport.bundles import Hits, books_of, lamp_arrays, scene_arrays

        self._caster = RayCaster(scene.points_mm, scene.faces)
        self._gather, self._lamps = tally.gather, lamp_arrays(sources)
        self._scene, (self._books, _) = scene_arrays(scene), books_of(tally)
        none = np.zeros(0, dtype=np.float32)
        self._met = Hits(face=none.astype(np.int32), u=none, v=none)
        self._threads = ThreadPoolExecutor(cores())

    def close(self) -> None:
        """End the threads."""
        self._threads.shutdown()

    def trace(self, first: int, count: int, seed: int) -> None:
        """Follow photons `first` to `first + count` to their ends."""
        from sim.optics.transport import wavefront_kernels as kernels
        from sim.optics.transport.bundles import Flight

        state = {
            "origins": np.empty((count, 3), dtype=np.float32),
            "directions": np.empty((count, 3), dtype=np.float32),
            "fluxes": np.empty(count, dtype=np.float32),
            "marks": np.empty(count, dtype=np.int32),
            "alive": np.empty(count, dtype=np.int32),
        }
        begin_all: Any = kernels.begin_all
        flight = Flight(**state)
        begin_all(first, seed, self._lamps, flight)
        flying = np.arange(count, dtype=np.int32)
        for event in range(EVENTS):
            if not flying.size:
                return
            self._event(first, event, seed, flying, flight)
            on = np.flatnonzero(flight["alive"])
            flying = flying[on]
            for name in state:
                # A new bundle would take a third of a millisecond, a new array in it none.
                flight[name] = np.ascontiguousarray(flight[name][on])

    def _event(self, first: int, event: int, seed: int, flying: np.ndarray, flight: Any) -> None:
        """Let one event happen in place."""
        from sim.optics.transport import wavefront_kernels as kernels

        happen_to_all: Any = kernels.happen_to_all
        hits = self._hits(flight["origins"], flight["directions"])
        for name, found in zip(("face", "u", "v"), hits, strict=True):
            self._met[name] = found
        happen_to_all(
            self._gather,
            first,
            event,
            seed,
            flying,
            flight,
            self._met,
            self._scene,
            self._lamps,
            self._books,
        )

    def _hits(
        self, origins: np.ndarray, directions: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Face, u and v of the first hit of each ray, cast in parts by the threads."""
        parts = max(1, min(self._threads._max_workers, len(origins) // LEAST_PART))
        if parts == 1:
            return self._caster.first_faces(origins, directions)
        cuts = np.linspace(0, len(origins), parts + 1).astype(int)
        jobs = [
            self._threads.submit(self._caster.first_faces, origins[a:b], directions[a:b])
            for a, b in itertools.pairwise(cuts)
        ]
        found = [job.result() for job in jobs]
        face, u, v = (np.concatenate(part) for part in zip(*found, strict=True))
        return face, u, v
