"""Random numbers, and how a photon begins: Taichi functions of traced light.

Random numbers are a hash of (photon number, seed, event): no driver and no order changes them. An
emission takes a point of a lattice instead, which covers disc and directions more evenly.
Sources: Jarzynski and Olano, Hash functions for GPU rendering, JCGT 2020 (pcg4d); Roberts, The
unreasonable effectiveness of quasirandom sequences, 2018 (the lattice; it repeats after 2^32
photons of a light). Plain twin: `reference`.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false
# pyright: reportCallIssue=false, reportAttributeAccessIssue=false

import taichi as ti
import taichi.math as tm

from sim.optics.transport.constants import FLYING, LATTICE


@ti.dataclass
class Photon:
    """A photon between two events."""

    origin: tm.vec3
    direction: tm.vec3
    flux: ti.f32
    fresh: ti.i32  # 1 until it was scattered, thrown back into the cavity, or bent twice.
    crossed: ti.i32  # 1 once it was bent into the solid, or began there.
    fate: ti.i32


@ti.func
def random4(low: ti.u32, high: ti.u32, seed: ti.u32, event: ti.u32) -> tm.vec4:
    """Four numbers in [0, 1) from a photon's number, a seed and the number of an event."""
    x = low * ti.u32(1664525) + ti.u32(1013904223)
    y = high * ti.u32(1664525) + ti.u32(1013904223)
    z = seed * ti.u32(1664525) + ti.u32(1013904223)
    w = event * ti.u32(1664525) + ti.u32(1013904223)
    x += y * w
    y += z * x
    z += x * y
    w += y * z
    x ^= x >> ti.u32(16)
    y ^= y >> ti.u32(16)
    z ^= z >> ti.u32(16)
    w ^= w >> ti.u32(16)
    x += y * w
    y += z * x
    z += x * y
    w += y * z
    return tm.vec4(_unit(x), _unit(y), _unit(z), _unit(w))


@ti.func
def _unit(bits: ti.u32) -> ti.f32:
    return ti.cast(bits >> ti.u32(8), ti.f32) * (1.0 / 16777216.0)


@ti.func
def lattice4(index: ti.u32, shift: tm.vec4) -> tm.vec4:
    """Point `index` of a rank-1 lattice in four dimensions, shifted: even cover of an emission."""
    u = tm.vec4(0.0)
    for k in ti.static(range(4)):
        step = _unit(index * ti.u32(LATTICE[k])) + shift[k]
        u[k] = step - ti.floor(step)
    return u


@ti.func
def across(normal: tm.vec3) -> tm.vec3:
    """A unit vector at right angles to a unit normal."""
    helper = tm.vec3(1.0, 0.0, 0.0)
    if ti.abs(normal.x) > 0.9:
        helper = tm.vec3(0.0, 1.0, 0.0)
    return helper.cross(normal).normalized()


@ti.func
def emitted(
    u: tm.vec4,
    position: tm.vec3,
    axis: tm.vec3,
    exponent: ti.f32,
    cone: ti.f32,
    radius_mm: ti.f32,
    crossed: ti.i32,
) -> Photon:
    """A photon of flux 1 from a disc normal to the axis, intensity cos^exponent within the cone."""
    x = across(axis)
    y = axis.cross(x)
    radius = radius_mm * ti.sqrt(u[0])
    around = 2.0 * tm.pi * u[1]
    origin = position + radius * (ti.cos(around) * x + ti.sin(around) * y)
    dimmest = ti.pow(cone, exponent + 1.0)
    cosine = ti.pow(1.0 - u[2] * (1.0 - dimmest), 1.0 / (exponent + 1.0))
    sine = ti.sqrt(ti.max(1.0 - cosine * cosine, 0.0))
    azimuth = 2.0 * tm.pi * u[3]
    direction = sine * (ti.cos(azimuth) * x + ti.sin(azimuth) * y) + cosine * axis
    return Photon(
        origin=origin,
        direction=direction.normalized(),
        flux=1.0,
        fresh=1,
        crossed=crossed,
        fate=FLYING,
    )
