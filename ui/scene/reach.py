"""The range of the slider that moves the section: that of what is on show along the axis.

Parts that stand apart reach farther than the sensor. The place of the cut that the sensor had comes
back with it.
"""

from __future__ import annotations

from typing import Any

from workbench.view.section_cut import Axis


class Reach:
    """The range of one slider."""

    def __init__(self, slider: Any) -> None:
        self.slider = slider
        self._before: tuple[Axis, float] | None = None
        """Axis and place of the cut before parts came on show [mm]; None while none are."""

    def fit(self, low_mm: float, high_mm: float, *, axis: Axis, parts: bool) -> None:
        """Give the slider a range; its value stays where it can.

        Args:
            low_mm: Lowest place of what is on show along the axis.
            high_mm: Highest place.
            axis: The axis that is square to the cut.
            parts: Whether parts are on show, in place of the sensor.
        """
        value = float(self.slider.value)
        if parts and self._before is None:
            self._before = (axis, value)
        elif not parts and self._before is not None:
            value = self._before[1] if self._before[0] is axis else value
            self._before = None
        low, high = round(low_mm, 1), round(high_mm, 1)
        if high <= low:
            return
        value = min(max(value, low), high)
        slider = self.slider
        if (slider.min, slider.max) != (low, high):
            # A value is never outside the range, whichever of the three is set first.
            slider.min, slider.max = min(low, slider.value, value), max(high, slider.value, value)
            slider.value = value
            slider.min, slider.max = low, high
        elif slider.value != value:
            slider.value = value
