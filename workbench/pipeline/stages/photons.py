"""The stage `photons`: one batch of photons of one frame."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.monitor import Monitor
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import Lamp, LedRing
from workbench.core.design.optics import Transport
from workbench.core.result.light import VertexRadiance
from workbench.core.result.results import MembraneMesh
from workbench.core.result.sensing import Contact
from workbench.pipeline.devices import start_device
from workbench.pipeline.stage import Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class PhotonsInputs:
    """What a batch depends on; of the number of photons only its own, so that more go on."""

    mesh: MembraneMesh
    ring: LedRing
    lamps: tuple[Lamp, ...]
    camera: Camera
    transport: Transport
    contact: Contact | None
    frame: int
    """0 is the undeformed skin."""
    first_photon: int
    count: int


def photons(given: PhotonsInputs, *, monitor: Monitor) -> VertexRadiance:
    """Radiance toward the camera from each vertex, of these photons."""
    start_device(monitor)
    from sim.optics.light.lights import place_leds
    from sim.optics.transport.paths import Photons
    from sim.optics.transport.radiance import trace_radiance

    contact, mesh = given.contact, given.mesh
    moved = None if contact is None else mesh.seen_displacement_mm(contact)[given.frame - 1]
    return trace_radiance(
        mesh,
        place_leds(given.ring, given.lamps),
        given.camera,
        given.transport,
        Photons(count=given.count, seed=given.transport.baking.seed, first=given.first_photon),
        displacement_mm=moved,
        monitor=monitor,
    )


STAGE = Stage(
    name="photons", label="Photons", version=1, place=10, lane="sim", run=photons, shown=False
)
