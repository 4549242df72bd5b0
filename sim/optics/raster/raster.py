"""Drawing what moved over the undeformed view: device arrays, and the order of the kernels.

A `Raster` holds one batch of frames at a time. `look` fills it; shading and composition read it.
On a CPU a batch is one frame, which its caches hold; a GPU needs many to be busy.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import taichi as ti

from sim.optics.light.device_arrays import computes_on_gpu, empty, on_device
from sim.optics.raster import patch_kernels, raster_kernels, tree_kernels
from sim.optics.raster.gbuffer import MOVED_MM
from sim.optics.raster.skin_view import SkinView
from sim.optics.raster.tree import tree_levels

GPU_FRAMES = 32
"""Frames of a batch on a GPU: 32 at 640x480 take 400 MB."""


class Raster:
    """The view of one camera on the device, with room for a batch of frames."""

    def __init__(self, view: SkinView, *, frames: int | None = None) -> None:
        """Upload a view.

        Args:
            frames: Most frames of a batch; None is what suits the device.
        """
        self.view = view
        self.frames = frames or (GPU_FRAMES if computes_on_gpu() else 1)
        self.vertices, self.pixels = len(view.points_mm), len(view.direction)
        self._upload(view)
        count, pixels = self.frames * self.vertices, self.frames * self.pixels
        self.moved, self.used = empty(ti.u8, count), empty(ti.u8, count)
        self.placed, self.turned, self.to_camera, self.radiance = (
            empty(ti.f32, count, vector=3) for _ in range(4)
        )
        self.pixel = empty(ti.f32, count, vector=2)
        self.keys = empty(ti.i64, pixels)
        self.seen_face = empty(ti.i32, pixels)
        self.seen_weights = empty(ti.f32, pixels, vector=2)
        self.seen_mm = empty(ti.f32, pixels)
        self.on_patch = empty(ti.u8, pixels)
        patch_kernels.fill_keys(self.keys, raster_kernels.UNTOUCHED)
        chunk = patch_kernels.CHUNK
        self._face_chunks = -(-len(view.faces) // chunk)
        self._vertex_chunks = -(-self.vertices // chunk)
        self._face_counts = empty(ti.i32, self.frames * self._face_chunks)
        self._vertex_counts = empty(ti.i32, self.frames * self._vertex_chunks)
        self.face_list, self.vertex_list = empty(ti.i32, 0), empty(ti.i32, 0)
        # Low and high corners of the tree's boxes, of places and of normals.
        self.corners = [empty(ti.f32, 0, vector=3) for _ in range(4)]
        self.list_start = empty(ti.i32, self.frames + 1)
        self.level_start, self.level_count = (empty(ti.i32, tree_kernels.LEVELS) for _ in range(2))
        self.vertex_entries = self.levels = self.boxes = 0

    def _upload(self, view: SkinView) -> None:
        self.points, self.normals = (on_device(a, vector=3) for a in (view.points_mm, view.normals))
        self.area = on_device(view.area_mm2, vector=3)
        self.faces = on_device(view.faces)
        self.face_start, self.face_of = on_device(view.face_start), on_device(view.face_of)
        self.foot_map = on_device(view.foot_map, vector=3)
        self.way_map = on_device(view.way_map, vector=3)
        self.start_pixel = on_device(view.start_pixel, vector=2)
        self.still_to_camera = on_device(view.to_camera, vector=3)
        self.origin = on_device(view.origin_mm, vector=3)
        self.direction = on_device(view.direction, vector=3)
        self.transmittance = on_device(view.transmittance)
        self.folded, self._some_folded = on_device(view.folded), int(view.folded.any())
        self.layer_start, self.layer_face = on_device(view.layer_start), on_device(view.layer_face)
        self.layer_mm = on_device(view.layer_mm)
        self.seen_start, self.seen_pixel = on_device(view.seen_start), on_device(view.seen_pixel)

    def look(self, displacement_mm: np.ndarray) -> None:
        """Find what every pixel sees in k frames of displacement [mm], shape (k, V, 3), float32.

        k is at most `frames`.
        """
        frames = len(displacement_mm)
        displacement = displacement_mm
        if computes_on_gpu():
            displacement = on_device(displacement_mm, vector=3)
        faces = self._list(displacement, frames)
        patch_kernels.place_vertices(
            self.vertex_entries,
            self.vertex_list,
            displacement,
            self.faces,
            self.moved,
            self.points,
            self.normals,
            self.area,
            self.face_start,
            self.face_of,
            self.start_pixel,
            self.still_to_camera,
            self.foot_map,
            self.way_map,
            self.placed,
            self.turned,
            self.pixel,
            self.to_camera,
        )
        tree_kernels.build_tree(
            frames,
            self.vertices,
            self.levels,
            self.boxes,
            self.level_start,
            self.level_count,
            self.list_start,
            self.face_list,
            self.faces,
            self.normals,
            self.placed,
            *self.corners,
        )
        raster_kernels.draw(
            faces,
            self.face_list,
            self.faces,
            self.vertices,
            self.view.width_px,
            self.view.height_px,
            self.view.pad_px,
            self.placed,
            self.pixel,
            self.origin,
            self.direction,
            self.seen_start,
            self.seen_pixel,
            self.keys,
        )
        arguments = (
            frames,
            self.vertices,
            self.pixels,
            self.keys,
            self.moved,
            self.faces,
            self.points,
            self.normals,
            self.placed,
            self.origin,
            self.direction,
            self._some_folded,
            self.folded,
            self.layer_start,
            self.layer_face,
            self.layer_mm,
            *self.tree,
            *self.corners,
            self.seen_face,
            self.seen_weights,
            self.seen_mm,
            self.on_patch,
        )
        raster_kernels.resolve(*arguments)

    @property
    def tree(self) -> tuple[Any, ...]:
        """The tree's levels and list in the order of the kernels that cast rays."""
        return (
            self.levels,
            self.boxes,
            self.level_start,
            self.level_count,
            self.list_start,
            self.face_list,
        )

    def _list(self, displacement: Any, frames: int) -> int:
        """Make the lists of moved faces and their vertices; returns the number of faces."""
        patch_kernels.find_moved(
            displacement,
            self.faces,
            MOVED_MM**2,
            self.moved,
            self.used,
            self._face_counts,
            self._vertex_counts,
        )
        face_at = _running(self._face_counts.to_numpy()[: frames * self._face_chunks])
        vertex_at = _running(self._vertex_counts.to_numpy()[: frames * self._vertex_chunks])
        list_start = np.zeros(self.frames + 1, dtype=np.int32)
        list_start[: frames + 1] = face_at[:: self._face_chunks]
        self.list_start.from_numpy(list_start)
        most = int(np.diff(list_start[: frames + 1]).max())
        self.levels, starts, counts = tree_levels(most)
        self.level_start.from_numpy(starts)
        self.level_count.from_numpy(counts)
        self.boxes = int(counts.sum())
        self.face_list = _roomy(self.face_list, ti.i32, int(face_at[-1]))
        self.vertex_list = _roomy(self.vertex_list, ti.i32, int(vertex_at[-1]))
        room = frames * self.boxes
        self.corners = [_roomy(array, ti.f32, room, vector=3) for array in self.corners]
        self.vertex_entries = int(vertex_at[-1])
        face_starts, vertex_starts = face_at[:-1].copy(), vertex_at[:-1].copy()
        if computes_on_gpu():
            face_starts, vertex_starts = on_device(face_starts), on_device(vertex_starts)
        patch_kernels.list_moved(
            frames,
            self.vertices,
            self.faces,
            self.moved,
            self.used,
            face_starts,
            vertex_starts,
            self.face_list,
            self.vertex_list,
        )
        return int(face_at[-1])


def _running(counts: np.ndarray) -> np.ndarray:
    """Sums before each entry, and the whole, int32."""
    return np.append(0, np.cumsum(counts)).astype(np.int32)


def _roomy(array: Any, kind: Any, count: int, *, vector: int = 0) -> Any:
    """The array, or one half as large again where it is too small."""
    if array.shape[0] >= count:
        return array
    return empty(kind, count + count // 2, vector=vector)
