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


@ti.dataclass
class Turn:
    """Which event of which photon: what random numbers are made of."""

    number: ti.i64
    event: ti.i32
    seed: ti.i32


@ti.dataclass
class Hit:
    """What a ray meets."""

    face: ti.i32  # -1 for nothing.
    u: ti.f32  # Weights of the second and third corner.
    v: ti.f32


@ti.func
def fixed(value: ti.f32) -> ti.i64:
    """A flux as a whole number of units."""
    return ti.cast(ti.floor(ti.cast(value, ti.f64) * FIXED_POINT + 0.5), ti.i64)


@ti.func
def random_of(turn: Turn, jitter: ti.i32) -> tm.vec4:
    """Four random numbers of one photon's event; others for another `jitter`."""
    low = ti.cast(turn.number & 0xFFFFFFF, ti.u32)
    high = ti.cast(turn.number >> 28, ti.u32)
    return random4(low, high, ti.cast(turn.seed, ti.u32), ti.cast(turn.event + jitter, ti.u32))


@ti.func
def book(ledger: ti.template(), fate: ti.i32, number: ti.i64, flux: ti.f32):
    """Add a flux to the ledger; photons share its columns so that threads rarely meet."""
    ledger[fate, ti.cast(number % LEDGER_SLOTS, ti.i32)] += fixed(flux)


@ti.func
def begin(number: ti.i64, seed: ti.i32, lamps: ti.template()) -> Photon:
    """Photon `number`, which belongs to light `number` modulo the count of lights.

    `emission` holds exponent, cone and radius [mm] of each light.
    """
    lights = lamps.positions.shape[0]
    light = ti.cast(number % lights, ti.i32)
    index = ti.cast(number // lights, ti.u32)
    shift = random4(
        ti.cast(light, ti.u32), ti.u32(0), ti.cast(seed, ti.u32), ti.cast(2 * JITTER, ti.u32)
    )
    kind = lamps.emission[light]
    return emitted(
        lattice4(index, shift),
        lamps.positions[light],
        lamps.axes[light],
        kind[0],
        kind[1],
        kind[2],
        lamps.in_shell[light],
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
    lamps: ti.template(),
    books: ti.template(),
):
    """Perpendicular irradiance at the three nodes about a place on the skin, by direction."""
    toward = -photon.direction
    received = photon.flux / ti.max(toward.dot(surface.geometric), FLATTEST_COSINE)
    share = tm.vec3(0.0)
    for corner in ti.static(range(3)):
        share += surface.weights[corner] * books.face_weights[face, corner]
    share = ti.max(share, 0.0)
    share /= ti.max(share.sum(), 1e-6)
    nodes = books.face_nodes[face]
    colour = lamps.power[light]
    for corner in ti.static(range(3)):
        if share[corner] > 0.0:
            node = nodes[corner]
            amount = received * share[corner]
            column = bin_of(toward, node, books.frames, chance)
            for c in ti.static(range(3)):
                if colour[c] > 0.0:
                    books.bins[1 - photon.fresh, node, c, column] += fixed(amount * colour[c])
            if photon.fresh == 1:
                for k in ti.static(range(3)):
                    books.lamps[node, light, k] += fixed(amount * toward[k])
                books.lamps[node, light, 3] += fixed(amount)


@ti.func
def gather_toward_camera(
    photon: Photon,
    surface: Surface,
    corners: tm.ivec3,
    light: ti.i32,
    optics: tm.vec4,
    lamps: ti.template(),
    books: ti.template(),
):
    """Radiance toward the camera at the three vertices about a place on the skin."""
    toward = -photon.direction
    cos_facet = toward.dot(surface.geometric)
    cos_in = toward.dot(surface.shading)
    cos_facet = ti.max(cos_facet, ti.max(cos_in / STEEPEST, 1e-6))
    for corner in ti.static(range(3)):
        vertex = corners[corner]
        view = books.to_camera[vertex]
        if ti.min(view.dot(surface.geometric), view.dot(surface.shading)) > 0.0:
            lobe = reflected(toward, view, surface.shading, optics[0], optics[1], optics[2])
            amount = photon.flux * surface.weights[corner] * lobe / cos_facet
            for c in ti.static(range(3)):
                if lamps.power[light][c] > 0.0:
                    books.radiance[vertex, c] += fixed(amount * lamps.power[light][c])


@ti.func
def happen(
    gather: ti.template(),
    photon: Photon,
    turn: Turn,
    hit: Hit,
    scene: ti.template(),
    lamps: ti.template(),
    books: ti.template(),
) -> Photon:
    """The photon after it met what it hit, or nothing; all books are kept."""
    after = photon
    light = ti.cast(turn.number % lamps.power.shape[0], ti.i32)
    if hit.face < 0:
        after.fate = missed(photon)
        book(books.ledger, after.fate, turn.number, photon.flux)
    else:
        corners = scene.faces[hit.face]
        weights = tm.vec3(1.0 - hit.u - hit.v, hit.u, hit.v)
        surface = surface_at(photon.direction, corners, weights, scene.points, scene.normals)
        coated = ti.cast(hit.face < scene.skin_faces, ti.i32)
        if coated == 1 and surface.outward == 1:
            if ti.static(gather == AT_NODES):
                chance = random_of(turn, JITTER)
                gather_at_nodes(photon, surface, hit.face, light, chance, lamps, books)
            if ti.static(gather == TOWARD_CAMERA):
                gather_toward_camera(photon, surface, corners, light, scene.optics, lamps, books)
        after, absorbed, cut = meet(photon, surface, coated, random_of(turn, 0), scene.optics)
        if coated == 1 and surface.outward == 1:
            book(books.ledger, ABSORBED, turn.number, absorbed)
            book(books.ledger, ROULETTE, turn.number, cut)
        if after.fate == LEAKED:
            book(books.ledger, LEAKED, turn.number, photon.flux)
        if after.fate == FLYING and turn.event + 1 >= EVENTS:
            after.fate = DEPTH
            book(books.ledger, DEPTH, turn.number, after.flux)
    return after
