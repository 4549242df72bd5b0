"""Shading of the vertices that moved, on the device."""

from __future__ import annotations

from typing import Any

import numpy as np
import taichi as ti

from sim.optics.light.device_arrays import computes_on_gpu, empty, on_device
from sim.optics.raster.gbuffer import MOVED_MM
from sim.optics.raster.raster import Raster
from sim.optics.raster.shade_kernels import EVERYWHERE, FADING, GIVEN, NO_SHADOWS, shade_vertices
from sim.optics.raster.shading import FULL_SHADOW_MM
from sim.optics.raster.vertex_light import VertexLight
from workbench.core.base.errors import OpticsError


class Shader:
    """The lights of one design over the vertices of a raster."""

    def __init__(self, raster: Raster, lit: VertexLight) -> None:
        self._raster = raster
        self.lit = lit
        self.lights = (
            on_device(lit.light, vector=4),
            on_device(lit.led_mm, vector=3),
            on_device(lit.led_axis, vector=3),
            on_device(lit.led_rgb, vector=3),
            on_device(lit.led_shape, vector=2),
            on_device(lit.table),
            on_device(lit.nodes),
            on_device(lit.weights),
            on_device(lit.node_frames),
            lit.diffuse,
            lit.specular,
            lit.gloss,
        )
        """What the kernels that shade take of a light, in their order."""

    @property
    def given(self) -> bool:
        """Whether radiance comes from outside, frame by frame."""
        return self.lit.way_of_lighting == GIVEN

    def shade(self, radiance: np.ndarray | None, *, whole: bool = False) -> None:
        """Fill the raster's radiance for the frames it looks at.

        Args:
            radiance: Where it is given: of each frame and vertex, shape (k, V, 3), float32.
            whole: Shadows do not fade toward skin that did not move.
        """
        raster = self._raster
        if self.given:
            _take(raster.radiance, radiance)
            return
        self._run(
            raster.vertex_entries,
            raster.vertex_list,
            raster.placed,
            raster.turned,
            raster.to_camera,
            raster.radiance,
            shadows=EVERYWHERE if whole else FADING,
        )

    def everywhere(self) -> np.ndarray:
        """Radiance of all vertices of the one frame looked at, with whole shadows, (V, 3), float32.

        Skin that did not move is shaded where it was; of moved vertices the value has no meaning.
        """
        raster = self._raster
        if self.given:
            return raster.radiance.to_numpy()[: raster.vertices]
        placed = raster.points.to_numpy()
        entries = raster.vertex_list.to_numpy()[: raster.vertex_entries]
        placed[entries] = raster.placed.to_numpy()[entries]
        found = empty(ti.f32, raster.vertices, vector=3)
        self._run(
            raster.vertices,
            on_device(np.arange(raster.vertices, dtype=np.int32)),
            on_device(placed, vector=3),
            raster.normals,
            raster.still_to_camera,
            found,
            shadows=EVERYWHERE,
        )
        return found.to_numpy()

    def undeformed(self, normals: np.ndarray | None = None) -> np.ndarray:
        """Radiance of the undeformed skin, shape (V, 3), float32.

        Args:
            normals: Outward unit normals to use instead of the skin's, shape (V, 3).

        Raises:
            OpticsError: If radiance is given from outside: nothing here can shade.
        """
        if self.given:
            raise OpticsError(
                "the light model photons shades no vertices by itself",
                hint="hand its radiance in, or choose the light model hybrid",
                at="optics.light_model",
            )
        raster = self._raster
        turned = raster.normals
        if normals is not None:
            turned = on_device(normals.astype(np.float32), vector=3)
        everything = on_device(np.arange(raster.vertices, dtype=np.int32))
        found = empty(ti.f32, raster.vertices, vector=3)
        self._run(
            raster.vertices,
            everything,
            raster.points,
            turned,
            raster.still_to_camera,
            found,
            shadows=NO_SHADOWS,
        )
        return found.to_numpy()

    def _run(
        self,
        count: int,
        vertex_list: Any,
        placed: Any,
        turned: Any,
        to_camera: Any,
        radiance: Any,
        *,
        shadows: int,
    ) -> None:
        raster = self._raster
        arguments = (
            count,
            self.lit.way_of_lighting,
            vertex_list,
            raster.points,
            raster.normals,
            placed,
            turned,
            to_camera,
            *self.lights,
            MOVED_MM,
            FULL_SHADOW_MM,
            shadows,
            *raster.tree,
            raster.faces,
            *raster.corners,
            radiance,
        )
        shade_vertices(*arguments)


def _take(target: Any, radiance: np.ndarray | None) -> None:
    """Copy given radiance (k, V, 3) to the front of a flat device array."""
    if radiance is None:
        raise OpticsError(
            "the light model photons needs the radiance of every frame",
            hint="trace the frames' photons first",
            at="optics.light_model",
        )
    from sim.optics.raster.patch_kernels import copy_rows

    rows = np.ascontiguousarray(radiance.reshape(-1, 3), dtype=np.float32)
    copy_rows(on_device(rows, vector=3) if computes_on_gpu() else rows, target)
