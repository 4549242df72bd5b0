"""Raspberry Pi Camera Module 2: 8 megapixels, its lens turns to focus from about 10 cm."""

from __future__ import annotations

from workbench.core.catalogue.camera_part import CameraPart

CAMERA = CameraPart(
    title="Raspberry Pi Camera Module 2",
    image_sensor="Sony IMX219",
    source="https://www.raspberrypi.com/documentation/accessories/camera.html",
    pixels=(3280, 2464),
    image_px=(1640, 1232),
    view_x_deg=62.2,
    view_y_deg=48.8,
    focal_mm=3.04,
    stop=2.0,
    sensor_width_mm=3.68,
    pixel_um=1.12,
    width_mm=25.0,
    height_mm=24.0,
    depth_mm=9.0,
)
