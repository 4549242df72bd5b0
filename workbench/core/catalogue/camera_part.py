"""A camera module that can be bought. What no source says is None, and changes nothing.

A module is one file of `workbench.core.catalogue.cameras`. Makers give a field of view and a focal
length, not a projection: it is the one of pinhole and equidistant that fits the focal length for
the image's width w and the view a better, w / (2 tan(a / 2)) or w / a; else the one that fits the
second field of view; where neither is known, pinhole.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from workbench.core.base.records import records
from workbench.core.base.units import radians
from workbench.core.design.camera import LensModel


@dataclass(frozen=True, kw_only=True, slots=True)
class CameraPart:
    """What is known of a module."""

    title: str
    """As it is sold."""
    image_sensor: str
    source: str
    """Address that gives every value, but for those of `sources`."""
    sources: Mapping[str, str] = field(default_factory=dict[str, str])
    """Addresses of single fields."""
    pixels: tuple[int, int]
    """Width and height of the image sensor [px]."""
    image_px: tuple[int, int]
    """Width and height of the images taken here [px]: a mode that sees the whole field of view."""
    view_x_deg: float
    """Horizontal field of view of the whole image sensor [degree]."""
    view_y_deg: float | None = None
    focal_mm: float | None = None
    stop: float | None = None
    """Focal length over the diameter of the entrance pupil [1]."""
    sensor_width_mm: float | None = None
    """Width of the image that the lens throws on the sensor [mm]."""
    pixel_um: float | None = None
    width_mm: float | None = None
    """Module with its board, across the image's rows [mm]."""
    height_mm: float | None = None
    depth_mm: float | None = None
    """From the back of the board to the front of the lens [mm]."""
    full_well_e: float | None = None

    @property
    def lens(self) -> LensModel:
        """The projection that fits what is known."""
        half = 0.5 * radians(self.view_x_deg)
        width_mm = self._image_mm
        if self.focal_mm is not None and width_mm is not None:
            flat, even = 0.5 * width_mm / math.tan(half), 0.5 * width_mm / half
            known = self.focal_mm
        elif self.view_y_deg is not None:
            ratio = self.pixels[1] / self.pixels[0]
            flat, even = math.atan(ratio * math.tan(half)), ratio * half
            known = 0.5 * radians(self.view_y_deg)
        else:
            return LensModel.PINHOLE
        nearer = abs(math.log(flat / known)) <= abs(math.log(even / known))
        return LensModel.PINHOLE if nearer else LensModel.EQUIDISTANT

    @property
    def _image_mm(self) -> float | None:
        if self.sensor_width_mm is None and self.pixel_um is not None:
            return 1e-3 * self.pixel_um * self.pixels[0]
        return self.sensor_width_mm

    @property
    def pupil_mm(self) -> float | None:
        """Diameter of the entrance pupil [mm]."""
        if self.focal_mm is None or self.stop is None:
            return None
        return self.focal_mm / self.stop


def camera_parts() -> dict[str, CameraPart]:
    """All modules by name."""
    return records("workbench.core.catalogue.cameras", "CAMERA")
