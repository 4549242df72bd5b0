"""ST VS6624: a cube of 8 mm with its lens, 1.3 megapixels, fixed focus."""

from __future__ import annotations

from workbench.core.catalogue.camera_part import CameraPart

CAMERA = CameraPart(
    title="STMicroelectronics VS6624",
    image_sensor="VS6624",
    source="http://artsdocbox.com/Television/72232998-Description-july-2007-rev-7-1-106.html",
    pixels=(1280, 1024),
    image_px=(1280, 1024),
    view_x_deg=52.0,
    stop=3.2,
    pixel_um=3.0,
    width_mm=8.0,
    height_mm=8.0,
    depth_mm=6.1,
)
