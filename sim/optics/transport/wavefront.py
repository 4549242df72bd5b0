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
        self._scene, self._sources, self._tally = scene, sources, tally
        self._caster = RayCaster(scene.points_mm, scene.faces)
        coating = scene.coating
        lobes = coating.albedo, coating.specular, coating.roughness
        self._optics = np.array([*lobes, scene.refractive_index], dtype=np.float32)
        self._threads = ThreadPoolExecutor(cores())

    def close(self) -> None:
        """End the threads."""
        self._threads.shutdown()

    def trace(self, first: int, count: int, seed: int) -> None:
        """Follow photons `first` to `first + count` to their ends."""
        from sim.optics.transport import wavefront_kernels as kernels

        sources = self._sources
        state = [
            np.empty((count, 3), dtype=np.float32),
            np.empty((count, 3), dtype=np.float32),
            np.empty(count, dtype=np.float32),
            np.empty(count, dtype=np.int32),
        ]
        lamps = sources.position_mm, sources.axis, sources.emission, sources.in_shell
        begin_all: Any = kernels.begin_all
        begin_all(first, seed, *lamps, *state)
        flying = np.arange(count, dtype=np.int32)
        for event in range(EVENTS):
            if not flying.size:
                return
            alive = self._event(first, event, seed, flying, state)
            flying = flying[alive]
            state = [np.ascontiguousarray(part[alive]) for part in state]

    def _event(
        self, first: int, event: int, seed: int, flying: np.ndarray, state: list[np.ndarray]
    ) -> np.ndarray:
        """Let one event happen in place; the photons that fly on, shape (A,)."""
        import taichi.math as tm

        from sim.optics.transport import wavefront_kernels as kernels

        happen_to_all: Any = kernels.happen_to_all
        scene, tally = self._scene, self._tally
        hits = self._hits(state[0], state[1])
        alive = np.empty(len(flying), dtype=np.int32)
        happen_to_all(
            tally.gather,
            first,
            event,
            seed,
            flying,
            *state,
            alive,
            *hits,
            scene.points_mm,
            scene.normals,
            scene.faces,
            scene.skin_faces,
            tm.vec4(*self._optics.tolist()),
            tally.ledger,
            self._sources.power,
            tally.face_nodes,
            tally.face_weights,
            tally.frames,
            tally.bins,
            tally.lamps,
            tally.to_camera,
            tally.radiance,
        )
        return np.flatnonzero(alive)

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
