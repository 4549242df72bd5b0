"""The reader of a design: its skin, its light and its wall, from the store."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sim.optics.field.model import baked_model, model_of
from sim.optics.maps.wall import wall_mm
from workbench.calibration.stored import lit_studio, stored
from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.camera import Camera
from workbench.core.design.design import Elastomer, SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.store import Store

if TYPE_CHECKING:
    # It renders on a device, which must be open before.
    from sim.reading.reader import Reader

SATURATED, MOST_SATURATED = 253, 0.5
"""Grey level from which a pixel says nothing, and the largest share of such pixels of the skin."""


@dataclass(frozen=True, kw_only=True)
class DesignReader:
    """A reader, and what turns a displacement into a force."""

    reader: Reader
    mesh: MembraneMesh
    material: Elastomer
    wall_mm: np.ndarray
    """Thickness of the elastomer below each vertex of the outer skin, shape (V,)."""

    @property
    def tells_force(self) -> bool:
        """Whether the law of a bonded wall holds: neither on gel or air, nor with pins, whose seen
        skin is not the one that is touched."""
        return self.mesh.backing_mm == 0.0 and self.mesh.seen is self.mesh.outer


def open_reader(
    design: SensorDesign, idle: np.ndarray, store: Store, *, monitor: Monitor
) -> DesignReader:
    """Open the reader of a design's first camera.

    Args:
        design: The sensor; calibrated, best.
        idle: Photograph of it untouched, shape (H, W, 3), uint8.
        store: Keeps mesh and light.
        monitor: Progress and cancellation.

    Raises:
        DesignError: If the photograph has another size than the camera's images.
        WorkbenchError: From the stages that mesh and trace.
    """
    camera = design.optics.camera
    expect_size("the idle photo", idle, camera)
    design = looked_up(design)
    mesh = stored(design, PressCase(), "mesh", store, part(monitor, 0.0, 0.3))
    studio = lit_studio(design, mesh, store, part(monitor, 0.3, 0.7), "light of the sensor")
    from sim.optics.studio.unit_residual import read_unit
    from sim.reading.reader import Reader
    from sim.reading.untouched import open_untouched

    unit = design.optics.unit
    rest = open_untouched(
        studio,
        camera,
        idle,
        unit=None if unit is None else read_unit(unit),
        monitor=part(monitor, 0.7, 1.0),
    )
    expect_light("the idle photo", idle, rest.sees)
    return DesignReader(
        reader=Reader(rest), mesh=mesh, material=design.material, wall_mm=wall_mm(mesh)
    )


def expect_size(name: str, photo: np.ndarray, camera: Camera) -> None:
    """Refuse a photograph of another size than the camera's.

    Raises:
        DesignError: With both sizes.
    """
    rows, columns = photo.shape[:2]
    if (columns, rows) != (camera.width_px, camera.height_px):
        raise DesignError(
            f"{name} has {columns} x {rows} pixels, the design's camera "
            f"{camera.width_px} x {camera.height_px}",
            hint="photograph with the design's camera, or set optics.cameras to its size",
            at="optics.cameras",
        )


def expect_light(name: str, photo: np.ndarray, sees: np.ndarray) -> None:
    """Refuse a photograph most of whose skin is saturated.

    Args:
        name: For people.
        photo: Shape (H, W, 3), uint8.
        sees: Pixels that see the skin, shape (H W,), bool.

    Raises:
        DesignError: With the share.
    """
    import cv2

    white = np.maximum.reduce(cv2.split(photo)).ravel() >= SATURATED
    share = float(np.count_nonzero(white & sees) / max(np.count_nonzero(sees), 1))
    if share > MOST_SATURATED:
        raise DesignError(
            f"{name} is saturated at {100.0 * share:.0f} % of the skin; at most "
            f"{100.0 * MOST_SATURATED:.0f} % can be done without",
            hint="expose shorter, and take the idle photo anew",
            at="photo",
        )


def looked_up(design: SensorDesign) -> SensorDesign:
    """The design in the best light that can be asked for any tilt: photons are counted in one pose,
    and models without a table know less of it."""
    if model_of(design.optics.light_model).tabulated:
        return design
    optics = dataclasses.replace(design.optics, light_model=baked_model())
    return dataclasses.replace(design, optics=optics)
