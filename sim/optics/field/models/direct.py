"""Direct light and shadows: a straight line with 1/r^2, the LED's lobe, and a GGX coating."""

from __future__ import annotations

import numpy as np

from sim.optics.field.lines import toward, unshadowed
from sim.optics.field.model import Baked, Lights, Model, Shading
from sim.optics.light.lobe import emitted
from workbench.core.base.monitor import Monitor


def bake(lights: Lights, monitor: Monitor) -> Baked:
    """Irradiance of what the undeformed skin does not hide."""
    skin, leds = lights.mesh.seen, lights.leds
    count = len(leds.position_mm)
    direction = np.empty((count, len(skin.points_mm), 3), dtype=np.float32)
    irradiance = np.empty(direction.shape[:2], dtype=np.float32)
    for number, place in enumerate(leds.position_mm):
        monitor(number / count, f"light {number + 1} of {count}")
        straight, distance_mm = toward(place, skin.points_mm, at=lights.fields[number])
        direction[number] = straight
        irradiance[number] = emitted(
            straight,
            distance_mm,
            axis=leds.axis[number],
            exponent=float(leds.exponent[number]),
            cone=float(leds.cone[number]),
        )
    irradiance *= unshadowed(lights.mesh, leds.position_mm, monitor)
    return Baked(direction=direction, irradiance=irradiance)


MODEL = Model(
    place=5,
    hint="1/r², shadows and gloss, no scattered light; quick",
    shading=Shading.DIRECT,
    bake=bake,
    quick=True,
)
