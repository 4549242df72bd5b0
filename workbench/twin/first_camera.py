"""A design as a twin's photographs see it: by its first camera, in images of their size."""

from __future__ import annotations

import dataclasses

from workbench.core.design.design import SensorDesign


def seen_at(design: SensorDesign, width_px: int, height_px: int) -> SensorDesign:
    """A design with its first camera alone, whose images have a size [px]."""
    camera = dataclasses.replace(design.optics.camera, width_px=width_px, height_px=height_px)
    optics = dataclasses.replace(design.optics, camera=camera, cameras=())
    return dataclasses.replace(design, optics=optics)
