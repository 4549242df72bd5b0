"""The skin as a camera sees it: where a contact is, and what is around it, laid flat.

A contact at the side of a finger is seen from aside, one at its tip from above, and each is as many
pixels large as it is near. Which point of the skin at rest a pixel sees is known from the design.
So what is around a contact is shown as one who looks straight at the skin there would see it, in
millimetres: at every place the same object looks nearly the same. What the camera does not see of
it counts as unchanged.

The frame of a contact is its foot on the skin and three axes: away from the camera along the skin,
across, and outward. Forces and places are told in it.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from workbench.core.design.optics import Optics
from workbench.core.result.results import MembraneMesh
from workbench.tasks.networks.patch import HALF_MM, PATCH_PX

SMOOTH_PX, OVER_NOISE, NEAR_MM = 1.5, 6.0, 7.0
"""Blur of differences where a contact is looked for [px], what is noise over the median [1], and
how far from its peak it may reach [mm]."""
FLAT_MM = 2.0
"""Normals are averaged so far around the foot [mm]."""
FACING = 0.05
"""Cosine below which skin is turned away from that at the foot."""
STEEP_MM = 1e-3
"""Way along the skin away from the camera below which it has no direction [mm]."""
MOST_PIXELS = 1500
"""Pixels that a patch is interpolated from, at most."""
AROUND = 1.7
"""How far those reach, over half the side: a little more than its corners."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Touch:
    """Where a contact is."""

    middle_px: tuple[float, float]
    """Column and row of the pixel that sees its foot, from the first pixel's centre."""
    foot_mm: np.ndarray
    """Middle of what differs, on the skin at rest [mm], shape (3,)."""
    axes: np.ndarray
    """Unit axes in its rows: along the skin, across, outward; shape (3, 3)."""
    spread_mm: float
    """Standard deviation of what differs, on the skin [mm]."""


class SkinSight:
    """What each pixel sees of the skin at rest."""

    def __init__(self, hit_mm: np.ndarray, camera_mm: np.ndarray, pad_px: int) -> None:
        """Take what pixels see.

        Args:
            hit_mm: Points of the skin [mm], shape (H + 2 pad, W + 2 pad, 3); NaN where there is
                none. The pixels of a border around the image tell what is just out of sight.
            camera_mm: Where the camera is [mm], shape (3,).
            pad_px: Width of the border.
        """
        from scipy.spatial import KDTree

        self._camera_mm = camera_mm
        down, across = np.gradient(hit_mm, axis=(0, 1))
        area = np.cross(across, down)
        size = np.linalg.norm(area, axis=2)
        rows, columns = np.nonzero(size > 0.0)
        self._points_mm = hit_mm[rows, columns]
        self._pixels = np.column_stack([columns, rows]) - float(pad_px)
        outward = area[rows, columns] / size[rows, columns, None]
        away = np.einsum("ij,ij->i", outward, self._points_mm - camera_mm)
        self._outward = outward * np.where(away < 0.0, -1.0, 1.0)[:, None]
        self._tree = KDTree(self._points_mm)
        height, width = hit_mm.shape[:2]
        inner = slice(pad_px, height - pad_px), slice(pad_px, width - pad_px)
        self._area = np.nan_to_num(size[inner])
        """Skin that each pixel of the image sees [mm2]; 0 where it sees none."""
        self._seen_mm = np.nan_to_num(hit_mm[inner])

    @classmethod
    def of(cls, mesh: MembraneMesh, optics: Optics, width_px: int) -> SkinSight:
        """That of a design's first camera in images of a width [px].

        Raises:
            DesignError: If the camera is outside the cavity.
        """
        from sim.optics.camera.projection import open_map

        height_px = max(1, round(optics.camera.height_px * width_px / optics.camera.width_px))
        camera = dataclasses.replace(optics.camera, width_px=width_px, height_px=height_px)
        seen = open_map(mesh, camera, index=optics.refractive_index)
        place_mm = np.asarray(camera.position_mm, np.float64)
        return cls(seen.hit_mm.astype(np.float64), place_mm, seen.pad_px)

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height of the image that it is of."""
        return self._area.shape[1], self._area.shape[0]

    def touch(self, grey: np.ndarray) -> Touch:
        """The contact in differences from rest, shape (T, H, W, 3), of the image's size.

        Its foot is the mean over the skin of the square of the difference near the peak. What
        photographs have of noise everywhere is smoothed, and left out below `OVER_NOISE` times
        what half of the pixels have. Without any difference it is in the middle of what is seen.
        """
        import cv2

        smooth = [cv2.GaussianBlur(one.astype(np.float32), (0, 0), SMOOTH_PX) for one in grey]
        power = (np.stack(smooth).astype(np.float64) ** 2).sum(axis=(0, 3))
        power = np.maximum(power - OVER_NOISE * np.median(power), 0.0) * (self._area > 0.0)
        if power.any():
            peak_mm = self._seen_mm[np.unravel_index(int(power.argmax()), power.shape)]
            near = np.linalg.norm(self._seen_mm - peak_mm, axis=2) < NEAR_MM
            weight = self._area * power * near
        else:
            weight = self._area
        weight = weight / weight.sum()
        middle_mm = np.tensordot(weight, self._seen_mm, axes=2)
        off_mm2 = ((self._seen_mm - middle_mm) ** 2).sum(axis=2)
        return self._framed(middle_mm, float(np.sqrt((weight * off_mm2).sum())))

    def _framed(self, middle_mm: np.ndarray, spread_mm: float) -> Touch:
        nearest = int(self._tree.query(middle_mm)[1])
        foot_mm = self._points_mm[nearest]
        around = self._outward[self._tree.query_ball_point(foot_mm, FLAT_MM)]
        outward = _unit(around.sum(axis=0))
        along = foot_mm - self._camera_mm
        along = along - (along @ outward) * outward
        if np.linalg.norm(along) < STEEP_MM:
            # Straight in front of the camera no way along the skin leads away from it.
            along = np.eye(3)[int(np.abs(outward).argmin())]
            along = along - (along @ outward) * outward
        along = _unit(along)
        return Touch(
            middle_px=(float(self._pixels[nearest, 0]), float(self._pixels[nearest, 1])),
            foot_mm=middle_mm,
            axes=np.stack([along, np.cross(outward, along), outward]),
            spread_mm=spread_mm,
        )

    def flat(self, touch: Touch) -> Flat:
        """What is around a contact as one sees it who looks straight at the skin there."""
        from scipy.interpolate import LinearNDInterpolator

        near = np.sort(self._tree.query_ball_point(touch.foot_mm, AROUND * HALF_MM))
        near = near[self._outward[near] @ touch.axes[2] > FACING]
        near = near[:: max(1, math.ceil(len(near) / MOST_PIXELS))]
        off_mm = (self._points_mm[near] - touch.foot_mm) @ touch.axes.T
        steps_mm = ((np.arange(PATCH_PX) + 0.5) / PATCH_PX * 2.0 - 1.0) * HALF_MM
        known = np.column_stack([self._pixels[near], -off_mm[:, 2]])
        found = LinearNDInterpolator(off_mm[:, :2], known)(*np.meshgrid(steps_mm, steps_mm))
        # What no pixel sees lies far outside of the image, where nothing differs.
        columns, rows = np.moveaxis(np.nan_to_num(found[..., :2], nan=-9.0), 2, 0)
        return Flat(
            columns=columns.astype(np.float32),
            rows=rows.astype(np.float32),
            drop_mm=np.nan_to_num(found[..., 2]),
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Flat:
    """A square of the skin around a contact, `PATCH_PX` a side."""

    columns: np.ndarray
    """Of the image's pixels that see it, shape (S, S), float32."""
    rows: np.ndarray
    drop_mm: np.ndarray
    """How far the skin at rest lies inward of the plane that touches it at the foot [mm], shape
    (S, S); 0 where none is seen."""

    def laid(self, grey: np.ndarray) -> np.ndarray:
        """Images (T, H, W, 3) of the sight's size, laid flat, shape (T, S, S, 3)."""
        import cv2

        return np.stack([cv2.remap(one, self.columns, self.rows, cv2.INTER_LINEAR) for one in grey])


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector)
