"""Efficiency: the nine frame rates that the paper reports, measured here in the same sizes.

A frame of the deformation is a substep of the whole finger, as in the paper's released code; one of
the optics an image of a travelling dent by looked-up light; one of the network a force field by the
published network, as the browser asks for it. Nothing is asked of them: the rooms `contact`,
`optics` and `forces` have the limits.
"""

from __future__ import annotations

import functools

from workbench.core.design.lighting import LightModel
from workbench.proof.benchmarks import contact, forces, optics
from workbench.proof.row import Row, stated

PARTICLES = {"40K": "deformation_40k", "300K": "deformation_300k", "1.3M": "deformation_1300k"}
WIDTHS_PX = (320, 640, 1280)
NETWORK = "paper"


def rows() -> list[Row]:
    """All rows of the room."""
    return [*deformation_rows(), *image_rows(), *network_rows()]


def deformation_rows() -> list[Row]:
    """Substeps in a second."""
    from workbench.pipeline.devices import open_device

    device = open_device()
    found = []
    for name, grid_mm, _, _ in contact.SUBSTEPS:
        relaxation, particles = contact.whole_finger(grid_mm)
        case = f"substeps of the whole finger, {particles} particles, {device}"
        pace = functools.partial(lambda engine: 1.0 / contact.substep_s(engine), relaxation)
        found.append(stated(PARTICLES[name], case, pace, unit="1/s"))
    return found


def image_rows() -> list[Row]:
    """Images in a second."""
    from workbench.pipeline.devices import open_device

    device = open_device()
    return [
        stated(
            f"image_{width_px}",
            f"images of {width_px} x {width_px * 3 // 4}, light by table, {device}",
            functools.partial(optics.video_fps, LightModel("table"), width_px),
            unit="1/s",
        )
        for width_px in WIDTHS_PX
    ]


def network_rows() -> list[Row]:
    """Force fields in a second."""
    return [
        stated(f"network_{found.name}", found.case, found.fps, unit="1/s")
        for found in forces.paces(NETWORK)
    ]
