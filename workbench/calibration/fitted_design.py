"""The design in the light that was fitted: what every other command then uses.

Powers are in units of the strongest light; the camera's exposure carries the rest. The albedo of
the coating scales all light alike, so photographs cannot tell it from power and exposure.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from workbench.calibration.light_sources import NO_RING
from workbench.calibration.powers import Powers
from workbench.core.design.design import SensorDesign
from workbench.core.design.lighting import Ambient, Lamp
from workbench.core.design.optics import BEST
from workbench.core.design.unit import Unit


def fitted_design(
    design: SensorDesign, lights: Sequence[Lamp], powers: Powers, *, ring: bool
) -> SensorDesign:
    """The design with fitted lights.

    Args:
        design: As given.
        lights: Those of `powers`.
        powers: Of each light and of the ambient.
        ring: Whether the first lights are the ring's, in its places: the ring then stays.
    """
    strongest = float(powers.lights.max())
    relative = powers.lights / strongest
    optics, count = design.optics, design.optics.ring.count if ring else 0
    leds = NO_RING
    if count:
        colours, sizes = zip(*(light_colour(relative[:, k]) for k in range(count)), strict=True)
        leds = dataclasses.replace(optics.ring, power=1.0, powers=sizes, colours=colours)
    lamps = []
    for number, lamp in enumerate(lights[count:], start=count):
        colour, power = light_colour(relative[:, number])
        lamps.append(dataclasses.replace(lamp, colour=colour, power=power))
    colour, power = light_colour(powers.ambient / strongest)
    sensor = dataclasses.replace(
        optics.camera.sensor, exposure=strongest, gain_dB=0.0, gain_rgb=(1.0, 1.0, 1.0)
    )
    return dataclasses.replace(
        design,
        optics=dataclasses.replace(
            optics,
            ring=leds,
            lamps=tuple(lamps),
            ambient=Ambient(colour=colour, power=power),
            camera=dataclasses.replace(optics.camera, sensor=sensor),
            light_model=BEST,
            background=None,
            unit=None,
        ),
    )


def with_unit(design: SensorDesign, unit: Unit) -> SensorDesign:
    """The design as the one built sensor."""
    return dataclasses.replace(design, optics=dataclasses.replace(design.optics, unit=unit))


def light_colour(rgb: np.ndarray) -> tuple[str, float]:
    """Linear light as `#rrggbb` and a power; black has power 0."""
    power = float(rgb.max(initial=0.0))
    if power <= 0.0:
        return "#ffffff", 0.0
    red, green, blue = (round(255.0 * value / power) for value in rgb)
    return f"#{red:02x}{green:02x}{blue:02x}", power
