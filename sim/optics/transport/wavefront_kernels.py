"""Taichi kernels of the wavefront driver: begin a batch of photons, and let one event happen.

Between two events Embree finds what each ray meets; the arrays here are plain NumPy ones.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false
# pyright: reportCallIssue=false, reportAttributeAccessIssue=false

import taichi as ti

from sim.optics.transport.bundles import Books, Flight, Hits, Integers, Lamps, SceneArrays
from sim.optics.transport.constants import FLYING
from sim.optics.transport.emission_functions import Photon
from sim.optics.transport.event_functions import Hit, Turn, begin, happen


@ti.kernel
def begin_all(first: ti.i64, seed: ti.i32, lamps: Lamps, flight: Flight):
    """Photons `first` and following, one for each row."""
    for row in range(flight.fluxes.shape[0]):
        _write(flight, row, begin(first + row, seed, lamps))


@ti.kernel
def happen_to_all(
    gather: ti.template(),
    first: ti.i64,
    event: ti.i32,
    seed: ti.i32,
    flying: Integers,
    flight: Flight,
    hits: Hits,
    scene: SceneArrays,
    lamps: Lamps,
    books: Books,
):
    """One event of every photon; `flying` are their numbers less `first`."""
    for i in range(flying.shape[0]):
        photon = Photon(
            origin=flight.origins[i],
            direction=flight.directions[i],
            flux=flight.fluxes[i],
            fresh=flight.marks[i] % 2,
            crossed=flight.marks[i] // 2,
            fate=FLYING,
        )
        turn = Turn(number=first + flying[i], event=event, seed=seed)
        hit = Hit(face=hits.face[i], u=hits.u[i], v=hits.v[i])
        _write(flight, i, happen(gather, photon, turn, hit, scene, lamps, books))


@ti.func
def _write(flight: ti.template(), row: ti.i32, photon: Photon):
    flight.origins[row] = photon.origin
    flight.directions[row] = photon.direction
    flight.fluxes[row] = photon.flux
    flight.marks[row] = photon.fresh + 2 * photon.crossed
    flight.alive[row] = ti.cast(photon.fate == FLYING, ti.i32)
