"""Photographs of a twin: photons traced anew through each pose, then its lens and image sensor.

Nothing is looked up and nothing is kept from the image at rest: all of the skin shines with the
light of the pose, so that a dent also darkens what lies beside it. Each photograph has photons and
shot noise of its own.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.optics.field.model import models
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.lighting import LightModel
from workbench.core.design.optics import Optics
from workbench.core.result.light import LightField
from workbench.core.result.results import MembraneMesh
from workbench.twin.draw import Draws, Twin, stream

if TYPE_CHECKING:
    # It needs the device that a photographer opens.
    from sim.optics.studio.render import Studio

REST = 0
"""Number of the photograph at rest; presses and slides count from 1."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Lit:
    """A pose in its light."""

    radiance: np.ndarray
    """Of the seen skin's vertices toward the camera, shape (V, 3), float32."""
    image: np.ndarray | None = None
    """Linear light at the camera where more than the skin is seen, shape (H, W, 3); None: what
    the workbench draws of that radiance."""


class Photographer:
    """Light and camera of one twin, opened once."""

    def __init__(self, twin: Twin, mesh: MembraneMesh, photons: int, monitor: Monitor) -> None:
        """Trace the light at rest.

        Args:
            twin: The sensor.
            mesh: Its skins.
            photons: Of each image.
            monitor: Progress and cancellation.

        Raises:
            DesignError: If the camera sees nothing of the skin.
            OpticsError: If no light reaches what it sees.
        """
        from workbench.pipeline.devices import open_device

        open_device()
        from sim.optics.field.bake import bake_light

        self.mesh, self.photons, self._seed = mesh, photons, twin.seed
        optics = dataclasses.replace(twin.design.optics, light_model=_traced_model())
        self.optics = optics
        light = bake_light(
            mesh,
            optics.ring,
            optics.lamps,
            model=optics.light_model,
            monitor=part(monitor, 0.0, 0.1),
        )
        self._rest = self._lit(None, REST, part(monitor, 0.1, 1.0))
        self.plain = self._studio(light, optics)
        markers = dataclasses.replace(optics.markers, visible=True)
        self._marked = self._studio(light, dataclasses.replace(optics, markers=markers))
        self._exposure = twin.exposure_factor * self.plain.imager.backdrop.exposure

    def at_rest(self, *, marked: bool = False) -> np.ndarray:
        """The photograph of the untouched sensor, shape (H, W, 3), uint8."""
        studio = self._marked if marked else self.plain
        return self._developed(self._shown(studio, self._rest, None), REST)

    def photograph(
        self, displacement_mm: np.ndarray, number: int, monitor: Monitor, *, marked: bool = False
    ) -> np.ndarray:
        """A photograph of the touched sensor, shape (H, W, 3), uint8.

        Args:
            displacement_mm: Of the vertices of `mesh.seen`, shape (V, 3).
            number: Of the photograph, from 1: its photons and noise follow from it.
            monitor: Progress and cancellation.
            marked: Whether dots are printed on the skin, also where the design has none.

        Raises:
            OpticsError: If the displacement is not finite.
        """
        studio = self._marked if marked else self.plain
        moved = np.asarray(displacement_mm, dtype=np.float32)
        lit = self._lit(moved, number, monitor)
        return self._developed(self._shown(studio, lit, moved), number)

    def _shown(self, studio: Studio, lit: Lit, moved: np.ndarray | None) -> np.ndarray:
        """Linear light of a pose, shape (H, W, 3), float32."""
        linear = self._whole(studio, lit.radiance)
        if moved is not None:
            drawn = studio.linear(moved[None], radiance=lit.radiance[None])[0]
            changed = _changed(studio)
            linear[changed] = drawn[changed]
        return linear

    def _studio(self, light: LightField, optics: Optics) -> Studio:
        from sim.optics.studio.render import Studio

        # Noise is drawn here, photograph by photograph.
        sensor = dataclasses.replace(optics.camera.sensor, noise=False)
        camera = dataclasses.replace(optics.camera, sensor=sensor)
        return Studio(
            self.mesh,
            light,
            dataclasses.replace(optics, camera=camera),
            radiance=self._rest.radiance,
        )

    def _seed_of(self, number: int) -> int:
        """Of a photograph's photons."""
        return int(stream(self._seed, Draws.PHOTONS, number).integers(2**31))

    def _lit(self, moved: np.ndarray | None, number: int, monitor: Monitor) -> Lit:
        """A pose (V, 3) in the light that is traced through it; None: at rest."""
        from sim.optics.light.lights import place_leds
        from sim.optics.transport.paths import Photons
        from sim.optics.transport.radiance import trace_radiance

        leds = place_leds(self.optics.ring, self.optics.lamps)
        found = trace_radiance(
            self.mesh,
            leds,
            self.optics.camera,
            self.optics.transport,
            Photons(count=self.photons, seed=self._seed_of(number)),
            displacement_mm=moved,
            monitor=monitor,
        )
        scale = len(leds.position_mm) / found.photons
        return Lit(radiance=(scale * found.radiance).astype(np.float32))

    def _whole(self, studio: Studio, radiance: np.ndarray) -> np.ndarray:
        """Linear light as if no skin had moved, with this radiance (V, 3): shape (H, W, 3)."""
        from sim.optics.raster.backdrop import at_pixels

        back, view = studio.imager.backdrop, studio.imager.raster.view
        lit = radiance + studio.imager.shader.lit.ambient
        inked = (1.0 + (back.ink_gain - 1.0) * back.ink)[:, None].astype(np.float32)
        return (at_pixels(view, lit) * inked).reshape(*studio.imager.shape, 3)

    def _developed(self, linear: np.ndarray, number: int) -> np.ndarray:
        from sim.optics.raster.image_sensor import develop

        return develop(linear, self.optics.camera, exposure=self._exposure, frame=number)


def _traced_model() -> LightModel:
    """The light model that traces every pose anew."""
    return next(name for name, model in models().items() if model.per_frame)


def _changed(studio: Any) -> np.ndarray:
    """Pixels that see moved skin in the frame just drawn, shape (H, W), bool."""
    from sim.optics.raster.raster_kernels import SAME

    raster = studio.imager.raster
    found = raster.seen.triangle.to_numpy()[: raster.pixels] != SAME
    return found.reshape(studio.imager.shape)
