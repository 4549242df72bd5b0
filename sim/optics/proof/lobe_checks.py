"""What the coating and an LED do in each direction, against formulas written down a second time.

`microfacets` is the coating as Walter and others give it, in angles from the normal, where the
product works with scalar products in another arrangement:

    D(m) = a^2 / (pi cos^4 t (a^2 + tan^2 t)^2)                                   Eq. 33
    L(v) = (sqrt(1 + a^2 tan^2 v) - 1) / 2,  G = 1 / (1 + L(i) + L(o))
    f = rho (1 - F0) / pi + F D G / (4 cos i cos o),  F = F0 + (1 - F0) (1 - cos(i, m))^5

An LED of power P whose intensity falls as cos^m within a cone of half angle c sends out P in all,
and 1 - cos^(m + 1) w of it (over 1 - cos^(m + 1) c) within w of its axis.
Sources: Walter, Marschner, Li, Torrance, EGSR 2007; Heitz, JCGT 2014, Eq. 72 and 99; Schlick 1994.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from sim.optics.light.coating import glossy
from sim.optics.light.lobe import emitted
from sim.optics.proof.transport_scenes import BLACK, disc, one_light
from sim.optics.raster.image_sensor import kept_light
from sim.optics.transport.paths import Photons, trace_paths
from sim.optics.transport.scene import build_scene
from sim.optics.transport.sources import open_sources
from sim.optics.transport.tally import ledger_only
from workbench.core.design.camera import Camera, ImageSensor
from workbench.core.design.optics import Coating

Lobe = Callable[[Coating, np.ndarray, np.ndarray, np.ndarray], np.ndarray]
"""Of a coating, directions to the light, normals, directions to the eye: as `coating.glossy`."""
TILTS_DEG = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0)
TURNS_DEG = (0.0, 30.0, 90.0, 135.0, 180.0)
STEPS = 400
"""Of the quadratures in each angle; their error is below 1e-4 at a roughness of 0.2."""


def microfacets(coating: Coating, to_light: np.ndarray, to_eye: np.ndarray) -> np.ndarray:
    """f cos i [1/sr] of unit directions (N, 3) above a surface that faces +Z, shape (N,)."""
    facet = to_light + to_eye
    facet = facet / np.linalg.norm(facet, axis=1, keepdims=True)
    light, eye, lean = (
        np.arccos(np.clip(way[:, 2], -1.0, 1.0)) for way in (to_light, to_eye, facet)
    )
    width, facing = coating.roughness, coating.specular
    spread = width**2 + np.tan(lean) ** 2
    facets = width**2 / (np.pi * np.cos(lean) ** 4 * spread**2)
    hidden = sum((np.sqrt(1.0 + (width * np.tan(way)) ** 2) - 1.0) / 2.0 for way in (light, eye))
    half = np.arccos(np.clip(np.einsum("ij,ij->i", to_light, facet), -1.0, 1.0))
    fresnel = facing + (1.0 - facing) * (1.0 - np.cos(half)) ** 5
    mirrored = fresnel * facets / (1.0 + hidden) / (4.0 * np.cos(light) * np.cos(eye))
    return (coating.albedo * (1.0 - facing) / np.pi + mirrored) * np.cos(light)


def on_device(
    coating: Coating, to_light: np.ndarray, normal: np.ndarray, to_eye: np.ndarray
) -> np.ndarray:
    """The product's coating as its kernels compute it, in single precision; as `glossy`."""
    from sim.optics.light import device_arrays
    from sim.optics.proof.lobe_kernels import reflect_all

    found = device_arrays.on_device(np.zeros(len(to_light), dtype=np.float32))
    reflect_all(
        found,
        device_arrays.on_device(to_light, vector=3),
        device_arrays.on_device(to_eye, vector=3),
        device_arrays.on_device(normal, vector=3),
        coating.albedo,
        coating.specular,
        coating.roughness,
    )
    return found.to_numpy()


def lobe_error(coating: Coating, lobe: Lobe = glossy) -> float:
    """Largest relative difference [1] of the product's coating, over pairs of directions.

    Args:
        coating: Glossy: of reflectance 0.02 or more at normal incidence.
        lobe: Another one than the product's, to see what a wrong one gives.
    """
    to_light, to_eye, up = _pairs()
    exact = microfacets(coating, to_light, to_eye)
    return float(np.abs(lobe(coating, to_light, up, to_eye) / exact - 1.0).max())


def reciprocity_error(coating: Coating, lobe: Lobe = glossy) -> float:
    """Largest relative difference [1] of the coating's f with light and eye exchanged."""
    to_light, to_eye, up = _pairs()
    there = lobe(coating, to_light, up, to_eye) / to_light[:, 2]
    back = lobe(coating, to_eye, up, to_light) / to_eye[:, 2]
    return float(np.abs(there / back - 1.0).max())


def most_returned(coating: Coating, lobe: Lobe = glossy) -> float:
    """The largest share [1] of a beam that the coating returns, of beams at all tilts."""
    return max(returned(coating, math.radians(tilt_deg), lobe) for tilt_deg in TILTS_DEG)


def returned(coating: Coating, tilt: float, lobe: Lobe = glossy) -> float:
    """Share of a beam at a tilt from the normal that is returned into all directions [1].

    By the midpoint rule over half of the sphere of facets, where GGX is wide, not of directions.
    """
    lean = (np.arange(STEPS) + 0.5) / STEPS * math.pi / 2.0
    turn = (np.arange(STEPS) + 0.5) / STEPS * math.pi
    lean, turn = (grid.ravel() for grid in np.meshgrid(lean, turn, indexing="ij"))
    facet = np.column_stack(
        [np.sin(lean) * np.cos(turn), np.sin(lean) * np.sin(turn), np.cos(lean)]
    )
    light = np.array([math.sin(tilt), 0.0, math.cos(tilt)])
    along = facet @ light
    eye = 2.0 * along[:, None] * facet - light
    seen = (along > 0.0) & (eye[:, 2] > 0.0)
    facet, eye, along = facet[seen], eye[seen], along[seen]
    up = np.broadcast_to([0.0, 0.0, 1.0], eye.shape)
    to_light = np.broadcast_to(light, eye.shape).copy()
    cell = (math.pi / 2.0 / STEPS) * (2.0 * math.pi / STEPS) * np.sin(lean[seen])
    # A cell of facets mirrors the beam into 4 (i . m) times as much solid angle.
    value = lobe(coating, to_light, up, eye) / light[2] * eye[:, 2]
    return float((value * 4.0 * along * cell).sum())


def head_on_returned(coating: Coating) -> float:
    """What `returned` is at normal incidence, by a single integral over the facets' tilt t.

    The eye is at 2 t, all light of a facet ring passes G1(2 t):
    rho (1 - F0) + integral of 2 pi sin(2 t) / 2 D(t) G1(2 t) F(t) dt from 0 to 45 degrees.
    """
    lean = (np.arange(100 * STEPS) + 0.5) / (100 * STEPS) * math.pi / 4.0
    width, facing = coating.roughness, coating.specular
    spread = width**2 + np.tan(lean) ** 2
    facets = width**2 / (np.pi * np.cos(lean) ** 4 * spread**2)
    passing = 2.0 / (1.0 + np.sqrt(1.0 + (width * np.tan(2.0 * lean)) ** 2))
    fresnel = facing + (1.0 - facing) * (1.0 - np.cos(lean)) ** 5
    glossy_share = (np.pi * np.sin(2.0 * lean) * facets * passing * fresnel).mean() * math.pi / 4.0
    return coating.albedo * (1.0 - facing) + float(glossy_share)


def led_flux(exponent: float, cone_deg: float) -> float:
    """All power that an LED of power 1 sends through a sphere of 7 mm about it [1]: exactly 1."""
    cone, radius_mm = _half_cosine(cone_deg), 7.0
    cosine = cone + (1.0 - cone) * (np.arange(100_000) + 0.5) / 100_000
    sine = np.sqrt(1.0 - cosine**2)
    inward = -np.column_stack([sine, np.zeros_like(sine), cosine])
    away = np.full(len(cosine), radius_mm)
    axis = np.array([0.0, 0.0, 1.0])
    found = emitted(inward, away, axis=axis, exponent=exponent, cone=cone)
    return float(found.mean() * (1.0 - cone) * 2.0 * np.pi * radius_mm**2)


def led_share(exponent: float, cone_deg: float, within_deg: float, photons: int) -> float:
    """Share of an LED's photons that fly within an angle of its axis [1]."""
    skin = disc(5.0, 5.0 * math.tan(math.radians(within_deg)))
    scene = build_scene((skin.points_mm, skin.normals, skin.faces), None, coating=BLACK)
    leds = one_light(exponent=exponent, cone=_half_cosine(cone_deg))
    tally = ledger_only()
    trace_paths(scene, open_sources(leds, scene), tally, Photons(count=photons, seed=1))
    return tally.balance["absorbed"]


def exact_led_share(exponent: float, cone_deg: float, within_deg: float) -> float:
    """What `led_share` is: (1 - cos^(m + 1) w) / (1 - cos^(m + 1) c)."""
    near, far = math.cos(math.radians(within_deg)), _half_cosine(cone_deg)
    return (1.0 - near ** (exponent + 1.0)) / (1.0 - far ** (exponent + 1.0))


def vignetting_error(vignetting: float = 1.0) -> float:
    """Largest difference [1] of a pinhole's fall-off from cos^4, by the pixels' own distances.

    cos = f / sqrt(f^2 + d^2) at d pixels from the middle, f = width / (2 tan(fov / 2)).
    """
    camera = Camera(width_px=320, height_px=240, sensor=ImageSensor(vignetting=vignetting))
    row, column = np.mgrid[:240, :320]
    away = np.hypot(column - 159.5, row - 119.5)
    focal = 160.0 / math.tan(math.radians(camera.fov_x_deg / 2.0))
    exact = (focal**2 / (focal**2 + away**2)) ** 2
    return float(np.abs(kept_light(camera) - exact).max())


def _half_cosine(cone_deg: float) -> float:
    """Cosine of half a cone; exactly 0 for the half space."""
    return 0.0 if cone_deg >= 180.0 else math.cos(math.radians(cone_deg / 2.0))


def _pairs() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Directions to light and to eye at all pairs of tilts and turns, and +Z, (N, 3) each."""
    tilts, turns = np.radians(TILTS_DEG), np.radians(TURNS_DEG)
    light, eye, turn = (grid.ravel() for grid in np.meshgrid(tilts, tilts, turns, indexing="ij"))
    to_light = np.column_stack([np.sin(light), np.zeros_like(light), np.cos(light)])
    to_eye = np.column_stack([np.sin(eye) * np.cos(turn), np.sin(eye) * np.sin(turn), np.cos(eye)])
    return to_light, to_eye, np.broadcast_to([0.0, 0.0, 1.0], to_light.shape)
