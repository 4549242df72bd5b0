"""Raspberry Pi Camera Module 3: 12 megapixels, a motor focuses from about 10 cm."""

from __future__ import annotations

from workbench.core.catalogue.camera_part import CameraPart

CAMERA = CameraPart(
    title="Raspberry Pi Camera Module 3",
    image_sensor="Sony IMX708",
    source="https://www.raspberrypi.com/documentation/accessories/camera.html",
    pixels=(4608, 2592),
    image_px=(2304, 1296),
    view_x_deg=66.0,
    view_y_deg=41.0,
    focal_mm=4.74,
    stop=1.8,
    sensor_width_mm=6.45,
    pixel_um=1.4,
    width_mm=25.0,
    height_mm=24.0,
    depth_mm=11.5,
)
