"""The pad whose photographs are calibrated to: six LEDs in three colours, a small camera."""

from __future__ import annotations

import workbench as wb


def photographed_pad(width_px: int, height_px: int, photons: int) -> wb.Design:
    """The flat pad with a camera of so many pixels, lit by so many photons."""
    found = wb.load("pad")
    for field, value in {
        "optics.camera.width_px": width_px,
        "optics.camera.height_px": height_px,
        "optics.ring.count": 6,
        "optics.ring.powers": (),
        "optics.ring.colours": ("#ff0000", "#00ff00", "#0000ff"),
        "optics.lamps": (),
        "optics.baking.photons": photons,
    }.items():
        found = found.replace(field, value)
    return found
