"""Traced light against closed forms: each check returns what was found, and what is exact.

Each scene is small enough for a closed form. Differences are relative unless a unit says
otherwise. With N photons counted the standard error of a share p is sqrt(p (1 - p) / N); the
emission's lattice mostly stays well below that.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from sim.optics.light.bins import bin_cosines
from sim.optics.light.lights import Leds
from sim.optics.proof.checks import exact_transmittance
from sim.optics.proof.lobe_checks import microfacets
from sim.optics.proof.transport_scenes import (
    BLACK,
    beam,
    disc,
    disc_source,
    one_light,
    plane,
    sphere,
)
from sim.optics.transport.constants import FIXED_POINT
from sim.optics.transport.gather import scattered_light, virtual_lights
from sim.optics.transport.nodes import coarse_nodes
from sim.optics.transport.paths import Photons, trace_paths
from sim.optics.transport.scene import Scene, build_scene
from sim.optics.transport.sources import open_sources
from sim.optics.transport.tally import ledger_only, tally_at_nodes
from workbench.core.design.optics import Coating
from workbench.core.result.light import AZIMUTHS, Scattered
from workbench.core.result.results import Skin


def furnace_error(*, albedo: float = 0.5, photons: int = 1_000_000) -> float:
    """Closed matte sphere with a light off its centre: worst irradiance of scattered light.

    Whatever a Lambertian sphere scatters falls evenly on all of it, so the light of all orders but
    the first gives E = P albedo / (A (1 - albedo)) everywhere: together with the first, the mean
    is (P / A) / (1 - albedo). Measured on eight octants. Nodes on a curved skin lose the cosine of
    the angle between their own normal and its surroundings', 0.1 % here.
    """
    skin = sphere(10.0, 4)
    scene = build_scene(_raw(skin), None, coating=Coating(albedo=albedo, specular=0.0))
    leds = one_light(position_mm=(3.0, 2.0, -1.0), exponent=0.0, size_mm=0.5)
    scattered, nodes_mm, area_mm2 = _gathered(scene, skin, leds, photons, count=len(skin.points_mm))
    cosines = np.repeat(bin_cosines(), AZIMUTHS)
    received = scattered.rest[:, 0] @ cosines * area_mm2
    octant = (nodes_mm > 0.0) @ np.array([1, 2, 4])
    found = np.bincount(octant, received, 8) / np.bincount(octant, area_mm2, 8)
    exact = albedo / (1.0 - albedo) / area_mm2.sum()
    return float(np.abs(found / exact - 1.0).max())


def flat_furnace(coating: Coating, *, photons: int = 200_000) -> tuple[float, float]:
    """Share of even hemispherical light that a flat patch returns: traced, and exact.

    Exact is the quadrature of `lobe_checks.microfacets` over all pairs of directions; of a matte
    coating its albedo.
    """
    skin = plane(1.0, 1000.0, 2)
    scene = build_scene(_raw(skin), None, coating=coating)
    balance = _ledger(scene, one_light(exponent=1.0), photons)
    return 1.0 - balance["absorbed"], _returned(coating)


def _returned(coating: Coating, steps: int = 64) -> float:
    """Double hemisphere integral of f cos cos / pi, by the midpoint rule in squared sines."""
    if coating.specular == 0.0:
        return coating.albedo
    squared = (np.arange(steps) + 0.5) / steps
    azimuth = np.pi * (np.arange(steps) + 0.5) / steps
    sine = np.sqrt(squared)
    total = 0.0
    for incoming in squared:
        light = np.array([math.sqrt(incoming), 0.0, math.sqrt(1.0 - incoming)])
        x = sine[:, None] * np.cos(azimuth)
        y = sine[:, None] * np.sin(azimuth)
        z = np.broadcast_to(np.sqrt(1.0 - squared)[:, None], x.shape)
        view = np.stack([x, y, z], axis=-1).reshape(-1, 3)
        lobe = microfacets(coating, np.broadcast_to(light, view.shape), view) / light[2]
        total += float(np.mean(lobe)) * math.pi / steps
    return total


def reciprocity(
    *,
    radii_mm: tuple[float, float] = (3.0, 5.0),
    distance_mm: float = 4.0,
    photons: int = 400_000,
) -> tuple[float, float, float]:
    """Two coaxial discs: A1 F12 and A2 F21 traced, and A1 F12 exact [mm2].

    F12 = (x - sqrt(x^2 - 4 (R2 / R1)^2)) / 2, x = 1 + (1 + R2^2) / R1^2, Ri = ri / distance.
    Source: Howell, catalog of radiation configuration factors, C-41.
    """
    found = []
    for near_mm, far_mm in (radii_mm, radii_mm[::-1]):
        scene = build_scene(_raw(disc(distance_mm, far_mm)), None, coating=BLACK)
        source = disc_source(near_mm)
        tally = ledger_only()
        trace_paths(scene, source, tally, Photons(count=photons, seed=1))
        found.append(tally.balance["absorbed"] * math.pi * near_mm**2)
    one, two = (radius / distance_mm for radius in radii_mm)
    x = 1.0 + (1.0 + two**2) / one**2
    factor = 0.5 * (x - math.sqrt(x**2 - 4.0 * (two / one) ** 2))
    return found[0], found[1], factor * math.pi * radii_mm[0] ** 2


def plane_irradiance_error(*, exponent: float = 1.0, photons: int = 1_000_000) -> float:
    """An LED straight under a plane: rms difference of irradiance over its mean, within 45 degrees.

    E = (m + 1) / (2 pi) cos^(m + 1) / r^2.
    """
    skin = plane(5.0, 12.0, 24)
    scene = build_scene(_raw(skin), None, coating=BLACK)
    leds = one_light(exponent=exponent)
    direction, irradiance = _virtual(scene, skin, leds, photons)
    points = skin.points_mm
    near = np.hypot(points[:, 0], points[:, 1]) < 5.0
    found = irradiance[near] * direction[near, 2] * -1.0
    square = (points[near] ** 2).sum(axis=1)
    cosine = points[near, 2] / np.sqrt(square)
    exact = (exponent + 1.0) / (2.0 * np.pi) * cosine ** (exponent + 1.0) / square
    return float(np.sqrt(np.mean((found - exact) ** 2)) / exact.mean())


def refraction_errors(
    *, refractive_index: float = 1.41, photons: int = 100_000
) -> tuple[float, float]:
    """Light into a slab at 0 to 80 degrees: worst differences from Fresnel and from Snell.

    Of the transmittance [1], and of the direction inside [degree].
    """
    skin, wall = plane(5.0, 200.0, 40), plane(1.0, 200.0, 2)
    scene = build_scene(_raw(skin), _raw(wall), coating=BLACK, refractive_index=refractive_index)
    worst_share, worst_deg = 0.0, 0.0
    for angle_deg in (0.0, 30.0, 60.0, 80.0):
        angle = np.radians([angle_deg])
        (share,) = exact_transmittance(angle, 1.0, refractive_index)
        sine = math.sin(angle[0]) / refractive_index
        bent = np.array([sine, 0.0, math.sqrt(1.0 - sine**2)])
        balance, mean = _ledger_and_mean(scene, skin, beam(angle_deg), photons)
        worst_share = max(worst_share, abs(balance["absorbed"] - share))
        cosine = float(np.clip(-mean @ bent, -1.0, 1.0))
        worst_deg = max(worst_deg, math.degrees(math.acos(cosine)))
    return float(worst_share), worst_deg


def total_reflection_error(*, refractive_index: float = 1.41, photons: int = 100_000) -> float:
    """From the solid to air at 20, 40 and 60 degrees: worst difference of the reflectance [1].

    Beyond the critical angle, 45.2 degrees at index 1.41, all light must return.
    """
    skin, wall = plane(5.0, 200.0, 2), plane(1.0, 200.0, 2)
    scene = build_scene(_raw(skin), _raw(wall), coating=BLACK, refractive_index=refractive_index)
    worst = 0.0
    for angle_deg in (20.0, 40.0, 60.0):
        leds = dataclasses.replace(
            beam(angle_deg), position_mm=np.array([[0.0, 0.0, 2.0]]), in_shell=np.array([True])
        )
        leds = dataclasses.replace(leds, axis=leds.axis * [1.0, 1.0, -1.0])
        (share,) = exact_transmittance(np.radians([angle_deg]), refractive_index, 1.0)
        reflected = _ledger(scene, leds, photons)["absorbed"]
        worst = max(worst, abs(reflected - (1.0 - share)))
    return float(worst)


def _raw(skin: Skin) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return skin.points_mm, skin.normals, skin.faces


def _ledger(scene: Scene, leds: Leds, photons: int) -> dict[str, float]:
    tally = ledger_only()
    trace_paths(scene, open_sources(leds, scene), tally, Photons(count=photons, seed=1))
    return tally.balance


def _gathered(
    scene: Scene, skin: Skin, leds: Leds, photons: int, *, count: int
) -> tuple[Scattered, np.ndarray, np.ndarray]:
    """Scattered light at about `count` nodes, their places [mm] and areas [mm2]."""
    nodes = coarse_nodes(skin, count)
    sources = open_sources(leds, scene)
    tally = tally_at_nodes(nodes, sources.count)
    trace_paths(scene, sources, tally, Photons(count=photons, seed=1))
    return scattered_light(nodes, sources, tally), nodes.points_mm, nodes.area_mm2


def _virtual(scene: Scene, skin: Skin, leds: Leds, photons: int) -> tuple[np.ndarray, np.ndarray]:
    """Direction (V, 3) and irradiance (V,) of the one virtual light at the vertices, unsmoothed."""
    nodes = coarse_nodes(skin, len(skin.points_mm))
    sources = open_sources(leds, scene)
    tally = tally_at_nodes(nodes, sources.count)
    trace_paths(scene, sources, tally, Photons(count=photons, seed=1))
    direction, irradiance = virtual_lights(nodes, sources, tally, skin.points_mm, smoothings=0)
    return direction[0], irradiance[0]


def _ledger_and_mean(
    scene: Scene, skin: Skin, leds: Leds, photons: int
) -> tuple[dict[str, float], np.ndarray]:
    """Balance, and the mean unit direction to where unscattered light comes from."""
    nodes = coarse_nodes(skin, len(skin.points_mm))
    sources = open_sources(leds, scene)
    tally = tally_at_nodes(nodes, sources.count)
    trace_paths(scene, sources, tally, Photons(count=photons, seed=1))
    mean = tally.lamps[:, 0, :3].sum(axis=0) / FIXED_POINT
    return tally.balance, mean / np.linalg.norm(mean)
