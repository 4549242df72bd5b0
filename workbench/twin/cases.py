"""What is pressed into a twin, and where: press paths, several photographs of each.

A path costs its deepest state and the way there, so each gives photographs on its way: a ball for
calibration two, an object three, a slide two sequences of eight frames. Paths have no last one:
one that cannot be solved, or never slips, is replaced by the next.

Places lie as far apart as they can on the skin that the twin's camera sees, off the rim and off the
edge of the image; presses and slides share theirs, so that a split by place has several objects at
each.
"""

from __future__ import annotations

import dataclasses
import enum
import math
from dataclasses import dataclass

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.objects.kind import Shape
from workbench.core.press.indenter import BALL, Indenter, IndenterKind, widest_edge_mm
from workbench.core.press.motion import slide
from workbench.core.press.press import Press
from workbench.core.result.results import MembraneMesh, Skin
from workbench.learning.dataset.positions import far_apart, inside_margin
from workbench.learning.dataset.recipes import CLASSES
from workbench.learning.dataset.sequences import FRAMES
from workbench.twin.draw import Draws, Twin, stream
from workbench.twin.printed_ball import printed_ball
from workbench.twin.twin_plan import TwinPlan

BALL_FRAMES, PRESS_FRAMES = 2, 3
"""Photographs of a path."""
BALL_DEPTH_MM, PRESS_DEPTH_MM, SLIDE_DEPTH_MM = (0.6, 1.0), (0.9, 1.0), (0.4, 0.7)
"""Depth at the end of a path: presses are then photographed from .3 mm on."""
SLIDE_STEP_MM, SLIDE_FRAMES = 0.1, 16
"""Way of a frame, and frames, of what is dragged after it was pressed."""
PLACES = 25
"""Places of presses and slides."""
EDGE_SHARE = 0.08
"""Of the image's width: a place lies at least so far inside it."""
ROOM_MM = 0.5
"""Between half the object and the rim of the skin."""
MOST_TURN_DEG = 40.0
"""By which skin below an object may be turned from that at its middle: edges are beyond."""
EDGE_MM = 0.45
"""Rounding of edges of other objects than balls, where they take it."""
ROUND = (Shape.CYLINDER_Z, Shape.CONE)
"""About the axis of the press: turned about it they are the same."""


class Kind(enum.StrEnum):
    """What a path is photographed for."""

    CALIBRATION = "calibration"
    PRESS = "press"
    SLIDE = "slide"


@dataclass(frozen=True, kw_only=True, slots=True)
class TwinCase:
    """One press path."""

    kind: Kind
    number: int
    """Among those of its kind, from 0."""
    name: str
    """Of the object."""
    indenter: Indenter
    place: str
    press: Press

    @property
    def id(self) -> str:
        """Readable and unique within a twin."""
        return f"{self.kind.value}{self.number:04d}"

    def depth_at_mm(self, frame: int) -> float:
        """Depth of a frame from first touch."""
        return self.press.depth_mm * min(1.0, (frame + 1) / self.press.frames)


@dataclass(frozen=True, kw_only=True, slots=True)
class Ground:
    """Vertices of the outer skin that the camera sees well."""

    places_mm: np.ndarray
    """Shape (N, 3)."""


def seen_ground(
    mesh: MembraneMesh, pixels: np.ndarray, visible: np.ndarray, reach_mm: float
) -> Ground:
    """Where a twin can be pressed.

    Args:
        mesh: Its skins.
        pixels: u, v [px] of the vertices of `mesh.seen` over the width and height of the image,
            shape (V, 2), NaN outside.
        visible: Whether the camera sees them, shape (V,), bool.
        reach_mm: Half the width of the largest object.

    Raises:
        DesignError: If no vertex is left.
    """
    chosen = inside_margin(mesh.outer, reach_mm + ROOM_MM) & ~_near_edges(mesh.outer, reach_mm)
    if mesh.seen is mesh.outer:
        with np.errstate(invalid="ignore"):
            inside = ((pixels > EDGE_SHARE) & (pixels < 1.0 - EDGE_SHARE)).all(axis=1)
        chosen &= visible & inside
    if not chosen.any():
        raise DesignError(
            f"the camera sees no skin that an object of {2.0 * reach_mm:g} mm can be pressed into, "
            "off edges, the rim and the edge of the image",
            hint="turn the camera, or make the sensor larger",
            at="optics.camera",
        )
    return Ground(places_mm=mesh.outer.points_mm[chosen])


def _near_edges(skin: Skin, reach_mm: float) -> np.ndarray:
    """Vertices that an object would press together with skin that looks elsewhere, (V,), bool."""
    from scipy.spatial import KDTree

    tree = KDTree(skin.points_mm)
    pairs = tree.query_pairs(reach_mm, output_type="ndarray")
    cosine = np.einsum("pc,pc->p", skin.normals[pairs[:, 0]], skin.normals[pairs[:, 1]])
    found = np.zeros(len(skin.points_mm), bool)
    found[pairs[cosine < math.cos(math.radians(MOST_TURN_DEG))].ravel()] = True
    return found


def case(twin: Twin, plan: TwinPlan, ground: Ground, kind: Kind, number: int) -> TwinCase:
    """Path `number` of a kind; the same however many are made."""
    if kind is Kind.CALIBRATION:
        return _ball_case(twin, plan, ground, number)
    rng = stream(twin.seed, Draws.PRESSES if kind is Kind.PRESS else Draws.SLIDES, number)
    name = CLASSES[number % len(CLASSES)]
    spin_deg, depth, way = (float(value) for value in rng.random(3))
    low, high = PRESS_DEPTH_MM if kind is Kind.PRESS else SLIDE_DEPTH_MM
    place = number % PLACES
    depth_mm = low + depth * (high - low)
    if kind is Kind.PRESS:
        press = Press(target_mm=_place(twin, ground, place), depth_mm=depth_mm, frames=PRESS_FRAMES)
    else:
        far_mm, angle = SLIDE_STEP_MM * SLIDE_FRAMES, 2.0 * math.pi * way
        moved = slide(far_mm * math.cos(angle), far_mm * math.sin(angle), frames=SLIDE_FRAMES)
        press = Press(
            target_mm=_place(twin, ground, place),
            depth_mm=depth_mm,
            frames=FRAMES,
            strokes=(moved,),
        )
    return TwinCase(
        kind=kind,
        number=number,
        name=name,
        indenter=_indenter(twin, plan, IndenterKind(name), 360.0 * spin_deg - 180.0),
        place=f"place{place:02d}",
        press=press,
    )


def _ball_case(twin: Twin, plan: TwinPlan, ground: Ground, number: int) -> TwinCase:
    rng = stream(twin.seed, Draws.PLACES, 1 + number)
    low, high = BALL_DEPTH_MM
    first = stream(twin.seed, Draws.PLACES)
    at = far_apart(ground.places_mm, number + 1, first)[number]
    x, y, z = (float(value) for value in ground.places_mm[at])
    return TwinCase(
        kind=Kind.CALIBRATION,
        number=number,
        name=BALL.value,
        indenter=_ball(twin, plan),
        place=f"ball{number:02d}",
        press=Press(
            target_mm=(x, y, z),
            depth_mm=low + float(rng.random()) * (high - low),
            frames=BALL_FRAMES,
        ),
    )


def _place(twin: Twin, ground: Ground, number: int) -> tuple[float, float, float]:
    rng = stream(twin.seed, Draws.PRESSES, 2**30)
    at = far_apart(ground.places_mm, number + 1, rng)[number]
    x, y, z = (float(value) for value in ground.places_mm[at])
    return x, y, z


def _indenter(twin: Twin, plan: TwinPlan, kind: IndenterKind, spin_deg: float) -> Indenter:
    if kind is BALL:
        return _ball(twin, plan)
    widest_mm = widest_edge_mm(kind, plan.object_mm)
    edge_mm = EDGE_MM if widest_mm is None else min(EDGE_MM, widest_mm)
    upright = Indenter(kind=kind, size_mm=plan.object_mm, edge_radius_mm=edge_mm)
    if upright.record.shape in ROUND:
        return upright
    return dataclasses.replace(upright, turn_deg=(0.0, 0.0, round(spin_deg, 3)))


def _ball(twin: Twin, plan: TwinPlan) -> Indenter:
    return printed_ball(plan.ball_mm + twin.ball_error_mm, twin.layer_mm)
