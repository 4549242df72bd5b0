"""What becomes of one photon where it meets a surface: the physics, written once for all drivers.

Coating: diffuse albedo (1 - F0) plus GGX with Schlick's F. One lobe is chosen at random in
proportion to its reflectance head-on to the ray; the diffuse one samples the cosine, the glossy one
the visible normals of GGX, which leaves F G2 / G1 as its weight. Energy not reflected is absorbed.
Cavity wall: Snell, and reflection with Fresnel's probability. At index 1 a photon goes straight on.
Normals are interpolated, so a photon scattered on the coating is weighted by
|wi.Ns wo.Ng| / (|wi.Ng wo.Ns|); facets would show otherwise.

Sources: Heitz, Sampling the GGX distribution of visible normals, JCGT 2018; Veach, thesis 1997,
section 5.3. Plain twin: `reference`.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false
# pyright: reportCallIssue=false, reportAttributeAccessIssue=false

import taichi as ti
import taichi.math as tm

from sim.optics.light.coating_kernels import FLOOR, schlick
from sim.optics.transport.constants import ABSORBED, GRAZING, LEAKED, OFFSET_MM, STEEPEST, SURVIVAL
from sim.optics.transport.emission_functions import Photon, across


@ti.dataclass
class Surface:
    """Where a photon meets a triangle; both normals point against the ray."""

    point: tm.vec3
    geometric: tm.vec3
    shading: tm.vec3
    weights: tm.vec3
    outward: ti.i32  # 1 if the ray goes out of the sensor.


@ti.func
def surface_at(
    direction: tm.vec3,
    corners: tm.ivec3,
    weights: tm.vec3,
    points: ti.template(),
    normals: ti.template(),
) -> Surface:
    """The surface at a place of a triangle, as a ray of this direction meets it."""
    a, b, c = points[corners[0]], points[corners[1]], points[corners[2]]
    point = weights[0] * a + weights[1] * b + weights[2] * c
    geometric = (b - a).cross(c - a).normalized()
    shading = weights[0] * normals[corners[0]] + weights[1] * normals[corners[1]]
    shading = (shading + weights[2] * normals[corners[2]]).normalized()
    # The winding is not trusted: the normals say which side is outside.
    if geometric.dot(shading) < 0.0:
        geometric = -geometric
    outward = 1
    if geometric.dot(direction) < 0.0:
        outward = 0
    else:
        geometric, shading = -geometric, -shading
    # A normal that a grazing ray meets from behind has lost its meaning.
    if shading.dot(direction) > -GRAZING:
        shading = geometric
    return Surface(
        point=point, geometric=geometric, shading=shading, weights=weights, outward=outward
    )


@ti.func
def at_wall(photon: Photon, surface: Surface, choice: ti.f32, index: ti.f32) -> Photon:
    """Reflect or refract at the smooth wall between air inside and the solid of `index`."""
    after = photon
    normal, facing = surface.shading, surface.geometric
    d = photon.direction
    ratio = index
    if surface.outward == 1:
        ratio = 1.0 / index
    cos_in = ti.min(-normal.dot(d), 1.0)
    squared = 1.0 - ratio * ratio * (1.0 - cos_in * cos_in)
    reflectance, cos_out = 1.0, 0.0
    if squared > 0.0:
        cos_out = ti.sqrt(squared)
        s = (ratio * cos_in - cos_out) / (ratio * cos_in + cos_out)
        p = (cos_in - ratio * cos_out) / (cos_in + ratio * cos_out)
        reflectance = 0.5 * (s * s + p * p)
    if choice < reflectance:
        # Light that runs along the shell is reflected by its inner side again and again.
        if surface.outward == 1:
            after.fresh = 0
        bent = d + 2.0 * cos_in * normal
        if bent.dot(facing) < GRAZING:
            bent = d - 2.0 * d.dot(facing) * facing
        after.direction = bent.normalized()
        after.origin = surface.point + OFFSET_MM * facing
    else:
        if index != 1.0:
            if photon.crossed == 1:
                after.fresh = 0
            after.crossed = 1
            bent = ratio * d + (ratio * cos_in - cos_out) * normal
            # Straight on, where the interpolated normal would send it back through the facet.
            if bent.dot(facing) < -GRAZING:
                after.direction = bent.normalized()
        after.origin = surface.point - OFFSET_MM * facing
    return after


@ti.func
def _half_vector(view: tm.vec3, roughness: ti.f32, u: ti.f32, v: ti.f32) -> tm.vec3:
    """A normal of GGX as seen from `view`, both in the frame whose z is the surface normal."""
    stretched = tm.vec3(roughness * view.x, roughness * view.y, view.z).normalized()
    flat = stretched.x * stretched.x + stretched.y * stretched.y
    first = tm.vec3(1.0, 0.0, 0.0)
    if flat > 1e-9:
        first = tm.vec3(-stretched.y, stretched.x, 0.0) / ti.sqrt(flat)
    second = stretched.cross(first)
    radius, around = ti.sqrt(u), 2.0 * tm.pi * v
    x, y = radius * ti.cos(around), radius * ti.sin(around)
    lean = 0.5 * (1.0 + stretched.z)
    y = (1.0 - lean) * ti.sqrt(ti.max(1.0 - x * x, 0.0)) + lean * y
    z = ti.sqrt(ti.max(1.0 - x * x - y * y, 0.0))
    found = x * first + y * second + z * stretched
    return tm.vec3(roughness * found.x, roughness * found.y, ti.max(found.z, 1e-6)).normalized()


@ti.func
def _glossy_weight(
    cos_in: ti.f32, cos_out: ti.f32, cos_half: ti.f32, specular: ti.f32, roughness: ti.f32
) -> ti.f32:
    """F G2 / G1 of directions drawn by visible normals; Smith's height-correlated G2."""
    squared = roughness * roughness
    here, there = ti.max(cos_in, FLOOR), ti.max(cos_out, FLOOR)
    root_in = ti.sqrt(squared + (1.0 - squared) * here * here)
    root_out = ti.sqrt(squared + (1.0 - squared) * there * there)
    masking = there * (here + root_in) / (there * root_in + here * root_out)
    return schlick(cos_half, specular) * masking


@ti.func
def at_coating(
    photon: Photon,
    surface: Surface,
    u: tm.vec4,
    albedo: ti.f32,
    specular: ti.f32,
    roughness: ti.f32,
):
    """Scatter at the coating.

    Returns the photon, the flux that was absorbed, and the flux that roulette cut off (negative
    where a survivor was made stronger).
    """
    after = photon
    after.fresh = 0
    z = surface.shading
    x = across(z)
    y = z.cross(x)
    toward = -photon.direction
    cos_in = toward.dot(z)
    matte = albedo * (1.0 - specular)
    glossy = schlick(cos_in, specular)
    chance = glossy / ti.max(glossy + matte, 1e-9)
    weight = 0.0
    out = tm.vec3(0.0)
    if u[0] < chance:
        view = tm.vec3(toward.dot(x), toward.dot(y), cos_in)
        half = _half_vector(view, roughness, u[1], u[2])
        cos_half = view.dot(half)
        local = 2.0 * cos_half * half - view
        out = local.x * x + local.y * y + local.z * z
        weight = _glossy_weight(cos_in, local.z, cos_half, specular, roughness) / chance
    else:
        radius, around = ti.sqrt(u[1]), 2.0 * tm.pi * u[2]
        out = radius * (ti.cos(around) * x + ti.sin(around) * y) + ti.sqrt(1.0 - u[1]) * z
        weight = matte / ti.max(1.0 - chance, 1e-9)
    cos_out, cos_facet = out.dot(z), out.dot(surface.geometric)
    if ti.min(cos_out, cos_facet) <= GRAZING:
        weight = 0.0
    else:
        facet_in = ti.max(toward.dot(surface.geometric), GRAZING)
        weight *= ti.min(cos_in / facet_in * (cos_facet / cos_out), STEEPEST)
    survival = ti.min(weight, SURVIVAL)
    absorbed = photon.flux * (1.0 - weight)
    cut = photon.flux * weight
    if u[3] < survival:
        after.flux = photon.flux * weight / survival
        cut -= after.flux
        after.direction = out.normalized()
        after.origin = surface.point + OFFSET_MM * surface.geometric
    else:
        after.fate = ABSORBED
    return after, absorbed, cut


@ti.func
def meet(
    photon: Photon,
    surface: Surface,
    coated: ti.i32,
    u: tm.vec4,
    optics: tm.vec4,
):
    """One event: the photon after it, and the flux absorbed and cut off by roulette.

    Args:
        coated: 1 on the skin, 0 on the wall.
        optics: Albedo, specular reflectance, roughness, refractive index.
    """
    after = photon
    absorbed, cut = 0.0, 0.0
    if coated == 0:
        after = at_wall(photon, surface, u[0], optics[3])
    elif surface.outward == 1:
        after, absorbed, cut = at_coating(photon, surface, u, optics[0], optics[1], optics[2])
    else:
        # Only light that slipped past the rim meets the skin from outside.
        after.fate = LEAKED
    return after, absorbed, cut
