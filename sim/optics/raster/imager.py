"""Images at video rate: view, light and backdrop of one design on the compute device.

Everything an `Imager` needs are the plain arrays of `SkinView`, `VertexLight` and `Backdrop`, so it
can be saved on a machine with ray casting and opened on one that only has a device.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any

import numpy as np
import taichi as ti

from sim.optics.light.device_arrays import empty, on_device
from sim.optics.raster import bundles, compose_kernels
from sim.optics.raster.backdrop import Backdrop
from sim.optics.raster.display import LUT_STEPS
from sim.optics.raster.markers import LEAST_COSINE, Coverage, centroids
from sim.optics.raster.raster import Raster
from sim.optics.raster.raster_kernels import SAME
from sim.optics.raster.shader import Shader
from sim.optics.raster.skin_view import SkinView
from sim.optics.raster.vertex_light import VertexLight

PARTS = {"view": SkinView, "lit": VertexLight, "backdrop": Backdrop}


class Imager:
    """Deformed skin to images, in batches."""

    def __init__(self, raster: Raster, shader: Shader, backdrop: Backdrop) -> None:
        self.raster, self.shader, self.backdrop = raster, shader, backdrop
        self.whole_shadows = False
        """Whether shadows do not fade toward skin that did not move: for absolute images."""
        self._curve = on_device(backdrop.curve)
        inked = raster.frames * raster.pixels if len(backdrop.dots_mm) else 0
        self._ink, self._marker = empty(ti.f32, inked), empty(ti.i32, inked)
        self._eye = bundles.Eye(
            camera=ti.math.vec3(*backdrop.camera_mm.tolist()),
            axis=ti.math.vec3(*backdrop.axis.tolist()),
            angular=backdrop.angular,
            focal_px=backdrop.focal_px,
            least_cosine=LEAST_COSINE,
        )
        self._dots = bundles.PrintedDots(
            dot_start=on_device(backdrop.dot_start),
            dot_of=on_device(backdrop.dot_of),
            centres=on_device(backdrop.dots_mm, vector=3),
            radius=backdrop.dot_radius_mm,
        )
        self._picture = bundles.Picture(
            faces=raster.skin.faces,
            radiance=raster.radiance,
            undeformed=on_device(backdrop.undeformed, vector=3),
            transmittance=raster.transmittance,
            lens_share=on_device(backdrop.lens_share),
            remainder=on_device(backdrop.remainder, vector=3),
            ink=self._ink,
            has_dots=int(len(backdrop.dots_mm) > 0),
            ink_gain=backdrop.ink_gain,
            inked_background=backdrop.inked_background,
        )

    @classmethod
    def from_state(cls, state: dict[str, np.ndarray]) -> Imager:
        """An imager from saved arrays; the device must be open."""
        parts: dict[str, Any] = {}
        for name, kind in PARTS.items():
            values = {}
            for field in dataclasses.fields(kind):
                value = np.asarray(state[f"{name}.{field.name}"])
                values[field.name] = value if value.ndim else value.item()
            parts[name] = kind(**values)
        raster = Raster(parts["view"])
        return cls(raster, Shader(raster, parts["lit"]), parts["backdrop"])

    def state(self) -> dict[str, np.ndarray]:
        """All plain arrays and numbers by name, ready for `numpy.savez`."""
        parts = {"view": self.raster.view, "lit": self.shader.lit, "backdrop": self.backdrop}
        return {
            f"{name}.{field.name}": np.asarray(getattr(part, field.name))
            for name, part in parts.items()
            for field in dataclasses.fields(part)
        }

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of an image."""
        return self.raster.view.height_px, self.raster.view.width_px

    def images(self, displacement_mm: np.ndarray, radiance: np.ndarray | None = None) -> np.ndarray:
        """Images of frames of displacement [mm], shape (K, V, 3): (K, H, W, 3), uint8."""
        found = np.empty((len(displacement_mm), self.raster.pixels, 3), dtype=np.uint8)
        for batch in self._batches(displacement_mm, radiance):
            self.expose(found[batch])
        return found.reshape(-1, *self.shape, 3)

    def linear(self, displacement_mm: np.ndarray, radiance: np.ndarray | None = None) -> np.ndarray:
        """Linear radiance with ink, before exposure: (K, H, W, 3), float32."""
        found = np.empty((len(displacement_mm), self.raster.pixels, 3), dtype=np.float32)
        for batch in self._batches(displacement_mm, radiance):
            self.gather_light(found[batch])
        return found.reshape(-1, *self.shape, 3)

    def _batches(self, displacement_mm: np.ndarray, radiance: np.ndarray | None) -> Iterator[slice]:
        for first in range(0, len(displacement_mm), self.raster.frames):
            batch = slice(first, min(first + self.raster.frames, len(displacement_mm)))
            self.look(displacement_mm[batch], None if radiance is None else radiance[batch])
            yield batch

    def look(self, displacement_mm: np.ndarray, radiance: np.ndarray | None = None) -> None:
        """Find, shade and ink what the pixels of at most one batch of frames see."""
        self.look_at(np.ascontiguousarray(displacement_mm, dtype=np.float32), radiance)

    def look_at(self, moved: Any, radiance: np.ndarray | None = None) -> None:
        """The same of a contiguous array of float32, or of a tensor on the device."""
        self.raster.look(moved)
        self.shader.shade(radiance, whole=self.whole_shadows)
        if len(self.backdrop.dots_mm):
            spread_ink: Any = compose_kernels.spread_ink
            spread_ink(len(moved), *self._looks(), self._dots, self._ink, self._marker)

    def _looks(self) -> tuple[Any, ...]:
        """What the kernels take that describe what a pixel looks at."""
        raster = self.raster
        return raster.seen, raster.skin, raster.posed.turned, raster.rays, self._eye

    def expose(self, images: np.ndarray) -> None:
        """Write the grey levels of the frames looked at, shape (k, N, 3), uint8."""
        images[:] = self.backdrop.background_rgb
        self.draw_over(images)

    def draw_over(self, images: Any) -> None:
        """Write what changed over images of the background, (k, N, 3), uint8: array or tensor."""
        gain = ti.math.vec3(*(self.backdrop.exposure * (LUT_STEPS - 1)).tolist())
        expose: Any = compose_kernels.expose
        expose(self.raster.seen, self._picture, gain, self._curve, images)

    def gather_light(self, linear: np.ndarray) -> None:
        """Write the linear light of the frames looked at, shape (k, N, 3), float32."""
        linear[:] = self.backdrop.background
        gather_light: Any = compose_kernels.gather_light
        gather_light(self.raster.seen, self._picture, linear)

    def describe(self, normal: Any, depth_z_mm: Any, frames: int = 1) -> None:
        """Write what changed pixels of the first frames see: normals (k N, 3), depths (k N,)."""
        describe: Any = compose_kernels.describe
        describe(frames, *self._looks(), normal, depth_z_mm)

    def ink(self) -> tuple[np.ndarray, np.ndarray]:
        """Nearest dot and covered share of the first frame's pixels, each (N,).

        Right only where `raster.seen.triangle` says that the pixel changed.
        """
        count = self.raster.pixels
        return self._marker.to_numpy()[:count], self._ink.to_numpy()[:count]

    @property
    def inked(self) -> tuple[Any, Any]:
        """Nearest dot and covered share of all pixels looked at, on the device; see `ink`."""
        return self._marker, self._ink

    def marker_px(self) -> np.ndarray:
        """u, v [px] of the dots in the first frame, (M, 2), float32; NaN of those not seen."""
        raster, back = self.raster, self.backdrop
        changed = raster.seen.triangle.to_numpy()[: raster.pixels] != SAME
        marker, ink = self.ink()
        coverage = Coverage(
            marker=np.where(changed, marker, back.marker), ink=np.where(changed, ink, back.ink)
        )
        return centroids(coverage, len(back.dots_mm), raster.view.width_px)
