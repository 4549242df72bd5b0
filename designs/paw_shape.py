"""A paw's parameters, and the outlines, beads and heel pad that follow from them."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from designs.mounds import Block, Dome
from designs.sliders import slider
from geometry.body.arcs import Arcs, Lobe, around
from workbench.core.base.errors import DesignError


@dataclass(frozen=True, kw_only=True, slots=True)
class PawShape:
    """The paw's own parameters."""

    height_mm: float = slider(
        21.0, (14.0, 50.0, 0.5), "mm", "Height", "From the base to the flat", "SimTac mesh"
    )
    margin_mm: float = slider(
        3.4, (2.0, 7.0, 0.1), "mm", "Margin", "Of the body round beads and heel pad", "SimTac mesh"
    )
    rim_mm: float = slider(
        2.0, (0.5, 3.0, 0.1), "mm", "Rim radius", "Rounding of the body's rim", "SimTac mesh"
    )
    valley_mm: float = slider(
        0.6, (0.4, 3.0, 0.1), "mm", "Valley radius", "Fillet between lobes of the body"
    )
    toe_count: float = slider(4.0, (2.0, 5.0, 1.0), "", "Toes", "Number of toes", "SimTac mesh")
    toe_ring_mm: float = slider(
        9.8,
        (8.0, 18.0, 0.1),
        "mm",
        "Toe ring",
        "Distance of toe beads from the axis",
        "SimTac mesh",
    )
    toe_spread_deg: float = slider(
        147.0,
        (90.0, 165.0, 1.0),
        "degree",
        "Toe spread",
        "From the first to the last",
        "SimTac mesh",
    )
    toe_width_mm: float = slider(
        6.0, (4.0, 10.0, 0.1), "mm", "Toe width", "Of a toe bead, along X", "SimTac mesh"
    )
    toe_length_mm: float = slider(
        8.4, (4.0, 12.0, 0.1), "mm", "Toe length", "Of a toe bead, along Y", "SimTac mesh"
    )
    toe_pad_mm: float = slider(
        3.0, (0.5, 4.0, 0.1), "mm", "Toe height", "How far toe beads stand out", "SimTac mesh"
    )
    heel_mm: float = slider(
        4.9, (3.0, 8.0, 0.1), "mm", "Heel radius", "Of the two hind lobes", "SimTac mesh"
    )
    heel_apart_mm: float = slider(
        9.4, (6.0, 16.0, 0.1), "mm", "Heel lobes apart", "Between the hind lobes", "SimTac mesh"
    )
    heel_back_mm: float = slider(
        6.6, (4.0, 12.0, 0.1), "mm", "Heel back", "Of the hind lobes behind the axis", "SimTac mesh"
    )
    heel_front_mm: float = slider(
        4.2, (3.0, 7.0, 0.1), "mm", "Heel front", "Radius of the front lobe", "SimTac mesh"
    )
    heel_pad_mm: float = slider(
        2.0, (0.5, 3.0, 0.1), "mm", "Heel height", "How far the heel pad stands out", "SimTac mesh"
    )
    base_height_mm: float = slider(
        8.0, (2.0, 40.0, 0.5), "mm", "Foot height", "Rigid foot that carries camera and LEDs"
    )
    base_lip_mm: float = slider(
        2.0, (0.0, 15.0, 0.5), "mm", "Foot lip", "How far the foot stands out beyond the lobes"
    )

    @property
    def toes(self) -> list[Dome]:
        """The toe beads, counter-clockwise from above: the first is at +X."""
        half = math.radians(self.toe_spread_deg) / 2
        turns = np.pi / 2 + np.linspace(-half, half, round(self.toe_count))
        return [
            Dome(
                place_mm=(self.toe_ring_mm * math.cos(turn), self.toe_ring_mm * math.sin(turn)),
                half_mm=(self.toe_width_mm / 2, self.toe_length_mm / 2),
                from_mm=self.height_mm,
                rise_mm=self.toe_pad_mm,
            )
            for turn in turns.tolist()
        ]

    @property
    def heel(self) -> Block | None:
        """The heel pad; None where its lobes make no outline."""
        right, left = self._hind(0.0)
        front = Lobe(x_mm=0.0, y_mm=0.0, half_mm=(self.heel_front_mm, self.heel_front_mm))
        # On the released pad the fillets that take the place of its straight sides fit best so.
        arcs = around([right, front, left], self.heel_front_mm)
        if arcs is None:
            return None
        return Block(
            arcs=arcs,
            from_mm=self.height_mm,
            top_mm=self.height_mm + self.heel_pad_mm,
            rim_mm=self.heel_pad_mm,
        )

    @property
    def outline(self) -> Arcs | None:
        """The body's outline; None where its lobes make none."""
        right, left = self._hind(self.margin_mm)
        toes = [
            Lobe(x_mm=toe.place_mm[0], y_mm=toe.place_mm[1], half_mm=self.toe_lobe_mm)
            for toe in self.toes
        ]
        return around([right, *toes, left], self.valley_mm)

    @property
    def toe_lobe_mm(self) -> tuple[float, float]:
        """Half axes along X and Y of the body's lobe under a toe bead [mm]."""
        return self.toe_width_mm / 2 + self.margin_mm, self.toe_length_mm / 2 + self.margin_mm

    def _hind(self, more_mm: float) -> tuple[Lobe, Lobe]:
        """The heel's right and left lobe, wider by so much."""
        x, y, radius = self.heel_apart_mm / 2, -self.heel_back_mm, self.heel_mm + more_mm
        right, left = (Lobe(x_mm=side * x, y_mm=y, half_mm=(radius, radius)) for side in (1, -1))
        return right, left


@functools.lru_cache(maxsize=32)
def outlines(shape: PawShape) -> tuple[Arcs, Block]:
    """Outline of the body, and the heel pad.

    Raises:
        DesignError: If lobes make no outline.
    """
    outline, heel = shape.outline, shape.heel
    if heel is None:
        raise DesignError(
            f"hind lobes of {shape.heel_mm:g} mm, {shape.heel_apart_mm:g} mm apart, make no heel "
            f"pad with a front lobe of {shape.heel_front_mm:g} mm, {shape.heel_back_mm:g} mm away",
            hint="change shape.heel_apart_mm, shape.heel_back_mm or shape.heel_front_mm",
            at="shape.heel_apart_mm",
        )
    if outline is None:
        raise DesignError(
            f"{shape.toe_count:g} toes over {shape.toe_spread_deg:g} degrees and two hind lobes do "
            f"not make one outline with valleys of {shape.valley_mm:g} mm radius",
            hint="change shape.toe_spread_deg, shape.toe_ring_mm or shape.heel_apart_mm, or raise "
            "shape.margin_mm or lower it",
            at="shape.toe_spread_deg",
        )
    return outline, heel
