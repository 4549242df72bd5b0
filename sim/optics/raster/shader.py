"""Shading of the vertices that moved, on the device."""

from __future__ import annotations

from dataclasses import dataclass
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


@dataclass(frozen=True, kw_only=True, slots=True)
class _Vertices:
    """Vertices to be shaded, in arrays on the device."""

    count: int
    numbers: Any
    """Which ones, shape (count,) or longer, int32."""
    placed: Any
    """Places of all vertices [mm], float32 vectors."""
    turned: Any
    """Outward unit normals of all, float32 vectors."""
    to_camera: Any
    """Unit vectors from all to the camera, float32."""


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
        moved = _Vertices(
            count=raster.vertex_entries,
            numbers=raster.vertex_list,
            placed=raster.placed,
            turned=raster.turned,
            to_camera=raster.to_camera,
        )
        self._run(moved, raster.radiance, shadows=EVERYWHERE if whole else FADING)

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
        everything = _Vertices(
            count=raster.vertices,
            numbers=on_device(np.arange(raster.vertices, dtype=np.int32)),
            placed=on_device(placed, vector=3),
            turned=raster.normals,
            to_camera=raster.still_to_camera,
        )
        self._run(everything, found, shadows=EVERYWHERE)
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
        everything = _Vertices(
            count=raster.vertices,
            numbers=on_device(np.arange(raster.vertices, dtype=np.int32)),
            placed=raster.points,
            turned=turned,
            to_camera=raster.still_to_camera,
        )
        found = empty(ti.f32, raster.vertices, vector=3)
        self._run(everything, found, shadows=NO_SHADOWS)
        return found.to_numpy()

    def _run(self, vertices: _Vertices, radiance: Any, *, shadows: int) -> None:
        """Fill the radiance of vertices, by their numbers."""
        raster = self._raster
        arguments = (
            vertices.count,
            self.lit.way_of_lighting,
            vertices.numbers,
            raster.points,
            raster.normals,
            vertices.placed,
            vertices.turned,
            vertices.to_camera,
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
