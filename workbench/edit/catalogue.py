"""Bought cameras and LEDs in a design: what is known of one becomes fields, the rest stays.

A camera sets pixels, field of view, projection, pupil and full well, and as the first one the room
of its module in the housing. LEDs set the ring's colours in the order of its sectors, its lobe, and
the room of an LED. Brightness stays as it is: makers give it as the eye sees it.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.core.catalogue.camera_part import CameraPart, camera_parts
from workbench.core.catalogue.led_part import LedPart, led_parts
from workbench.core.design.camera import Camera
from workbench.core.design.design import SensorDesign
from workbench.core.design.lighting import LedRing


def with_camera(design: SensorDesign, name: str, *, number: int = 1) -> SensorDesign:
    """The design with a camera of the catalogue.

    Args:
        design: The design.
        name: Of the catalogue.
        number: Of the camera that it takes the place of, from 1; place and direction stay.

    Raises:
        DesignError: If there is no such camera.
    """
    part = _part(camera_parts(), name, "camera", at="--camera")
    path = "optics.camera" if number == 1 else "optics.cameras"
    cameras = list(design.optics.all_cameras)
    cameras[number - 1] = taken(cameras[number - 1], part)
    found = design.replace(path, cameras[0] if number == 1 else tuple(cameras[1:]))
    if number > 1:
        return found
    room = {
        "camera_width_mm": part.width_mm,
        "camera_height_mm": part.height_mm,
        "camera_depth_mm": part.depth_mm,
    }
    return dataclasses.replace(found, housing=_known(found.housing, room))


def taken(camera: Camera, part: CameraPart) -> Camera:
    """A camera with what is known of a module."""
    width_px, height_px = part.image_px
    found = dataclasses.replace(
        camera,
        width_px=width_px,
        height_px=height_px,
        fov_x_deg=part.view_x_deg,
        lens=part.lens,
        distortion=(),
    )
    sensor = _known(found.sensor, {"full_well_e": part.full_well_e})
    return _known(found, {"aperture_mm": part.pupil_mm, "sensor": sensor})


def with_leds(design: SensorDesign, names: Sequence[str]) -> SensorDesign:
    """The design with LEDs of the catalogue, one for each sector of the ring or one for all.

    The ring has one lobe, and the housing one room: of several LEDs the mean, and the largest.

    Raises:
        DesignError: If there is no such LED.
    """
    parts = [_part(led_parts(), name, "LED", at="--led") for name in names]
    ring = lit(design.optics.ring, parts)
    room = {
        "led_width_mm": _largest([part.width_mm for part in parts]),
        "led_height_mm": _largest([part.height_mm for part in parts]),
    }
    found = design.replace("optics.ring", ring)
    return dataclasses.replace(found, housing=_known(found.housing, room))


def lit(ring: LedRing, parts: Sequence[LedPart]) -> LedRing:
    """A ring with what is known of LEDs."""
    colours = tuple(colour for part in parts for colour in part.colours)
    exponents = [part.exponent for part in parts if part.exponent is not None]
    mean = math.fsum(exponents) / len(exponents) if exponents else None
    return _known(ring, {"colours": colours or None, "emission_exponent": mean})


def camera_name(camera: Camera) -> str:
    """The module of the catalogue whose numbers a camera has; "" for none."""
    return next(
        (name for name, part in camera_parts().items() if taken(camera, part) == camera), ""
    )


def led_name(ring: LedRing) -> str:
    """The LED of the catalogue whose numbers a ring has; "" for none."""
    known = {name: part for name, part in led_parts().items() if part.colours}
    return next((name for name, part in known.items() if lit(ring, [part]) == ring), "")


def _known(owner: Any, values: Mapping[str, Any]) -> Any:
    """The same with those values that there are."""
    return dataclasses.replace(owner, **{k: v for k, v in values.items() if v is not None})


def _largest(sizes_mm: Sequence[float | None]) -> float | None:
    return max((size for size in sizes_mm if size is not None), default=None)


def _part(parts: Mapping[str, Any], name: str, what: str, *, at: str) -> Any:
    if name not in parts:
        raise DesignError(
            f"the catalogue has no {what} {shown(name)}",
            hint=f"{suggest(name, list(parts))}; docs/parts.md lists all",
            at=at,
        )
    return parts[name]
