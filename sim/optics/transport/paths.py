"""Follow photons to their ends with the driver that suits the device."""

from __future__ import annotations

import enum
from typing import Protocol

from sim.optics.transport.scene import Scene
from sim.optics.transport.sources import Sources
from sim.optics.transport.tally import Tally
from workbench.core.base.monitor import Monitor, silent


class Driver(enum.StrEnum):
    """How rays find what they meet; both give the same light."""

    WAVEFRONT = "wavefront"
    """Embree for all rays at once, event by event: for processors."""
    MEGAKERNEL = "megakernel"
    """One thread a photon, with a tree of boxes: for CUDA."""


class _Tracer(Protocol):
    batch: int

    def trace(self, first: int, count: int, seed: int) -> None: ...

    def close(self) -> None: ...


def trace_paths(
    scene: Scene,
    sources: Sources,
    tally: Tally,
    *,
    photons: int,
    seed: int,
    first_photon: int = 0,
    driver: Driver | None = None,
    monitor: Monitor = silent,
) -> int:
    """Follow photons and add what they leave to the tally.

    Args:
        scene: What they meet.
        sources: Where they begin.
        tally: Grows.
        photons: How many; rounded up to as many from each light.
        seed: Of the random numbers.
        first_photon: Number of the first one; batches that follow one another make one long run.
        driver: None takes the one for the open device.

    Returns:
        Photons that were followed.
    """
    count = -(-photons // sources.count) * sources.count
    tracer = _open(driver or driver_of_device(), scene, sources, tally)
    try:
        for start in range(0, count, tracer.batch):
            monitor(start / count, f"{start / 1e6:.1f} of {count / 1e6:.1f} million photons")
            tracer.trace(first_photon + start, min(tracer.batch, count - start), seed)
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
