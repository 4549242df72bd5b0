"""Efficiency: the nine frame rates that the paper reports, measured here in the same sizes.

The paper's own figure is each row's reference, from its own machine (`paces`). A frame of the
deformation is a substep of the whole finger, as in the paper's released code; beside it stand
presses of the same finger until forces balance, one at a time, regions prepared before. A frame of
the optics is an image of a travelling dent by looked-up light; one of the network a force field by
the published network, as the browser asks for it; beside it one of the small network around a dent,
as the source `learned` asks for it. Nothing is asked of them: the rooms `contact`, `optics` and
`forces` have the limits.
"""

from __future__ import annotations

import functools

from workbench.core.design.lighting import LightModel
from workbench.proof.benchmarks import contact, forces, optics
from workbench.proof.benchmarks.paces import published_fps
from workbench.proof.row import Measurement, Row, stated

PARTICLES = {"40K": "40k", "300K": "300k", "1.3M": "1300k"}
WIDTHS_PX = (320, 640, 1280)
NETWORK = "paper"


def rows() -> list[Row]:
    """All rows of the room."""
    return [*deformation_rows(), *press_rows(), *image_rows(), *network_rows()]


def _row(name: str, case: str, pace: Measurement) -> Row:
    return stated(name, case, pace, unit="1/s", reference=published_fps(name))


def deformation_rows() -> list[Row]:
    """Substeps in a second."""
    from workbench.pipeline.devices import open_device

    device = open_device()
    found = []
    for name, grid_mm, _, _ in contact.SUBSTEPS:
        relaxation, particles = contact.whole_finger(grid_mm)
        case = f"substeps of the whole finger, {particles} particles, {device}"
        pace = functools.partial(lambda engine: 1.0 / contact.substep_s(engine), relaxation)
        found.append(_row(f"deformation_{PARTICLES[name]}", case, pace))
    return found


def press_rows() -> list[Row]:
    """Settled presses in a second."""
    from workbench.pipeline.devices import open_device

    device = open_device()
    return [
        _row(
            f"press_{PARTICLES[name]}",
            f"presses of the whole finger, 1 mm deep, settled, grid {grid_mm} mm, {device}",
            functools.partial(settled_per_s, grid_mm),
        )
        for name, grid_mm, _, _ in contact.SUBSTEPS
    ]


def settled_per_s(grid_mm: float) -> float:
    """Presses in a second, one at a time.

    Raises:
        SolveError: If one does not settle.
    """
    problem = contact.whole_problem(grid_mm)
    return contact.settled_per_s([problem], f"the press on a grid of {grid_mm} mm")


def image_rows() -> list[Row]:
    """Images in a second."""
    from workbench.pipeline.devices import open_device

    device = open_device()
    return [
        _row(
            f"image_{width_px}",
            f"images of {width_px} x {width_px * 3 // 4}, light by table, {device}",
            functools.partial(optics.video_fps, LightModel("table"), width_px),
        )
        for width_px in WIDTHS_PX
    ]


def network_rows() -> list[Row]:
    """Force fields in a second."""
    found = [_row(f"network_{pace.name}", pace.case, pace.fps) for pace in forces.paces(NETWORK)]
    patch = forces.patch_pace()
    return [*found, _row(f"network_patch_{patch.name}", patch.case, patch.fps)]
