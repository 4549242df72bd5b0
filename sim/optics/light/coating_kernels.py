"""The coating's reflection as Taichi functions; `coating.glossy` is the plain twin.

f = rho (1 - F0) / pi + D G F / (4 (N . L) (N . V)) [1/sr] with the GGX distribution D, Smith's
height-correlated masking G and Schlick's F; see `coating` for the equations and their sources.
"""

# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false

import taichi as ti
import taichi.math as tm

FLOOR = 1e-3
"""Smallest cosine in a denominator [1], as in `coating`."""


@ti.func
def schlick(cosine: ti.f32, specular: ti.f32) -> ti.f32:
    """Fresnel reflectance of the glossy lobe at a cosine between direction and half vector.

    A surface of reflectance 0 is matte at every angle: below 0.02 the lobe fades edge-on, too.
    """
    away = 1.0 - tm.clamp(cosine, 0.0, 1.0)
    edge_on = ti.min(50.0 * specular, 1.0)
    return specular + (edge_on - specular) * away * away * away * away * away


@ti.func
def reflected(
    light: tm.vec3,
    view: tm.vec3,
    normal: tm.vec3,
    albedo: ti.f32,
    specular: ti.f32,
    roughness: ti.f32,
) -> ti.f32:
    """Radiance per perpendicular irradiance [1/sr], cosine to the light included."""
    cos_light = normal.dot(light)
    total = 0.0
    if cos_light > 0.0:
        cos_view = ti.max(normal.dot(view), FLOOR)
        half = light + view
        half = half / ti.max(half.norm(), FLOOR)
        squared = roughness * roughness
        lean = normal.dot(half)
        spread = lean * lean * (squared - 1.0) + 1.0
        lobe = squared / (tm.pi * spread * spread)
        lit = ti.max(cos_light, FLOOR)
        smith_light = lit * ti.sqrt(cos_view * cos_view * (1.0 - squared) + squared)
        smith_view = cos_view * ti.sqrt(lit * lit * (1.0 - squared) + squared)
        fresnel = schlick(view.dot(half), specular)
        highlight = lobe * fresnel * 0.5 / (smith_light + smith_view)
        total = (albedo * (1.0 - specular) / tm.pi + highlight) * cos_light
    return total
