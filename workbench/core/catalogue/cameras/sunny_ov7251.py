"""Sunny PY013: a small grey module with a global shutter, of the OAK-D-Lite."""

from __future__ import annotations

from workbench.core.catalogue.camera_part import CameraPart

CAMERA = CameraPart(
    title="Sunny PY013",
    image_sensor="OmniVision OV7251",
    source="https://docs.luxonis.com/projects/hardware/en/latest/pages/articles/sensors/ov7251/",
    pixels=(640, 480),
    image_px=(640, 480),
    view_x_deg=73.0,
    view_y_deg=58.0,
    focal_mm=1.24,
    stop=2.0,
    pixel_um=3.0,
)
