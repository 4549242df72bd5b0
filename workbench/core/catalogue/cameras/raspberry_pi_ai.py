"""Raspberry Pi AI Camera: 12 megapixels, its lens turns to focus from about 20 cm."""

from __future__ import annotations

from workbench.core.catalogue.camera_part import CameraPart

CAMERA = CameraPart(
    title="Raspberry Pi AI Camera",
    image_sensor="Sony IMX500",
    source="https://www.raspberrypi.com/documentation/accessories/camera.html",
    pixels=(4056, 3040),
    image_px=(2028, 1520),
    view_x_deg=66.0,
    view_y_deg=52.3,
    focal_mm=4.74,
    stop=1.79,
    sensor_width_mm=6.287,
    pixel_um=1.55,
    width_mm=25.0,
    height_mm=24.0,
    depth_mm=11.9,
)
