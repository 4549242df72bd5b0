"""Taichi kernels of the wavefront driver: begin a batch of photons, and let one event happen.

Between two events Embree finds what each ray meets; the arrays here are plain NumPy ones.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false
# pyright: reportCallIssue=false, reportAttributeAccessIssue=false

import taichi as ti
import taichi.math as tm

from sim.optics.transport.constants import FLYING
from sim.optics.transport.emission_functions import Photon
from sim.optics.transport.event_functions import (
    Counts2,
    Counts3,
    Counts4,
    Floats,
    Frames,
    Integers,
    Points,
    Triples,
    begin,
    happen,
)


@ti.kernel
def begin_all(
    first: ti.i64,
    seed: ti.i32,
    positions: Points,
    axes: Points,
    emission: Points,
    in_shell: Integers,
    origins: Points,
    directions: Points,
    fluxes: Floats,
    marks: Integers,
):
    """Photons `first` and following, one for each row."""
    for row in range(fluxes.shape[0]):
        number = first + row
        photon = begin(number, seed, positions, axes, emission, in_shell)
        origins[row] = photon.origin
        directions[row] = photon.direction
        fluxes[row] = photon.flux
        marks[row] = photon.fresh + 2 * photon.crossed


@ti.kernel
def happen_to_all(
    gather: ti.template(),
    first: ti.i64,
    event: ti.i32,
    seed: ti.i32,
    flying: Integers,
    origins: Points,
    directions: Points,
    fluxes: Floats,
    marks: Integers,
    alive: Integers,
    hit_face: Integers,
    hit_u: Floats,
    hit_v: Floats,
    points: Points,
    normals: Points,
    faces: Triples,
    skin_faces: ti.i32,
    optics: tm.vec4,
    ledger: Counts2,
    power: Points,
    face_nodes: Triples,
    face_weights: Frames,
    frames: Frames,
    bins: Counts4,
    lamps: Counts3,
    to_camera: Points,
    radiance: Counts2,
):
    """One event of every photon; `flying` are their numbers less `first`."""
    for i in range(flying.shape[0]):
        photon = Photon(
            origin=origins[i],
            direction=directions[i],
            flux=fluxes[i],
            fresh=marks[i] % 2,
            crossed=marks[i] // 2,
            fate=FLYING,
        )
        photon = happen(
            gather,
            photon,
            first + flying[i],
            event,
            seed,
            hit_face[i],
            hit_u[i],
            hit_v[i],
            points,
            normals,
            faces,
            skin_faces,
            optics,
            ledger,
            power,
            face_nodes,
            face_weights,
            frames,
            bins,
            lamps,
            to_camera,
            radiance,
        )
        origins[i] = photon.origin
        directions[i] = photon.direction
        fluxes[i] = photon.flux
        marks[i] = photon.fresh + 2 * photon.crossed
        alive[i] = ti.cast(photon.fate == FLYING, ti.i32)
