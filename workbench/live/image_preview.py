"""The image preview that follows the sliders: what the camera would see, within a moment.

The body is meshed coarsely, lit by straight light with shadows, and dented by geometry alone
(`sim.optics.studio.geometric_dent`): no photons, no elasticity. It tells framing, colours and where
the dent lies; *Run press* tells the rest. An `ImagePreviewCall` is a `workbench.live.preview_call`
and is answered in a lane of its own, which keeps the last coarse mesh and the last lit scene.
"""

from __future__ import annotations

import dataclasses
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.optics.field.model import model_of, quick_model
from workbench.core.base.digest import digest
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.design import Meshing, SensorDesign
from workbench.core.design.lighting import LightModel
from workbench.core.design.optics import Optics
from workbench.core.press.indenter import Indenter
from workbench.core.press.press_case import PressCase
from workbench.live.live_press import small
from workbench.live.object_drawing import Shapes, shapes_of
from workbench.pipeline.stage import Ref
from workbench.pipeline.store import Store
from workbench.planning.plan import plan

if TYPE_CHECKING:
    from sim.optics.studio.render import Studio
    from workbench.core.result.results import MembraneMesh

WIDTH_PX = 160
"""Rendered width; shown twice as large, as wide as the page's dock."""
CELL_MM = 0.8
"""Cells of the coarse mesh: half the vertices' distance below which a dent of 1 mm shows [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ImagePreview:
    """What the camera would see."""

    images: np.ndarray
    """At rest and dented, shape (2, H, W, 3), uint8, up to twice `WIDTH_PX` wide."""
    model: LightModel
    """How it was lit."""
    seconds: float
    """Time from the call to the answer [s]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ImagePreviewCall:
    """One image preview; a `PreviewCall`."""

    solid: Ref
    optics: Optics
    """With few pixels and a quick light model."""
    indenter: Indenter
    target_mm: tuple[float, float, float]
    depth_mm: float

    @property
    def lane(self) -> str:
        """The worker that answers it."""
        return "look"

    @property
    def stage(self) -> str:
        """What messages call it."""
        return "image preview"

    @property
    def needs(self) -> tuple[str, ...]:
        """Stages that must be stored before."""
        return ("build",)

    def answer(self, store: Store, kept: dict[str, Any], monitor: Monitor) -> ImagePreview:
        """Mesh, light and look; raises as those do."""
        previewer: ImagePreviewer = kept.setdefault(self.stage, ImagePreviewer(shapes_of(kept)))
        return previewer.answer(store, self)


def image_preview_call(design: SensorDesign, case: PressCase) -> ImagePreviewCall:
    """The image preview of a state.

    Raises:
        DesignError: As `plan`.
    """
    model = design.optics.light_model
    quick = model if model_of(model).quick else quick_model()
    optics = dataclasses.replace(small(design.optics, WIDTH_PX), light_model=quick)
    # The body does not depend on the press, whose object may have a million triangles to digest.
    return ImagePreviewCall(
        solid=plan(design, PressCase())["build"].ref,
        optics=optics,
        indenter=case.indenter,
        target_mm=case.press.target_mm,
        depth_mm=case.press.depth_mm,
    )


class ImagePreviewer:
    """Answers image previews in one process, and keeps what the next one may need."""

    def __init__(self, shapes: Shapes) -> None:
        self.shapes = shapes
        self._mesh: tuple[Ref, MembraneMesh] | None = None
        self._studio: tuple[str, Studio] | None = None

    def answer(self, store: Store, call: ImagePreviewCall) -> ImagePreview:
        """What the camera sees at rest and dented."""
        from sim.optics.studio.geometric_dent import geometric_dent
        from workbench.pipeline.devices import open_device

        begun = time.perf_counter()
        open_device()
        mesh = self._coarse(store, call.solid)
        studio = self._open_studio(call, mesh)
        target_mm = np.asarray(call.target_mm)
        points_mm, faces = self.shapes.shape(call.indenter)
        moved = geometric_dent(
            mesh.seen, points_mm, faces, target_mm=target_mm, depth_mm=call.depth_mm
        )
        images = enlarged(studio.images(np.stack([np.zeros_like(moved), moved])))
        return ImagePreview(
            images=images, model=call.optics.light_model, seconds=time.perf_counter() - begun
        )

    def _coarse(self, store: Store, solid: Ref) -> MembraneMesh:
        from workbench.pipeline.stages.mesh import MeshInputs, mesh

        if self._mesh is None or self._mesh[0] != solid:
            body = store.load(solid.stage, solid.key)
            self._mesh = (
                solid,
                mesh(MeshInputs(solid=body, meshing=Meshing(hex_mm=CELL_MM)), monitor=silent),
            )
        return self._mesh[1]

    def _open_studio(self, call: ImagePreviewCall, mesh: MembraneMesh) -> Studio:
        from sim.optics.field.bake import bake_light
        from sim.optics.studio.render import Studio

        key = digest((call.solid, call.optics))
        if self._studio is None or self._studio[0] != key:
            optics = call.optics
            light = bake_light(
                mesh,
                optics.ring,
                optics.lamps,
                model=optics.light_model,
                transport=None,
                monitor=silent,
            )
            self._studio = (key, Studio(mesh, light, optics))
        return self._studio[1]


def enlarged(images: np.ndarray) -> np.ndarray:
    """Images of shape (K, H, W, 3), uint8, at twice the size, interpolated."""
    import cv2

    size = (2 * images.shape[2], 2 * images.shape[1])
    return np.stack([cv2.resize(image, size, interpolation=cv2.INTER_LINEAR) for image in images])
