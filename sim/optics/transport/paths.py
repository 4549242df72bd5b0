"""Follow photons to their ends with the driver that suits the device."""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import Protocol

from sim.optics.transport.scene import Scene
from sim.optics.transport.sources import Sources
from sim.optics.transport.tally import Tally
from workbench.core.base.monitor import Monitor, silent


class Driver(enum.StrEnum):
    """How rays find what they meet; both give the same light.

    Two, because on two cores the tree takes twice the processor time that Embree takes, and a GPU
    would wait for Embree.
    """

    WAVEFRONT = "wavefront"
    """Embree for all rays at once, event by event: for processors."""
    MEGAKERNEL = "megakernel"
    """One thread a photon, with a tree of boxes: for CUDA."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Photons:
    """Which photons are followed, and how."""

    count: int
    """Rounded up to as many from each light."""
    seed: int
    """Of the random numbers."""
    first: int = 0
    """Number of the first one; batches that follow one another make one long run."""
    driver: Driver | None = None
    """None takes the one for the open device."""


class _Tracer(Protocol):
    batch: int

    def trace(self, first: int, count: int, seed: int) -> None: ...

    def close(self) -> None: ...


def trace_paths(
    scene: Scene,
    sources: Sources,
    tally: Tally,
    photons: Photons,
    *,
    monitor: Monitor = silent,
) -> int:
    """Follow photons and add what they leave to the tally.

    Args:
        scene: What they meet.
        sources: Where they begin.
        tally: Grows.
        photons: How many, and how.

    Returns:
        Photons that were followed.
    """
    count = -(-photons.count // sources.count) * sources.count
    tracer = _open(photons.driver or driver_of_device(), scene, sources, tally)
    try:
        for start in range(0, count, tracer.batch):
            monitor(start / count, f"{start / 1e6:.1f} of {count / 1e6:.1f} million photons")
            batch = min(tracer.batch, count - start)
            tracer.trace(photons.first + start, batch, photons.seed)
    finally:
        tracer.close()
    tally.photons += count
    return count


def driver_of_device() -> Driver:
    """The driver for the device that Taichi was opened on."""
    from sim.optics.light.device_arrays import computes_on_gpu

    return Driver.MEGAKERNEL if computes_on_gpu() else Driver.WAVEFRONT


def _open(driver: Driver, scene: Scene, sources: Sources, tally: Tally) -> _Tracer:
    if driver is Driver.MEGAKERNEL:
        from sim.optics.transport.megakernel import Megakernel

        return Megakernel(scene, sources, tally)
    from sim.optics.transport.wavefront import Wavefront

    return Wavefront(scene, sources, tally)
