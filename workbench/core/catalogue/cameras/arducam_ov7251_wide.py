"""Arducam PY030: a small grey module with a fisheye and a global shutter."""

from __future__ import annotations

from workbench.core.catalogue.camera_part import CameraPart

CAMERA = CameraPart(
    title="Arducam PY030",
    image_sensor="OmniVision OV7251",
    source="https://docs.luxonis.com/projects/hardware/en/latest/pages/articles/sensors/ov7251/",
    pixels=(640, 480),
    image_px=(640, 480),
    view_x_deg=163.0,
    focal_mm=0.83,
    stop=2.0,
    pixel_um=3.0,
)
