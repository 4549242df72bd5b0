"""The driver for CUDA: one kernel follows photons from end to end through a tree of boxes.

Tables and sums stay on the device from the first batch to the last. It runs on a processor too,
where tests compare it with the other driver.
"""

from __future__ import annotations

from typing import Any

from sim.optics.transport.scene import Scene
from sim.optics.transport.sources import Sources
from sim.optics.transport.tally import Tally
from sim.optics.transport.tree import build_tree

BATCH = 4_000_000
"""Photons of one launch: well under a second on a data-centre device."""


class Megakernel:
    """Traces batches of photons through one scene."""

    batch = BATCH

    def __init__(self, scene: Scene, sources: Sources, tally: Tally) -> None:
        from sim.optics.light.device_arrays import on_device
        from sim.optics.transport.bundles import Boxes, books_of, lamp_arrays, scene_arrays

        tree = build_tree(scene.points_mm, scene.faces)
        boxes = Boxes(
            lower=on_device(tree.lower_mm, vector=3),
            upper=on_device(tree.upper_mm, vector=3),
            starts=on_device(tree.starts),
            order=on_device(tree.order),
        )
        self._tally = tally
        books, self._sums = books_of(tally, on_device)
        self._bundles = (
            boxes,
            scene_arrays(scene, on_device),
            lamp_arrays(sources, on_device),
            books,
        )

    def trace(self, first: int, count: int, seed: int) -> None:
        """Follow photons `first` to `first + count` to their ends."""
        import taichi as ti

        from sim.optics.transport import megakernel_kernels

        follow_all: Any = megakernel_kernels.follow_all
        follow_all(self._tally.gather, first, count, seed, *self._bundles)
        ti.sync()

    def close(self) -> None:
        """Copy the sums back."""
        for name, array in self._sums.items():
            setattr(self._tally, name, array.to_numpy())
