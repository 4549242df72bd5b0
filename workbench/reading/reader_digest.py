"""What of a design matters to a learned reader: a change of it asks for another one."""

from __future__ import annotations

import dataclasses

from designs.family import resolve_shape
from sim.reading.network.spec import COLUMNS
from workbench.core.base.digest import digest
from workbench.core.design.design import SensorDesign


def reader_digest(design: SensorDesign) -> str:
    """Key of shape, layers, material, mesh, and of what its first camera sees, in any size.

    Neither names nor what only concerns making the sensor take part.
    """
    camera = design.optics.camera
    rows = round(COLUMNS * camera.height_px / camera.width_px)
    seen = dataclasses.replace(camera, width_px=COLUMNS, height_px=rows)
    optics = dataclasses.replace(design.optics, camera=seen, cameras=())
    shape = design.shape if design.body else resolve_shape(design.family, design.shape)
    return digest(
        [design.family, shape, design.body, design.layers, design.material, optics, design.meshing]
    )
