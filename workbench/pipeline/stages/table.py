"""The stage `table`: traced light as radiance toward each camera, by the tilt of the skin."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from sim.optics.field.model import model_of
from workbench.core.base.monitor import Monitor
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import Baking, LightModel
from workbench.core.design.optics import Optics, Transport
from workbench.core.result.light import LightField, NormalTable
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.devices import start_device
from workbench.pipeline.stage import Chain, Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class TableInputs:
    """What radiance toward the cameras depends on."""

    mesh: MembraneMesh
    light: LightField
    cameras: tuple[Camera, ...]
    """All that light on its way to a camera depends on: where it stands."""
    transport: Transport
    model: LightModel


def inputs(chain: Chain) -> TableInputs | None:
    """Those of the design's light."""
    return table_inputs(chain.design.optics, chain.result("mesh"), chain.result("bake"))


def table_inputs(optics: Optics, mesh: MembraneMesh, light: LightField) -> TableInputs | None:
    """The inputs for a skin and its light; None of a model that looks nothing up."""
    if not model_of(optics.light_model).tabulated:
        return None
    cameras = tuple(Camera(position_mm=camera.position_mm) for camera in optics.all_cameras)
    # How the light was baked, it says itself: images and maps know no more of it.
    transport = dataclasses.replace(optics.transport, baking=Baking())
    return TableInputs(
        mesh=mesh,
        light=light,
        cameras=cameras,
        transport=transport,
        model=optics.light_model,
    )


def table(given: TableInputs, *, monitor: Monitor) -> NormalTable:
    """Radiance by normal, for each vertex and camera."""
    start_device(monitor)
    from sim.optics.field.table import tabulate

    return tabulate(
        given.light,
        given.mesh,
        given.cameras,
        given.transport,
        model=given.model,
        monitor=monitor,
    )


STAGE = Stage(
    name="table",
    label="Light table",
    version=3,
    place=5,
    lane="sim",
    run=table,
    inputs=inputs,
    shown=False,
)
