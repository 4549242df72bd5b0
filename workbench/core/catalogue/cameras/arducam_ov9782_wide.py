"""Arducam OV9782 with a fisheye on a board of Luxonis: colour, global shutter."""

from __future__ import annotations

from workbench.core.catalogue.camera_part import CameraPart

CAMERA = CameraPart(
    title="Luxonis OAK-FFC-OV9782-W",
    image_sensor="OmniVision OV9782",
    source="https://docs.luxonis.com/hardware/products/OAK-FFC-OV9782-W.md",
    pixels=(1280, 800),
    image_px=(1280, 800),
    view_x_deg=127.0,
    view_y_deg=79.5,
)
