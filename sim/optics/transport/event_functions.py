"""One event of one photon with its book-keeping: what the two drivers call for each ray.

What is gathered is chosen when a kernel is compiled: nothing; at the nodes, light by direction and,
of unscattered light, the sums that make virtual lights; or radiance toward a camera at the
vertices. Sums are whole numbers of `FIXED_POINT`, so no order of the threads changes them.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false
# pyright: reportCallIssue=false, reportAttributeAccessIssue=false, reportOptionalCall=false

import taichi as ti
import taichi.math as tm

from sim.optics.light.bins import bin_cosines
from sim.optics.light.coating_kernels import reflected
from sim.optics.transport.constants import (
    ABSORBED,
    AT_NODES,
    BASE,
    DEPTH,
    EVENTS,
    FIXED_POINT,
    FLATTEST_COSINE,
    FLYING,
    LEAKED,
    LEDGER_SLOTS,
    ROULETTE,
    STEEPEST,
    TOWARD_CAMERA,
)
from sim.optics.transport.emission_functions import Photon, emitted, lattice4, random4
from sim.optics.transport.scatter_functions import Surface, meet, surface_at
from workbench.core.result.light import AZIMUTHS

COSINES = tuple(float(cosine) for cosine in bin_cosines())
JITTER = 1 << 16
"""Added to the number of an event for the random numbers that choose between two bins."""
Points = ti.types.ndarray(dtype=tm.vec3, ndim=1)
Triples = ti.types.ndarray(dtype=tm.ivec3, ndim=1)
Floats = ti.types.ndarray(dtype=ti.f32, ndim=1)
Integers = ti.types.ndarray(dtype=ti.i32, ndim=1)
Frames = ti.types.ndarray(dtype=tm.vec3, ndim=2)
Counts2 = ti.types.ndarray(dtype=ti.i64, ndim=2)
Counts3 = ti.types.ndarray(dtype=ti.i64, ndim=3)
Counts4 = ti.types.ndarray(dtype=ti.i64, ndim=4)


@ti.func
def fixed(value: ti.f32) -> ti.i64:
    """A flux as a whole number of units."""
    return ti.cast(ti.floor(ti.cast(value, ti.f64) * FIXED_POINT + 0.5), ti.i64)


@ti.func
def random_of(number: ti.i64, seed: ti.i32, event: ti.i32) -> tm.vec4:
    """Four random numbers of one photon's event."""
    low = ti.cast(number & 0xFFFFFFF, ti.u32)
    high = ti.cast(number >> 28, ti.u32)
    return random4(low, high, ti.cast(seed, ti.u32), ti.cast(event, ti.u32))


@ti.func
def book(ledger: ti.template(), fate: ti.i32, number: ti.i64, flux: ti.f32):
    """Add a flux to the ledger; photons share its columns so that threads rarely meet."""
    ledger[fate, ti.cast(number % LEDGER_SLOTS, ti.i32)] += fixed(flux)


@ti.func
def begin(
    number: ti.i64,
    seed: ti.i32,
    positions: ti.template(),
    axes: ti.template(),
    emission: ti.template(),
    in_shell: ti.template(),
) -> Photon:
    """Photon `number`, which belongs to light `number` modulo the count of lights.

    `emission` holds exponent, cone and radius [mm] of each light.
    """
    lights = positions.shape[0]
    light = ti.cast(number % lights, ti.i32)
    index = ti.cast(number // lights, ti.u32)
    shift = random4(
        ti.cast(light, ti.u32), ti.u32(0), ti.cast(seed, ti.u32), ti.cast(2 * JITTER, ti.u32)
    )
    kind = emission[light]
    return emitted(
        lattice4(index, shift),
        positions[light],
        axes[light],
        kind[0],
        kind[1],
        kind[2],
        in_shell[light],
    )


@ti.func
def missed(photon: Photon) -> ti.i32:
    """Where a photon goes that meets nothing: down through the base, or out through a gap."""
    fate = LEAKED
    if photon.direction.z < 0.0:
        fate = BASE
    return fate


@ti.func
def bin_of(toward: tm.vec3, node: ti.i32, frames: ti.template(), chance: tm.vec4) -> ti.i32:
    """One of the bins about a direction, drawn so that the mean direction stays."""
    t, b, n = frames[node, 0], frames[node, 1], frames[node, 2]
    cosine = toward.dot(n)
    row = 0
    for k in ti.static(range(1, len(COSINES))):
        low, high = COSINES[k - 1], COSINES[k]
        if cosine >= low and (cosine - low) / (high - low) > chance[0]:
            row = k
    turn = ti.atan2(toward.dot(b), toward.dot(t)) / (2.0 * tm.pi) + 1.0
    column = ti.cast(ti.floor(turn * AZIMUTHS + chance[1]), ti.i32) % AZIMUTHS
    return row * AZIMUTHS + column


@ti.func
def gather_at_nodes(
    photon: Photon,
    surface: Surface,
    face: ti.i32,
    light: ti.i32,
    chance: tm.vec4,
    face_nodes: ti.template(),
    face_weights: ti.template(),
    frames: ti.template(),
    power: ti.template(),
    bins: ti.template(),
    lamps: ti.template(),
):
    """Perpendicular irradiance at the three nodes about a place on the skin, by direction."""
    toward = -photon.direction
    received = photon.flux / ti.max(toward.dot(surface.geometric), FLATTEST_COSINE)
    share = tm.vec3(0.0)
    for corner in ti.static(range(3)):
        share += surface.weights[corner] * face_weights[face, corner]
    share = ti.max(share, 0.0)
    share /= ti.max(share.sum(), 1e-6)
    nodes = face_nodes[face]
    colour = power[light]
    for corner in ti.static(range(3)):
        if share[corner] > 0.0:
            node = nodes[corner]
            amount = received * share[corner]
            column = bin_of(toward, node, frames, chance)
            for c in ti.static(range(3)):
                if colour[c] > 0.0:
                    bins[1 - photon.fresh, node, c, column] += fixed(amount * colour[c])
            if photon.fresh == 1:
                for k in ti.static(range(3)):
                    lamps[node, light, k] += fixed(amount * toward[k])
                lamps[node, light, 3] += fixed(amount)


@ti.func
def gather_toward_camera(
    photon: Photon,
    surface: Surface,
    corners: tm.ivec3,
    light: ti.i32,
    optics: tm.vec4,
    to_camera: ti.template(),
    power: ti.template(),
    radiance: ti.template(),
):
    """Radiance toward the camera at the three vertices about a place on the skin."""
    toward = -photon.direction
    cos_facet = toward.dot(surface.geometric)
    cos_in = toward.dot(surface.shading)
    cos_facet = ti.max(cos_facet, ti.max(cos_in / STEEPEST, 1e-6))
    for corner in ti.static(range(3)):
        vertex = corners[corner]
        view = to_camera[vertex]
        if ti.min(view.dot(surface.geometric), view.dot(surface.shading)) > 0.0:
            lobe = reflected(toward, view, surface.shading, optics[0], optics[1], optics[2])
            amount = photon.flux * surface.weights[corner] * lobe / cos_facet
            for c in ti.static(range(3)):
                if power[light][c] > 0.0:
                    radiance[vertex, c] += fixed(amount * power[light][c])


@ti.func
def happen(
    gather: ti.template(),
    photon: Photon,
    number: ti.i64,
    event: ti.i32,
    seed: ti.i32,
    face: ti.i32,
    u: ti.f32,
    v: ti.f32,
    points: ti.template(),
    normals: ti.template(),
    faces: ti.template(),
    skin_faces: ti.i32,
    optics: tm.vec4,
    ledger: ti.template(),
    power: ti.template(),
    face_nodes: ti.template(),
    face_weights: ti.template(),
    frames: ti.template(),
    bins: ti.template(),
    lamps: ti.template(),
    to_camera: ti.template(),
    radiance: ti.template(),
) -> Photon:
    """The photon after it met triangle `face` at (u, v), or nothing (-1); all books are kept."""
    after = photon
    light = ti.cast(number % power.shape[0], ti.i32)
    if face < 0:
        after.fate = missed(photon)
        book(ledger, after.fate, number, photon.flux)
    else:
        corners = faces[face]
        weights = tm.vec3(1.0 - u - v, u, v)
        surface = surface_at(photon.direction, corners, weights, points, normals)
        coated = ti.cast(face < skin_faces, ti.i32)
        if coated == 1 and surface.outward == 1:
            if ti.static(gather == AT_NODES):
                chance = random_of(number, seed, event + JITTER)
                gather_at_nodes(
                    photon,
                    surface,
                    face,
                    light,
                    chance,
                    face_nodes,
                    face_weights,
                    frames,
                    power,
                    bins,
                    lamps,
                )
            if ti.static(gather == TOWARD_CAMERA):
                gather_toward_camera(
                    photon, surface, corners, light, optics, to_camera, power, radiance
                )
        chances = random_of(number, seed, event)
        after, absorbed, cut = meet(photon, surface, coated, chances, optics)
        if coated == 1 and surface.outward == 1:
            book(ledger, ABSORBED, number, absorbed)
            book(ledger, ROULETTE, number, cut)
        if after.fate == LEAKED:
            book(ledger, LEAKED, number, photon.flux)
        if after.fate == FLYING and event + 1 >= EVENTS:
            after.fate = DEPTH
            book(ledger, DEPTH, number, after.flux)
    return after
