"""Baking of models that trace photons once, for the undeformed skin."""

from __future__ import annotations

from sim.optics.field.model import Baked, Lights
from workbench.core.base.monitor import Monitor


def gathered(lights: Lights, monitor: Monitor) -> Baked:
    """Unscattered light of each LED, and what is scattered at the nodes of the skin.

    Raises:
        ValueError: If nothing is known of what the photons meet.
    """
    from sim.optics.transport.gather import gather_light

    if lights.transport is None:
        raise ValueError("traced light needs to know what the photons meet")
    direction, irradiance, scattered = gather_light(
        lights.mesh, lights.leds, lights.transport, monitor=monitor
    )
    return Baked(direction=direction, irradiance=irradiance, scattered=scattered)
