"""Drawing what moved over the undeformed view: device arrays, and the order of the kernels.

A `Raster` holds one batch of frames at a time. `look` fills it; shading and composition read it.
On a CPU a batch is one frame, which its caches hold; a GPU needs many to be busy.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import taichi as ti

from sim.optics.light.device_arrays import computes_on_gpu, empty, on_device, readable
from sim.optics.raster import bundles, patch_kernels, raster_kernels, tree_kernels
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
        count, pixels = self.frames * self.vertices, self.frames * self.pixels
        self._upload(view)
        self._moved, self._used = empty(ti.u8, count), empty(ti.u8, count)
        placed, turned, to_camera, self.radiance = (
            empty(ti.f32, count, vector=3) for _ in range(4)
        )
        self.posed = bundles.Posed(placed=placed, turned=turned, to_camera=to_camera)
        self._pixel = empty(ti.f32, count, vector=2)
        self._keys = empty(ti.i64, pixels)
        patch_kernels.fill_keys(self._keys, raster_kernels.UNTOUCHED)
        self.seen = bundles.Seen(
            triangle=empty(ti.i32, pixels),
            weights=empty(ti.f32, pixels, vector=2),
            away_mm=empty(ti.f32, pixels),
            on_patch=empty(ti.u8, pixels),
        )
        chunk = patch_kernels.CHUNK
        self._face_chunks = -(-len(view.faces) // chunk)
        self._vertex_chunks = -(-self.vertices // chunk)
        self._face_counts, self._vertex_counts = (
            readable(np.zeros(self.frames * chunks, dtype=np.int32))
            for chunks in (self._face_chunks, self._vertex_chunks)
        )
        self.vertex_list, self.vertex_entries = empty(ti.i32, 0), 0
        nothing = empty(ti.i32, 0)
        self.tree = bundles.Tree(
            levels=0,
            level_start=nothing,
            boxes=_boxes(0),
            list_start=nothing,
            face_list=nothing,
        )

    def _upload(self, view: SkinView) -> None:
        self.skin = bundles.Skin(
            points=on_device(view.points_mm, vector=3),
            normals=on_device(view.normals, vector=3),
            faces=on_device(view.faces),
        )
        self._fans = bundles.Fans(
            area=on_device(view.area_mm2, vector=3),
            face_start=on_device(view.face_start),
            face_of=on_device(view.face_of),
        )
        self.sights = bundles.Sights(
            start_pixel=on_device(view.start_pixel, vector=2),
            outward_to_camera=on_device(view.to_camera, vector=3),
            foot_map=on_device(view.foot_map, vector=3),
            way_map=on_device(view.way_map, vector=3),
        )
        self.rays = bundles.Rays(
            origin=on_device(view.origin_mm, vector=3),
            direction=on_device(view.direction, vector=3),
            width=view.width_px,
            height=view.height_px,
            pad=view.pad_px,
        )
        self._layers = bundles.Layers(
            some_folded=int(view.folded.any()),
            folded=on_device(view.folded),
            layer_start=on_device(view.layer_start),
            layer_face=on_device(view.layer_face),
            layer_mm=on_device(view.layer_mm),
        )
        self.transmittance = on_device(view.transmittance)
        self._seen_start, self._seen_pixel = on_device(view.seen_start), on_device(view.seen_pixel)

    def look(self, displacement_mm: Any) -> None:
        """Find what every pixel sees in k frames of displacement [mm], shape (k, V, 3), float32.

        k is at most `frames`; an array, or a tensor of PyTorch on the device.
        """
        frames, placed = len(displacement_mm), self.posed.placed
        displacement = readable(displacement_mm, vector=3)
        faces = self._list(displacement, frames)
        place_vertices: Any = patch_kernels.place_vertices
        place_vertices(
            self.vertex_entries,
            self.vertex_list,
            displacement,
            self._moved,
            self.skin,
            self._fans,
            self.sights,
            self.posed,
            self._pixel,
        )
        build_tree: Any = tree_kernels.build_tree
        build_tree(frames, self.tree, self.skin, placed)
        draw: Any = raster_kernels.draw
        draw(
            faces,
            self.tree.face_list,
            self.skin,
            placed,
            self._pixel,
            self.rays,
            self._seen_start,
            self._seen_pixel,
            self._keys,
        )
        resolve: Any = raster_kernels.resolve
        resolve(
            frames,
            self._keys,
            self._moved,
            self.skin,
            placed,
            self.rays,
            self._layers,
            self.tree,
            self.seen,
        )

    def _list(self, displacement: Any, frames: int) -> int:
        """Make the lists of moved faces and their vertices; returns the number of faces."""
        patch_kernels.find_moved(
            displacement,
            self.skin.faces,
            MOVED_MM**2,
            self._moved,
            self._used,
            self._face_counts,
            self._vertex_counts,
        )
        face_at = _running(self._face_counts, frames * self._face_chunks)
        vertex_at = _running(self._vertex_counts, frames * self._vertex_chunks)
        faces, self.vertex_entries = int(face_at[-1]), int(vertex_at[-1])
        self._grow(face_at[:: self._face_chunks].copy(), faces)
        self.vertex_list = _roomy(self.vertex_list, self.vertex_entries)
        patch_kernels.list_moved(
            frames,
            self.vertices,
            self.skin.faces,
            self._moved,
            self._used,
            readable(face_at[:-1].copy()),
            readable(vertex_at[:-1].copy()),
            self.tree.face_list,
            self.vertex_list,
        )
        return faces

    def _grow(self, list_start: np.ndarray, faces: int) -> None:
        """Give the tree its levels, and room for its list and boxes, for k frames: (k + 1,)."""
        tree = self.tree
        tree["levels"], starts = tree_levels(int(np.diff(list_start).max()))
        tree["level_start"], tree["list_start"] = readable(starts), readable(list_start)
        tree["face_list"] = _roomy(tree.face_list, faces)
        count = (len(list_start) - 1) * int(starts[-1])
        if tree.boxes.shape[0] < count:
            tree["boxes"] = _boxes(count + count // 2)


def _running(counts: Any, entries: int) -> np.ndarray:
    """Sums before each of the first entries, and the whole, int32."""
    found = counts if isinstance(counts, np.ndarray) else counts.to_numpy()
    return np.append(0, np.cumsum(found[:entries])).astype(np.int32)


def _boxes(count: int) -> Any:
    """Room for so many boxes of a tree."""
    return on_device(np.zeros((count, 4, 3), dtype=np.float32), vector=3)


def _roomy(numbers: Any, count: int) -> Any:
    """The array of int32, or one half as large again where it is too small."""
    return numbers if numbers.shape[0] >= count else empty(ti.i32, count + count // 2)
