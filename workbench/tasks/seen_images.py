"""Images as a network sees them: their size, their difference from rest, the motion in a window.

A network that learns from few presses is shown what is around the contact, laid flat, with its
place told beside it: else it would have to learn the same at every place. The contact is where the
image differs most from rest. Shapes are told by the dent that is read there, motion by the images
as they are: in a difference the dots at rest stay where they were, and seem to hold the skin.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core.design.design import SensorDesign
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.store import Store
from workbench.tasks.dent_sight import DentSight
from workbench.tasks.networks.patch import DROP, GREY_PER_MM
from workbench.tasks.skin_sight import SkinSight
from workbench.tasks.task import Net

PLACE_MM = 10.0
"""Millimetres that count as one where a place is told."""
NOWHERE = np.zeros(3), np.eye(3)
"""Foot and axes where no contact is looked for: the sensor's own frame."""
FEWEST_CORNERS = 4
CORNERS = {"maxCorners": 200, "qualityLevel": 0.05, "minDistance": 4.0}


@dataclass(frozen=True, kw_only=True, slots=True)
class View:
    """What of an image is seen."""

    width_px: int
    """Images that are wider are made smaller [px]."""
    sight: SkinSight | None = None
    """Lays what is around the contact flat; none: all of the image is seen."""
    dents: DentSight | None = None
    """Reads the dent, which is seen in place of the difference."""
    whole_light: bool = False
    """Whether the image itself is seen around the contact, not its difference from rest."""

    def size_px(self, width_px: int, height_px: int) -> tuple[int, int]:
        """Width and height at which an image is seen; never enlarged but to that of the sight."""
        if self.sight is not None:
            return self.sight.size_px
        width = min(width_px, self.width_px)
        return width, max(1, round(height_px * width / width_px))


WIDTHS_PX = {
    Net.DENT: 320,
    Net.MEASURES: 320,
    Net.LITE: 160,
    Net.OWN: 160,
    Net.MOTION: 320,
    Net.PAPER: 298,
}
"""Of what each network sees [px]; 298 of 4:3 is 224 high, as in the paper's script."""


def whole(net: Net) -> View:
    """A view of the whole image."""
    return View(width_px=WIDTHS_PX[net])


def view_of(net: Net, mesh: MembraneMesh, design: SensorDesign, store: Store) -> View:
    """What a network is shown of a design's images.

    Args:
        net: Which one.
        mesh: Of the design.
        design: Whose light and camera it is.
        store: Keeps the light that dents are read by.

    Raises:
        DesignError: If the camera is outside the cavity.
    """
    if net is Net.PAPER:
        return whole(net)
    width_px = WIDTHS_PX[net]
    return View(
        width_px=width_px,
        sight=SkinSight.of(mesh, design.optics, width_px),
        dents=DentSight(design, store) if net in (Net.DENT, Net.MEASURES) else None,
        whole_light=net is Net.MOTION,
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class Change:
    """What differs from rest."""

    grey: np.ndarray
    """Differences [grey level], or what the view has in their place, shape (T, h, w, 3), int16. Of
    a dent the first channel is how far the skin went inward, `DROP` how far it lay inward before,
    both `GREY_PER_MM` for a millimetre."""
    at: tuple[float, ...]
    """Eight numbers: where its middle is, across and down, from -1 to 1 over the image; how far it
    reaches and where its foot is on the skin, x, y and z, in `PLACE_MM`; root mean square and
    largest of the difference, logarithms from 0 to 1."""
    foot_mm: np.ndarray
    """Middle of the contact on the skin [mm], shape (3,)."""
    axes: np.ndarray
    """Axes of the contact, as `Touch` has them, shape (3, 3)."""


def change(images: Sequence[np.ndarray], idle: np.ndarray, view: View) -> Change:
    """Images (H, W, 3) uint8 less the one at rest, the same part of each."""
    import cv2

    size_px = view.size_px(idle.shape[1], idle.shape[0])
    rest, *shown = (
        cv2.resize(image, size_px, interpolation=cv2.INTER_AREA) for image in (idle, *images)
    )
    grey = np.stack([image.astype(np.int16) - rest.astype(np.int16) for image in shown])
    if view.sight is None:
        at = (0.0, 0.0, 1.0, 0.0, 0.0, 0.0, *_strength(grey))
        return Change(grey=grey, at=at, foot_mm=NOWHERE[0], axes=NOWHERE[1])
    touch = view.sight.touch(grey)
    flat = view.sight.flat(touch)
    part = flat.laid(_looked_at(shown, rest, grey, view))
    strength = _strength(part)
    if view.dents is not None:
        # How the skin lay before belongs to it: in a cylinder's skin a ball leaves an ellipse.
        part[..., DROP] = np.rint(GREY_PER_MM * flat.drop_mm)
    middle = (2.0 * at / size - 1.0 for at, size in zip(touch.middle_px, size_px, strict=True))
    foot = (touch.foot_mm / PLACE_MM).tolist()
    return Change(
        grey=part,
        at=(*middle, touch.spread_mm / PLACE_MM, *foot, *strength),
        foot_mm=touch.foot_mm,
        axes=touch.axes,
    )


def _looked_at(
    shown: Sequence[np.ndarray], rest: np.ndarray, grey: np.ndarray, view: View
) -> np.ndarray:
    """What is laid flat of images of one size and the one at rest, shape (T, H, W, 3), int16."""
    if view.dents is not None:
        return np.stack([view.dents.dent_grey(image, rest) for image in shown])
    return np.stack(shown).astype(np.int16) if view.whole_light else grey


def _strength(grey: np.ndarray) -> tuple[float, float]:
    """How much differs: root mean square and largest, 0 of nothing and 1 of 255 grey levels."""
    sizes = float(np.sqrt((grey.astype(np.float64) ** 2).mean())), float(np.abs(grey).max())
    mean, largest = (math.log1p(size) / math.log(256.0) for size in sizes)
    return mean, largest


def motion(images: Sequence[np.ndarray]) -> float:
    """Mean motion of corners from the first to the last image over its width; 0 of one image.

    On skin with markers the corners are those of the markers. They are followed by the method of
    Lucas and Kanade over pyramids. Source: Bouguet, Pyramidal implementation of the Lucas Kanade
    feature tracker, 2000; corners: Shi and Tomasi, Good features to track, 1994.
    """
    if len(images) < 2:
        return 0.0
    import cv2

    first, last = (cv2.cvtColor(image, cv2.COLOR_RGB2GRAY) for image in (images[0], images[-1]))
    corners = cv2.goodFeaturesToTrack(first, **CORNERS)
    if corners is None or len(corners) < FEWEST_CORNERS:
        return 0.0
    moved, found, _ = cv2.calcOpticalFlowPyrLK(first, last, corners, corners.copy())
    away_px = np.linalg.norm((moved - corners).reshape(-1, 2), axis=1)[found.ravel() == 1]
    return float(away_px.mean()) / first.shape[1] if len(away_px) else 0.0
