"""A sensor beside another of the same design, at the price of a touch."""

from __future__ import annotations

import copy

from workbench.sensor.sensor import Sensor


def beside(sensor: Sensor) -> Sensor:
    """One that has touched nothing, with touches of its own; skin and light are the other's."""
    found, fast = copy.copy(sensor), copy.copy(sensor._fast)
    # Another number of presses takes arrays of its own.
    fast.reset(fast.presses + 1)
    found._fast = fast
    found.reset(1)
    return found
