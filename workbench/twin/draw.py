"""A twin: the sensor that somebody built from a design, with parameters that nobody knows.

Each is off from the design's by chance, drawn evenly, or evenly in the logarithm for a factor.
Source of the amounts: our choice for a sensor that is cast and assembled by hand; those of lights
and camera are those of `workbench.learning.dataset.variation.Looks`.

Twins draw from streams of their own: `SeedSequence(seed, spawn_key=(STREAM, what))`. NumPy pads the
seed to its pool before it appends a spawn key, so that no seed without one, such as those of data
sets, which are three numbers at most, can come to the same stream.
Source: numpy/random/bit_generator.pyx, `SeedSequence.get_assembled_entropy`.
"""

from __future__ import annotations

import dataclasses
import enum
import math
from dataclasses import dataclass

import numpy as np

from workbench.core.base.check import within
from workbench.core.base.mapping import to_table
from workbench.core.design.camera import Camera
from workbench.core.design.design import Elastomer, Layers, SensorDesign
from workbench.core.design.imported import IMPORTED
from workbench.core.design.optics import Coating
from workbench.learning.dataset.looks import assembled
from workbench.learning.dataset.variation import Looks

STREAM = 0x7717
"""Spawn key of all that twins draw."""
YOUNG_SHARE = 0.2
"""Of Young's modulus, and of a gel's behind the skin [1]."""
FRICTION, LEAST_FRICTION = 0.2, 0.05
WALL_MM = 0.15
"""Thickness of the elastomer [mm]."""
LEAST_WALL_MM = 0.2
COATING_FACTOR = 1.3
"""By which albedo, gloss and roughness are off at most [1]: a spray can or a brush, not another
ink."""
MOST_REFLECTED = 0.95
"""Albedo and gloss together."""
FALLOFF = 0.2
"""By which the lens keeps less light at the corner, at most [1]."""
EXPOSURE = (0.8, 1.0)
"""Over the exposure that suits the image at rest [1]."""
BALL_MM = 0.05
"""Diameter of a printed ball [mm]."""
LAYER_MM = 0.1
"""Height of a printed layer [mm]."""


class Draws(enum.IntEnum):
    """What is drawn, each from a stream of its own, so that none moves another."""

    SENSOR = 0
    PLACES = 1
    PRESSES = 2
    SLIDES = 3
    PHOTONS = 4
    STAGE = 5


@dataclass(frozen=True, kw_only=True, slots=True)
class Twin:
    """One built sensor, and the ball that its builder has."""

    seed: int
    design: SensorDesign
    """With hidden values in the place of the design's own."""
    exposure_factor: float
    """Over the exposure that suits the image at rest [1]."""
    ball_error_mm: float
    """Of the diameter of the printed balls [mm]."""
    layer_mm: float = LAYER_MM
    """Height of the balls' printed layers [mm]."""


def stream(seed: int, draws: Draws, number: int = 0) -> np.random.Generator:
    """The random numbers of one kind, and of one case of it."""
    return np.random.default_rng(
        np.random.SeedSequence(seed, spawn_key=(STREAM, int(draws), number))
    )


def draw_twin(design: SensorDesign, seed: int) -> Twin:
    """The twin of a design by its seed.

    The wall of a body from a file stays as it is: it is the file's.

    Raises:
        DesignError: If the seed is negative, or a drawn value leaves what a design may be.
    """
    within(seed, 0, 2**31, what="seed of a twin", unit="", at="--seed")
    rng = stream(seed, Draws.SENSOR)
    material, layers = _material(design.material, rng), _layers(design.layers, rng)
    optics = assembled(design.optics, Looks(), rng)
    coating, camera = _coating(optics.coating, rng), _camera(optics.camera, rng)
    optics = dataclasses.replace(
        optics, coating=coating, camera=camera, cameras=(), background=None, unit=None
    )
    return Twin(
        seed=seed,
        design=dataclasses.replace(
            design,
            material=material,
            layers=design.layers if design.family == IMPORTED else layers,
            optics=optics,
        ),
        exposure_factor=round(float(rng.uniform(*EXPOSURE)), 6),
        ball_error_mm=round(float(rng.uniform(-BALL_MM, BALL_MM)), 6),
    )


def card(twin: Twin, design: SensorDesign) -> dict[str, object]:
    """What is hidden, as plain tables, beside the design's own values."""
    optics = twin.design.optics
    return {
        "seed": twin.seed,
        "young_MPa": _pair(design.material.young_MPa, twin.design.material.young_MPa),
        "friction": _pair(design.material.friction, twin.design.material.friction),
        "wall_mm": _pair(design.layers.elastomer_mm, twin.design.layers.elastomer_mm),
        "albedo": _pair(design.optics.coating.albedo, optics.coating.albedo),
        "specular": _pair(design.optics.coating.specular, optics.coating.specular),
        "roughness": _pair(design.optics.coating.roughness, optics.coating.roughness),
        "fov_x_deg": _pair(design.optics.camera.fov_x_deg, optics.camera.fov_x_deg),
        "exposure_factor": twin.exposure_factor,
        "ball_error_mm": twin.ball_error_mm,
        "layer_mm": twin.layer_mm,
        "camera": to_table(optics.camera),
        "ring": to_table(optics.ring),
        "lamps": to_table(optics.lamps),
    }


def _pair(told: float, hidden: float) -> dict[str, float]:
    return {"design": told, "hidden": hidden}


def _material(material: Elastomer, rng: np.random.Generator) -> Elastomer:
    stiffer = 1.0 + float(rng.uniform(-YOUNG_SHARE, YOUNG_SHARE))
    rubs = float(rng.uniform(-FRICTION, FRICTION))
    friction = round(max(LEAST_FRICTION, material.friction + rubs), 6)
    kinetic = material.kinetic_friction
    return dataclasses.replace(
        material,
        young_MPa=round(stiffer * material.young_MPa, 9),
        backing_MPa=round(stiffer * material.backing_MPa, 9),
        friction=friction,
        kinetic_friction=None if kinetic is None else min(kinetic, friction),
    )


def _layers(layers: Layers, rng: np.random.Generator) -> Layers:
    wall_mm = layers.elastomer_mm + float(rng.uniform(-WALL_MM, WALL_MM))
    return dataclasses.replace(layers, elastomer_mm=round(max(LEAST_WALL_MM, wall_mm), 6))


def _coating(coating: Coating, rng: np.random.Generator) -> Coating:
    most = math.log(COATING_FACTOR)
    by_albedo, by_gloss, by_roughness = np.exp(rng.uniform(-most, most, 3))
    albedo, specular = coating.albedo * by_albedo, coating.specular * by_gloss
    fits = min(1.0, MOST_REFLECTED / max(albedo + specular, 1e-9))
    return dataclasses.replace(
        coating,
        albedo=round(float(fits * albedo), 6),
        specular=round(float(fits * specular), 6),
        roughness=round(float(min(1.0, max(0.02, coating.roughness * by_roughness))), 6),
    )


def _camera(camera: Camera, rng: np.random.Generator) -> Camera:
    k1, k2, k3 = camera.sensor.falloff
    darker = round(float(rng.uniform(0.0, FALLOFF)), 6)
    sensor = dataclasses.replace(
        camera.sensor,
        falloff=(k1 - darker, k2, k3),
        noise=True,
        seed=int(rng.integers(2**31)),
    )
    return dataclasses.replace(camera, sensor=sensor)
