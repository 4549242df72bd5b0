"""Where a contact slides, how much of it, and when all of it does: for every solver and mesh alike.

A place of the skin that touched the object at both ends of a frame slides in it where

    |x - X| > max(SLIDING_RATE w, LEAST_MM),

x: where it is, across the normal; X: where the place of the object that it was on has gone
meanwhile; w: the way of that place of the object, or of the object's origin or of a driven region
where one of these goes farther. This is a ratio of two ways of the same frame, so neither the
number of frames nor of increments enters, nor how a solver holds on to what sticks. The share of
the contact that slides is the area at rest of these places over that of all that touched at both
ends; gross slip begins where it reaches `GROSS_SHARE`.

The rate was chosen by measurement. Under a ball that is dragged (Cattaneo, 1938; Mindlin, 1949)
the annulus about a stick radius c slips at r by 1 - (2 / pi) asin(c / r) of the object's way: the
traction of an increment is that of a stuck disc of radius c (Johnson, Contact Mechanics, 1985,
7.2), so a rate q reads c as c / sin((1 - q) pi / 2): 3 % larger at .15, 5 % at .2.
Cube, ball and flower on end and side of the finger (`slip_record`), pressed .6 mm and dragged by
1 mm at mu .3, read by the contact solver on .5 mm against converged finite elements, the frame
where they differ most, and the way to gross slip (the cube on the
side, which at other rates does not get there, left out: .04 mm at .15):

    rate     .05    .1     .15    .2     .3
    share    .17    .16    .10    .13    .16
    onset    .07    .07    .02    .02    .03 mm

Below, cells at the edge of a cube that a coarse grid does not resolve count as slipping; above, the
annulus is seen late. Elastic slip of finite elements, 5 um, is within the rate from .03 mm on.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

SLIDING_RATE = 0.15
"""Motion of a place relative to the object over the object's way above which it slides."""
LEAST_MM = 1e-3
"""Motion below which nothing slides: where the object rests, a solver's tolerance moves places."""
GROSS_SHARE = 0.95
"""Share of the contact that slides from which slip counts as gross: the last place to slide is as
small as a cell."""
MOST_OF_IT = 0.5
"""Share of the touching area around a vertex above which the vertex slides."""
LEAST_MM2 = 1e-12


@dataclass(frozen=True, kw_only=True, slots=True)
class Slip:
    """One frame at P places of a contact."""

    sliding: np.ndarray
    """Whether each place slides, shape (P,), bool."""
    stayed: np.ndarray
    """Whether it touched the object at both ends of the frame, shape (P,), bool."""

    def share(self, area_mm2: np.ndarray) -> float:
        """Share of the contact that slides, places standing for areas at rest (P,); 0 if none."""
        whole_mm2 = float(area_mm2[self.stayed].sum())
        return float(area_mm2[self.sliding].sum()) / max(whole_mm2, LEAST_MM2)


@dataclass(frozen=True, kw_only=True, slots=True)
class GrossSlip:
    """When all of a contact began to slide."""

    frame: int
    """First frame in which it does, from 1."""
    way_mm: float
    """Way of the object along the skin until then [mm]."""


def slip_of(moved_mm: np.ndarray, way_mm: np.ndarray, stayed: np.ndarray) -> Slip:
    """Which places slide in a frame.

    Args:
        moved_mm: Motion of each place relative to the object, across the normal [mm], shape (P,).
        way_mm: Way of the object there, w above [mm], shape (P,).
        stayed: Whether each place touched the object at both ends of the frame, shape (P,), bool.
    """
    return Slip(sliding=stayed & (moved_mm > slides_from_mm(way_mm)), stayed=stayed)


def slides_from_mm(way_mm: np.ndarray | float) -> np.ndarray:
    """Motion relative to an object that goes a way w, from which a place slides [mm]."""
    return np.maximum(SLIDING_RATE * way_mm, LEAST_MM)


def object_way_mm(now_mm: np.ndarray, before_mm: np.ndarray, least_mm: float) -> np.ndarray:
    """Way of the object at each place [mm], shape (P,): w above.

    Args:
        now_mm: Where places of the object are at the end of the frame [mm], shape (P, 3).
        before_mm: Where the same places of the object were at its start, shape (P, 3).
        least_mm: Way of its origin, as a ball that rolls stands still where it touches; or the
            farthest of a driven region of the membrane.
    """
    return np.maximum(np.linalg.norm(now_mm - before_mm, axis=1), least_mm)


def gross_slip(share: np.ndarray, way_mm: np.ndarray) -> GrossSlip | None:
    """When gross slip began; None if it did not.

    The share of a frame stands for the middle of its way; between two middles it is linear.

    Args:
        share: Share of the contact that slides, frame by frame, shape (K,).
        way_mm: Way of the object along the skin by the end of each frame [mm], shape (K,).
    """
    whole = np.flatnonzero(share >= GROSS_SHARE)
    if not len(whole):
        return None
    first = int(whole[0])
    middle_mm = 0.5 * (way_mm + np.append(0.0, way_mm[:-1]))
    if first == 0 or middle_mm[first] <= middle_mm[first - 1]:
        return GrossSlip(frame=first + 1, way_mm=float(middle_mm[first]))
    below, above = share[first - 1], share[first]
    part = (GROSS_SHARE - below) / (above - below)
    way = middle_mm[first - 1] + part * (middle_mm[first] - middle_mm[first - 1])
    return GrossSlip(frame=first + 1, way_mm=float(way))


def mindlin_share(ratio: float) -> float:
    """Share of a dragged ball's contact that slides, by this definition: the closed form.

    1 - (c / a)^2 / sin^2((1 - q) pi / 2) with c / a = (1 - Q / (mu P))^(1/3); Cattaneo, 1938;
    Mindlin, 1949.

    Args:
        ratio: Tangential force Q over mu times the normal force P, in [0, 1].
    """
    stuck = (1.0 - ratio) ** (1.0 / 3.0) / math.sin(0.5 * math.pi * (1.0 - SLIDING_RATE))
    return max(0.0, 1.0 - stuck**2)
