"""Shading of the vertices that moved, on the device."""

from __future__ import annotations

from typing import Any

import numpy as np
import taichi as ti

from sim.optics.light.device_arrays import empty, on_device, readable
from sim.optics.raster.bundles import Law, Lights, Posed, ScatteredLight
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
        self.lights = Lights(
            light=on_device(lit.light, vector=4),
            led=on_device(lit.led_mm, vector=3),
            led_axis=on_device(lit.led_axis, vector=3),
            led_rgb=on_device(lit.led_rgb, vector=3),
            led_shape=on_device(lit.led_shape, vector=2),
            led_radius=on_device(lit.led_radius_mm),
        )
        self.scattered = ScatteredLight(
            table=on_device(lit.table),
            nodes=on_device(lit.nodes),
            weights=on_device(lit.weights),
            node_frames=on_device(lit.node_frames),
        )
        self.law = Law(
            way_of_lighting=lit.way_of_lighting,
            diffuse=lit.diffuse,
            specular=lit.specular,
            gloss=lit.gloss,
            ambient=ti.math.vec3(*lit.ambient.tolist()),
            least_mm=MOVED_MM,
            full_shadow_mm=FULL_SHADOW_MM,
            finest_shadow=lit.finest_shadow,
        )

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
            _take(raster.radiance, radiance, self.lit.ambient)
            return
        shadows = EVERYWHERE if whole else FADING
        self._run(raster.vertex_list, raster.vertex_entries, raster.posed, raster.radiance, shadows)

    def everywhere(self) -> np.ndarray:
        """Radiance of all vertices of the one frame looked at, with whole shadows, (V, 3), float32.

        Skin that did not move is shaded where it was; of moved vertices the value has no meaning.
        """
        raster = self._raster
        if self.given:
            return raster.radiance.to_numpy()[: raster.vertices]
        placed = raster.skin.points.to_numpy()
        entries = raster.vertex_list.to_numpy()[: raster.vertex_entries]
        placed[entries] = raster.posed.placed.to_numpy()[entries]
        return self._all(on_device(placed, vector=3), raster.skin.normals, EVERYWHERE)

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
        skin = self._raster.skin
        turned = skin.normals
        if normals is not None:
            turned = on_device(normals.astype(np.float32), vector=3)
        return self._all(skin.points, turned, NO_SHADOWS)

    def _all(self, placed: Any, turned: Any, shadows: int) -> np.ndarray:
        """Radiance of all vertices at places and with outward normals, (V, 3), float32."""
        raster = self._raster
        found = empty(ti.f32, raster.vertices, vector=3)
        numbers = on_device(np.arange(raster.vertices, dtype=np.int32))
        posed = Posed(placed=placed, turned=turned, to_camera=raster.sights.outward_to_camera)
        self._run(numbers, raster.vertices, posed, found, shadows)
        return found.to_numpy()

    def _run(self, numbers: Any, count: int, posed: Any, radiance: Any, shadows: int) -> None:
        """Fill the radiance of vertices, by the first `count` of their numbers."""
        raster = self._raster
        shade: Any = shade_vertices
        shade(
            count,
            numbers,
            raster.skin,
            posed,
            self.lights,
            self.scattered,
            self.law,
            shadows,
            raster.tree,
            radiance,
        )


def _take(target: Any, radiance: np.ndarray | None, ambient: np.ndarray) -> None:
    """Copy given radiance (k, V, 3) and the ambient (3,) to the front of a flat device array."""
    if radiance is None:
        raise OpticsError(
            "the light model photons needs the radiance of every frame",
            hint="trace the frames' photons first",
            at="optics.light_model",
        )
    from sim.optics.raster.patch_kernels import copy_rows

    rows = np.ascontiguousarray(radiance.reshape(-1, 3) + ambient, dtype=np.float32)
    copy_rows(readable(rows, vector=3), target)
