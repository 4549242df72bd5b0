"""How far the skin must stretch for the core to leave it, downward or aslant.

Three things hold a core, each a strain of the skin:

- a section must pass a narrower one below it: circumference over circumference, less 1;
- a pin's wide end must pass its narrow root, likewise;
- a bent core must pass where it is not: the skin is straightened on its way. A skin of half width
  r around an axis of curvature k stretches by r k (Euler and Bernoulli), which for the parabola
  c = b (z / L)^2 is 2 r b / L^2.

Bending is asked of a stretch of core only as far as it is held: with e the least sideways shift
that lets its upper section into the opening at its lower end, k is no more than 2 e / l^2, the
parabola that gives that shift over the length l. Sections that fit into all below them so ask for
none, however their middles wander.

Leaves out: friction, and the relief by turning a core out along its own arc.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from geometry.body.csg import Body
from geometry.body.csg_mesh import evaluate
from geometry.mould.castability import Worst, removal_strain
from workbench.core.result.results import Label, LabelledSurface

CORE_SECTIONS = 60
DIRECTIONS = 36
"""Sideways directions looked at, evenly around; the opposite of each is one of them."""
PIN_BINS = 12
DOWN = np.array([0.0, 0.0, -1.0])


def core_strain(core: Body) -> Worst:
    """Strain of the elastomer when the core leaves downward, by circumferences of its sections."""
    body = evaluate(core)
    heights = _heights(core)
    around = np.array([_around(body.slice(float(height))) for height in heights])
    strain = removal_strain(heights, around)
    middle = core.points_mm.mean(axis=0)
    return Worst(strain.value, (float(middle[0]), float(middle[1]), strain.place_mm[2]))


def bend_strain(core: Body, membrane: LabelledSurface, way: np.ndarray = DOWN) -> Worst:
    """Strain of the skin when a bent core leaves; 0 for a straight or nested core.

    A core that leaves aslant is a core that leaves downward, all sheared until its way is upright:
    sections stay level and keep their outlines.

    Args:
        membrane: The elastomer's surface: its outside is stretched most.
        way: Unit direction in which it leaves, shape (3,).
    """
    lean = np.array([way[0] / way[2], way[1] / way[2], 0.0])
    core = Body(points_mm=core.points_mm - core.points_mm[:, 2:] * lean, faces=core.faces)
    skin_mm = membrane.points_mm - membrane.points_mm[:, 2:] * lean
    heights = _heights(core)
    reach = _reach(core, heights)
    opposite = np.roll(reach, DIRECTIONS // 2, axis=1)
    skin = _reach(Body(points_mm=skin_mm, faces=membrane.faces), heights)
    skin = (skin + np.roll(skin, DIRECTIONS // 2, axis=1)) / 2
    middle, half = (reach - opposite) / 2, (reach + opposite) / 2
    # Where shrinkage or rounding lifts the core's tip above the skin's own, the core's width is r.
    skin = np.fmax(skin, half)
    worst = Worst(0.0, (0.0, 0.0, 0.0))
    for span in range(2, len(heights), 2):
        length = heights[span] - heights[0]
        low, mid, high = (slice(k, len(heights) - span + k) for k in (0, span // 2, span))
        poke = reach[high] - reach[low]
        held = np.maximum(np.minimum(poke, middle[high] - middle[low]), 0.0)
        bow = np.abs(middle[high] - 2.0 * middle[mid] + middle[low])
        curvature = np.minimum(4.0 * bow, 2.0 * held) / length**2
        # A piece shorter than its half width does not bend, it shears.
        strain = np.where(length >= half[mid], skin[mid] * curvature, 0.0)
        first, turn = np.unravel_index(int(np.argmax(strain)), strain.shape)
        if strain[first, turn] > worst.value:
            x, y = (float(middle[mid][first, k]) for k in (0, DIRECTIONS // 4))
            height = float(heights[mid][first])
            place = (x + height * float(lean[0]), y + height * float(lean[1]), height)
            worst = Worst(float(strain[first, turn]), place)
    return worst


def _heights(core: Body) -> np.ndarray:
    """Evenly spaced heights inside a body [mm], shape (H,)."""
    low, high = core.points_mm[:, 2].min(), core.points_mm[:, 2].max()
    return low + (high - low) * (np.arange(CORE_SECTIONS) + 0.5) / CORE_SECTIONS


def _reach(body: Body, heights: np.ndarray) -> np.ndarray:
    """How far sections of a body reach from the Z axis in each direction [mm], shape (H, D).

    NaN where there is no section.
    """
    turn = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    ways = np.stack([np.cos(turn), np.sin(turn)])
    solid, reach = evaluate(body), np.full((len(heights), DIRECTIONS), np.nan)
    for k, height in enumerate(heights):
        outlines = solid.slice(float(height)).to_polygons()
        if outlines:
            reach[k] = (np.concatenate([np.asarray(line) for line in outlines]) @ ways).max(axis=0)
    return reach


def _around(section: Any) -> float:
    """Length of the outlines of a section without its holes [mm]."""
    total = 0.0
    for outline in section.to_polygons():
        points = np.asarray(outline)
        ahead = np.roll(points, -1, axis=0)
        if (points[:, 0] * ahead[:, 1] - points[:, 1] * ahead[:, 0]).sum() > 0.0:
            total += float(np.linalg.norm(ahead - points, axis=1).sum())
    return total


def pin_strain(membrane: LabelledSurface) -> Worst:
    """Strain of the internal pins when the core leaves: the widest place toward the tip over the
    narrowest toward the root, less 1; the worst of all pins."""
    worst = Worst(0.0, (0.0, 0.0, 0.0))
    pins = membrane.has(Label.PIN)
    for number in np.unique(membrane.numbers[pins]):
        faces = membrane.faces[pins & (membrane.numbers == number)]
        points = membrane.points_mm[np.unique(faces)]
        bins = _pin_profile(points)
        if len(bins) < 2:
            continue
        # From the root (highest) down: what is above the tip-side width must have let it pass.
        narrow = np.minimum.accumulate(bins[::-1, 1])
        strain = bins[::-1, 1] / narrow - 1.0
        if strain.max() > worst.value:
            spot = points.mean(axis=0)
            worst = Worst(float(strain.max()), (float(spot[0]), float(spot[1]), float(spot[2])))
    return worst


def _pin_profile(points: np.ndarray) -> np.ndarray:
    """Height and greatest radius of a pin in slices, rising, shape (B, 2); rounded tip left out."""
    axis = (points[:, :2].min(axis=0) + points[:, :2].max(axis=0)) / 2
    radius = np.linalg.norm(points[:, :2] - axis, axis=1)
    height = points[:, 2]
    edges = np.linspace(height.min(), height.max() + 1e-9, PIN_BINS + 1)
    slices = np.digitize(height, edges) - 1
    found = [
        (float(height[slices == k].mean()), float(radius[slices == k].max()))
        for k in range(PIN_BINS)
        if (slices == k).any()
    ]
    return np.array(found).reshape(-1, 2)
