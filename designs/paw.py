"""Paw: a clover of round lobes, toe beads and a heel pad of three lobes standing proud on its top.

             .-""-..-""-.             seen from above: toes toward +Y
          .-/  __    __  \\-.
         /  __(  )  (  )__  \\         four toe beads, each over a lobe of the body
        |  (  )`' __ `'(  )  |
         \\  `'  /    \\  `'  /
          `;  .'      `.  ;'          the heel pad: one lobe in the middle, two behind
          |  (    __    )  |
           \\  `--'  `--'  /
            `-.__.--.__.-'

            .-.  ___  .-.             z = height_mm + pad_mm, tops of the beads
          _/   \\/   \\/   \\_           z = height_mm, the flat of the body, its rim rounded
         |   ___________   |          outside in: elastomer, support (rigid, clear), cavity
         |  |           |  |          the core is flat on top: the wall is thick under the beads
     ____|__|___________|__|____      z = 0, base plane
    |          | cam |          |
    |__________|_____|__________|     z = -base_height_mm, the rigid foot

| parameter          | meaning                                                     |
|--------------------|-------------------------------------------------------------|
| `height_mm`        | height of the flat over the base                            |
| `margin_mm`        | how far the body stands out round beads and heel pad        |
| `rim_mm`           | radius of the rounded rim of the body                       |
| `valley_mm`        | radius of the fillet between two lobes of the body          |
| `toe_count`        | number of toes                                              |
| `toe_ring_mm`      | distance of the toe beads from the axis                     |
| `toe_spread_deg`   | angle from the first toe to the last                        |
| `toe_width_mm`     | width of a toe bead, along X                                |
| `toe_length_mm`    | length of a toe bead, along Y                               |
| `toe_pad_mm`       | how far the toe beads stand out of the flat                 |
| `heel_mm`          | radius of the heel pad's two hind lobes                     |
| `heel_apart_mm`    | distance of their centres from each other                   |
| `heel_back_mm`     | distance of their centres behind the axis                   |
| `heel_front_mm`    | radius of the heel pad's front lobe, which is on the axis   |
| `heel_pad_mm`      | how far the heel pad stands out of the flat                 |
| `base_height_mm`   | height of the foot                                          |
| `base_lip_mm`      | how far the foot stands out beyond the skin                 |

Toe beads are half ellipsoids, the heel pad is a low prism whose rim is rounded all the way down.
The body's outline is theirs moved outward by the margin, with ovals of arcs for the ellipses
(`geometry/body/arcs.py`); the core's is the body's moved inward by the wall. All of it is exact:
planes, cylinders, tori, ellipsoids (`designs/mounds.py`).

Source of the defaults: measured on the released SimTac mesh of the paw (MIT). Leaves out: the V of
straight lines between its heel lobes, whose place a fillet takes; claws.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from designs.bodies import WALL_SHARE, Bodies, Fields
from designs.mounds import Block, block_body, stacked
from designs.paw_shape import PawShape, outlines
from designs.prisms import elliptic_foot
from designs.shells import hollow
from geometry.body.arcs import Arcs, Lobe
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers

CAVITY_MM = 3.0
"""Smallest half width and height of the cavity: room for camera and LEDs [mm]."""
BETWEEN_MM = 0.4
"""Smallest gap between beads, heel pad and rounded rim: what a mould can shape [mm]."""
CORE_RIM_SHARE = 0.4
"""Most of a core's narrowest lobe that its rim radius may take."""
CORE_BEND_MM = 0.5
"""Narrowest lobe of core and cavity [mm]: a printer's line."""
STEEPEST = 1.5
"""Highest bead over half its width, as a sucker's cup: higher ones bend over when pressed."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Paw:
    """Builds paws."""

    name: str = "paw"
    title: str = "Cat's paw"
    shape_type: type = PawShape

    def check(self, shape: PawShape, layers: Layers) -> None:
        """Refuse lobes that make no outline, beads that meet, and walls that leave no room.

        Raises:
            DesignError: Naming the field, its value and its limit.
        """
        if shape.toe_count != round(shape.toe_count):
            raise DesignError(
                f"toe count {shape.toe_count:g} is not a whole number",
                hint=f"choose {round(shape.toe_count)}",
                at="shape.toe_count",
            )
        _check_tops(shape)
        _check_gaps(shape, *outlines(shape))
        _check_inside(shape, layers)

    def soften(self, shape: PawShape) -> PawShape:
        """The paw with half the rim radius."""
        return replace(shape, rim_mm=shape.rim_mm / 2)

    def target(self, shape: PawShape, layers: Layers) -> tuple[float, float, float]:
        """The flat of the heel pad between its three lobes."""
        return 0.0, -shape.heel_back_mm / 2, shape.height_mm + shape.heel_pad_mm

    def build(self, shape: PawShape, layers: Layers) -> Bodies:
        """Build the five bodies.

        Raises:
            DesignError: As `check`.
            GeometryError: If the CAD kernel returned something else than asked for.
        """
        self.check(shape, layers)
        _, heel = outlines(shape)
        outer = stacked(_block(shape, 0.0), shape.toes, [heel], what="paw")
        core = block_body(_block(shape, layers.elastomer_mm), what="core")
        both_mm = layers.elastomer_mm + layers.support_mm
        cavity = block_body(_block(shape, both_mm), what="cavity")
        return Bodies(
            membrane=hollow(outer, core, what="elastomer"),
            outer=outer,
            core=core,
            support=hollow(core, cavity, what="support"),
            base=_foot(shape, layers),
        )

    def fields(self, shape: PawShape, layers: Layers) -> Fields:
        """Prisms on arcs and ellipsoids as signed distance fields."""
        self.check(shape, layers)
        outline, heel = outlines(shape)
        body, toes = _block(shape, 0.0), shape.toes

        def outer(points_mm: np.ndarray) -> np.ndarray:
            pads = [part.distance(points_mm) for part in (heel, *toes)]
            # Beads go on a little into the body, not down to the base plane.
            above = np.maximum(np.minimum.reduce(pads), body.top_mm - BETWEEN_MM - points_mm[:, 2])
            return np.minimum(body.distance(points_mm), above)

        spots, both_mm = outline.points_mm, layers.elastomer_mm + layers.support_mm
        (low_x, low_y), (high_x, high_y) = spots.min(axis=0).tolist(), spots.max(axis=0).tolist()
        return Fields(
            outer=outer,
            core=_block(shape, layers.elastomer_mm).distance,
            cavity=_block(shape, both_mm).distance,
            base=_foot(shape, layers),
            wall_mm=min(layers.elastomer_mm, _rim_wall_mm(shape, layers)),
            low_mm=(low_x, low_y, 0.0),
            high_mm=(high_x, high_y, shape.height_mm + max(shape.toe_pad_mm, shape.heel_pad_mm)),
        )


def _check_tops(shape: PawShape) -> None:
    """Refuse beads and rims that are too steep for their width."""
    width_mm = min(shape.toe_width_mm, shape.toe_length_mm)
    bend_mm = Lobe(x_mm=0.0, y_mm=0.0, half_mm=shape.toe_lobe_mm).bend_mm
    if bend_mm < shape.rim_mm + BETWEEN_MM:
        raise DesignError(
            f"lobes over toe beads {shape.toe_width_mm:g} x {shape.toe_length_mm:g} mm are bent to "
            f"{bend_mm:.2g} mm, less than the rim and {BETWEEN_MM:g} mm: "
            f"{shape.rim_mm + BETWEEN_MM:g} mm",
            hint="make shape.toe_width_mm and shape.toe_length_mm more alike, or raise "
            "shape.margin_mm",
            at="shape.toe_length_mm",
        )
    if shape.toe_pad_mm > STEEPEST * width_mm / 2:
        raise DesignError(
            f"toe beads {shape.toe_pad_mm:g} mm high on {width_mm:g} mm are more than "
            f"{STEEPEST * width_mm / 2:g} mm, {STEEPEST:g} times half their width",
            hint="lower shape.toe_pad_mm or raise shape.toe_width_mm and shape.toe_length_mm",
            at="shape.toe_pad_mm",
        )
    narrow_mm = min(shape.heel_mm, shape.heel_front_mm)
    if shape.heel_pad_mm > narrow_mm - BETWEEN_MM:
        raise DesignError(
            f"a heel pad {shape.heel_pad_mm:g} mm high leaves no flat on {narrow_mm:g} mm lobes; "
            f"at most {narrow_mm - BETWEEN_MM:g} mm do",
            hint="lower shape.heel_pad_mm or raise shape.heel_mm and shape.heel_front_mm",
            at="shape.heel_pad_mm",
        )
    if shape.rim_mm > shape.margin_mm - BETWEEN_MM:
        raise DesignError(
            f"a rim of {shape.rim_mm:g} mm reaches under the beads: the margin of "
            f"{shape.margin_mm:g} mm lets it be {shape.margin_mm - BETWEEN_MM:g} mm",
            hint="lower shape.rim_mm or raise shape.margin_mm",
            at="shape.rim_mm",
        )


def _check_gaps(shape: PawShape, outline: Arcs, heel: Block) -> None:
    """Refuse beads that meet each other, the heel pad or the rim."""
    toes = shape.toes
    edges = [toe.outline_mm for toe in toes]
    gaps = {
        "shape.toe_spread_deg": min(
            float(toe.distance(edge).min()) for toe, edge in zip(toes, edges[1:], strict=False)
        ),
        "shape.toe_ring_mm": float(min(heel.arcs.distance(edge).min() for edge in edges)),
        "shape.margin_mm": -shape.rim_mm
        - max(float(outline.distance(spots).max()) for spots in (*edges, heel.arcs.points_mm)),
    }
    what = dict(zip(gaps, ("toe beads", "toe beads and heel pad", "beads and rim"), strict=True))
    for at, gap_mm in gaps.items():
        if gap_mm < BETWEEN_MM:
            raise DesignError(
                f"{what[at]} are {gap_mm:.2g} mm apart, less than {BETWEEN_MM:g} mm",
                hint=f"raise {at}, or lower shape.toe_width_mm, shape.toe_length_mm or "
                "shape.heel_front_mm",
                at=at,
            )


def _check_inside(shape: PawShape, layers: Layers) -> None:
    """Refuse walls that leave no room, and a rim that comes too near the core."""
    both_mm = layers.elastomer_mm + layers.support_mm
    outline, _ = outlines(shape)
    cavity = outline.inset(both_mm)
    lobe_mm = outline.bend_mm - both_mm
    if cavity is None or outline.inset(layers.elastomer_mm) is None or lobe_mm < CORE_BEND_MM:
        raise DesignError(
            f"support and elastomer wall together {both_mm:g} mm leave lobes of {lobe_mm:.3g} mm "
            f"radius to the cavity, less than {CORE_BEND_MM:g} mm, or cut it in two",
            hint="lower layers.elastomer_mm or layers.support_mm, or raise shape.margin_mm",
            at="layers.elastomer_mm",
        )
    room_mm = min(_room_mm(cavity), shape.height_mm - both_mm)
    if room_mm < CAVITY_MM:
        raise DesignError(
            f"support and elastomer wall together {both_mm:g} mm leave {room_mm:.3g} mm of "
            f"cavity, less than {CAVITY_MM:g} mm",
            hint="lower layers.elastomer_mm or layers.support_mm, or raise shape.toe_ring_mm, "
            "shape.margin_mm or shape.height_mm",
            at="layers.elastomer_mm",
        )
    wall_mm, least_mm = _rim_wall_mm(shape, layers), WALL_SHARE * layers.elastomer_mm
    if wall_mm < least_mm:
        raise DesignError(
            f"the rim of {shape.rim_mm:g} mm leaves {wall_mm:.2g} mm of wall over the core's edge, "
            f"less than {least_mm:.2g} mm",
            hint="lower shape.rim_mm or raise layers.elastomer_mm",
            at="shape.rim_mm",
        )


def _block(shape: PawShape, inset_mm: float) -> Block:
    """The body's prism, or what hollows it, which lies deeper by an inset."""
    arcs = outlines(shape)[0].inset(inset_mm)
    assert arcs is not None, "refused by `check`"
    rim_mm = min(shape.rim_mm, CORE_RIM_SHARE * arcs.bend_mm) if inset_mm else shape.rim_mm
    return Block(arcs=arcs, from_mm=0.0, top_mm=shape.height_mm - inset_mm, rim_mm=rim_mm)


def _rim_wall_mm(shape: PawShape, layers: Layers) -> float:
    """Wall over the core's square edge [mm]: sqrt(2) t - (sqrt(2) - 1) (R - r), see the trunk."""
    root, core = math.sqrt(2.0), _block(shape, layers.elastomer_mm)
    return root * layers.elastomer_mm - (root - 1.0) * (shape.rim_mm - core.rim_mm)


def _room_mm(cavity: Arcs) -> float:
    """Distance of the axis from the cavity's wall [mm]; negative outside."""
    return -float(cavity.distance(np.zeros((1, 2)))[0])


def _foot(shape: PawShape, layers: Layers) -> Any:
    outline, both_mm = outlines(shape)[0], layers.elastomer_mm + layers.support_mm
    reach_mm = float(np.linalg.norm(outline.points_mm, axis=1).max())
    room_mm = _room_mm(outline) - both_mm
    return elliptic_foot((reach_mm, reach_mm), room_mm, shape.base_height_mm, shape.base_lip_mm)


FAMILY = Paw()
