"""The driver for CUDA: one kernel follows photons from end to end through a tree of boxes.

Tables and sums stay on the device from the first batch to the last. It runs on a processor too,
where tests compare it with the other driver.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from sim.optics.transport.scene import Scene
from sim.optics.transport.sources import Sources
from sim.optics.transport.tally import Tally
from sim.optics.transport.tree import build_tree

BATCH = 4_000_000
"""Photons of one launch: well under a second on a data-centre device."""
SUMS = ("ledger", "bins", "lamps", "radiance")


class Megakernel:
    """Traces batches of photons through one scene."""

    batch = BATCH

    def __init__(self, scene: Scene, sources: Sources, tally: Tally) -> None:
        import taichi.math as tm

        from sim.optics.light.device_arrays import on_device

        def vectors(array: np.ndarray) -> Any:
            return on_device(array, vector=3)

        self._tally, self._skin_faces = tally, scene.skin_faces
        coating = scene.coating
        lobes = coating.albedo, coating.specular, coating.roughness
        self._optics = tm.vec4(*lobes, scene.refractive_index)
        tree = build_tree(scene.points_mm, scene.faces)
        lamps = sources.position_mm, sources.axis, sources.emission
        boxes = tree.lower_mm, tree.upper_mm
        surface = scene.points_mm, scene.normals
        self._inputs = [
            *(vectors(array) for array in lamps),
            on_device(sources.in_shell),
            *(vectors(array) for array in boxes),
            *(on_device(array) for array in (tree.starts, tree.order)),
            *(vectors(array) for array in surface),
            vectors(scene.faces),
        ]
        self._sums = {name: on_device(getattr(tally, name)) for name in SUMS}
        self._tables = [
            vectors(sources.power),
            *(vectors(getattr(tally, name)) for name in ("face_nodes", "face_weights", "frames")),
        ]
        self._to_camera = vectors(tally.to_camera)

    def trace(self, first: int, count: int, seed: int) -> None:
        """Follow photons `first` to `first + count` to their ends."""
        import taichi as ti

        from sim.optics.transport import megakernel_kernels

        follow_all: Any = megakernel_kernels.follow_all
        sums = self._sums
        follow_all(
            self._tally.gather,
            first,
            count,
            seed,
            *self._inputs,
            self._skin_faces,
            self._optics,
            sums["ledger"],
            *self._tables,
            sums["bins"],
            sums["lamps"],
            self._to_camera,
            sums["radiance"],
        )
        ti.sync()

    def close(self) -> None:
        """Copy the sums back."""
        for name, array in self._sums.items():
            setattr(self._tally, name, array.to_numpy())
