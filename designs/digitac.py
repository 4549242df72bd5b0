"""DigiTac: a curved loaf of skin with rows of internal pins whose white tips are the markers.

A TacTip in the body of a DIGIT: the camera does not read shading but the motion of pin tips.

          .-''''''''''''''''''''''-.        z = wall_mm + dome_mm
        .'  ______________________  '.      skin and pins: one elastomer
       /  .'  |  |  |  |  |  |  |  '. \\
      |  /    '  '  '  '  '  '  '    \\ |    pins, pin_length_mm, parallel to Z
      | |   ______________________   | |    gap: soft gel or air, pin_gap_mm beyond the tips
      | |_.'                      '._| |
      |_|                            |_|    clamp: below clamp_mm the skin is bonded to the window
     |____________ cam ________________|    z = 0; below it the foot

| parameter        | meaning                                                         |
|------------------|-----------------------------------------------------------------|
| `width_mm`       | size across the loaf (X)                                        |
| `length_mm`      | size along the loaf (Y)                                         |
| `front_mm`       | length of the elliptic end at +Y                                |
| `back_mm`        | length of the elliptic end at -Y                                |
| `wall_mm`        | height of the upright part of the skin                          |
| `dome_mm`        | height of the elliptic dome over it                             |
| `pin_rows`       | pins across                                                     |
| `pin_columns`    | pins along                                                      |
| `pin_radius_mm`  | radius of a pin                                                 |
| `pin_length_mm`  | how far a pin stands into the gap, measured on its axis         |
| `pin_gap_mm`     | from the longest pins' tips to the clear window                 |
| `clamp_mm`       | height of the band in which the skin is bonded to the window    |
| `base_height_mm` | height of the foot                                              |
| `base_lip_mm`    | how far the foot stands out beyond the skin                     |

The loaf is half an ellipse, drawn along Y, with an elliptic end at either side. Between skin and
window is the gap, filled with gel of `material.backing_MPa` (0: air). Pins (`designs/pins.py`) are
parallel to Z and not normal to the skin, so that the core pulls out of a cast. The window is the
support of the other families.

Sources: outside, skin of 1 mm and pins measured on the released SimTac mesh (MIT), 19.5 x 26.4 x
9.25 mm, one end round and one shorter; DigiTac (Lepora and others, RA-L 2022): pins of about 1 mm
on a regular grid with white tips. Counts, gap and clamp are our choice.
Leaves out: the hard rim of the printed skin, mushroom heads of pins.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from designs.bodies import Bodies, Fields
from designs.loaf import Loaf, loaf_body, loaf_shell
from designs.pins import CLEAR_MM, Pins, check_pins, expect_pins, pin_bodies, pin_field, pin_regions
from designs.plates import bored_plate
from designs.sliders import slider
from workbench.core.base.booleans import cut, fuse, intersect
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers
from workbench.core.result.marks import Marks, Region
from workbench.core.result.results import Label

CAVITY_MM = 2.5
"""Smallest half width and height of the cavity under the window [mm]."""
LEAST_END_MM = 0.3
"""Shortest end of the cavity [mm]: shorter ones leave the kernel slivers."""
ROOT_SHARE = 0.5
"""How deep a pin is rooted in the skin, over the skin's thickness."""
SIMTAC = "measured on the released SimTac mesh of the DigiTac"
DIGITAC = "DigiTac (Lepora and others, RA-L 2022)"


@dataclass(frozen=True, kw_only=True, slots=True)
class DigitacShape:
    """The DigiTac's own parameters."""

    width_mm: float = slider(19.5, (16.0, 40.0, 0.5), "mm", "Width", "Across the loaf", SIMTAC)
    length_mm: float = slider(26.4, (18.0, 60.0, 0.1), "mm", "Length", "Along the loaf", SIMTAC)
    front_mm: float = slider(9.7, (4.0, 20.0, 0.1), "mm", "Front end", "Length at +Y", SIMTAC)
    back_mm: float = slider(5.1, (4.0, 20.0, 0.1), "mm", "Back end", "Length at -Y", SIMTAC)
    wall_mm: float = slider(
        0.0, (0.0, 15.0, 0.25), "mm", "Upright part", "Below the dome; 0 for none", SIMTAC
    )
    dome_mm: float = slider(
        9.25, (5.0, 15.0, 0.25), "mm", "Dome", "Height of the curved part", SIMTAC
    )
    pin_rows: float = slider(5.0, (1.0, 9.0, 1.0), "", "Pin rows", "Pins across the loaf")
    pin_columns: float = slider(7.0, (1.0, 13.0, 1.0), "", "Pin columns", "Pins along the loaf")
    pin_radius_mm: float = slider(
        0.5, (0.3, 1.0, 0.05), "mm", "Pin radius", "Radius of a pin and its white tip", DIGITAC
    )
    pin_length_mm: float = slider(
        1.2, (0.5, 3.0, 0.1), "mm", "Pin length", "How far a pin stands into the gap", DIGITAC
    )
    pin_gap_mm: float = slider(
        0.5, (0.2, 3.0, 0.1), "mm", "Pin gap", "From the tips to the clear window"
    )
    clamp_mm: float = slider(
        1.5, (0.5, 6.0, 0.25), "mm", "Clamp", "Height of the band bonded to the window"
    )
    base_height_mm: float = slider(
        8.0, (2.0, 40.0, 0.5), "mm", "Foot height", "Rigid foot that carries camera and LEDs"
    )
    base_lip_mm: float = slider(
        2.0, (0.0, 15.0, 0.5), "mm", "Foot lip", "How far the foot stands out beyond the skin"
    )

    @property
    def gap_mm(self) -> float:
        """From skin to window [mm]."""
        return self.pin_length_mm + self.pin_gap_mm

    def loaf(self, inset_mm: float) -> Loaf:
        """The loaf whose half width, ends and dome are smaller by the inset."""
        half_mm = self.length_mm / 2
        return Loaf(
            half_mm=self.width_mm / 2 - inset_mm,
            straight_mm=(self.back_mm - half_mm, half_mm - self.front_mm),
            ends_mm=(self.back_mm - inset_mm, self.front_mm - inset_mm),
            wall_mm=self.wall_mm,
            dome_mm=self.dome_mm - inset_mm,
        )

    def pins(self, layers: Layers) -> Pins:
        """The pins under a skin."""
        return Pins(
            inside=self.loaf(layers.elastomer_mm),
            rows=round(self.pin_rows),
            columns=round(self.pin_columns),
            radius_mm=self.pin_radius_mm,
            length_mm=self.pin_length_mm,
            root_mm=ROOT_SHARE * layers.elastomer_mm,
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Digitac:
    """Builds DigiTacs."""

    name: str = "digitac"
    title: str = "DigiTac"
    shape_type: type = DigitacShape

    def check(self, shape: DigitacShape, layers: Layers) -> None:
        """Refuse windows without room for a camera, clamps in the dome, and pins that touch.

        Pins must stand clear of each other and of the window, and out of the skin.

        Raises:
            DesignError: Naming the field, its value and its limit.
        """
        ends_mm = shape.front_mm + shape.back_mm
        if shape.length_mm < ends_mm:
            raise DesignError(
                f"length {shape.length_mm:g} mm is less than both ends together, {ends_mm:g} mm",
                hint="raise shape.length_mm, or lower shape.front_mm or shape.back_mm",
                at="shape.length_mm",
            )
        for name in ("pin_rows", "pin_columns"):
            count = getattr(shape, name)
            if count != round(count):
                raise DesignError(
                    f"{name.replace('_', ' ')} {count:g} is not a whole number",
                    hint=f"choose {round(count)}",
                    at=f"shape.{name}",
                )
        _check_room(shape, layers)
        pins = shape.pins(layers)
        check_pins(pins, shape.loaf(layers.elastomer_mm + shape.gap_mm))
        lowest_mm = min(tip[2] for tip in pins.tips_mm)
        if lowest_mm - shape.clamp_mm < CLEAR_MM:
            raise DesignError(
                f"clamp {shape.clamp_mm:g} mm is higher than the lowest pin, whose tip is at "
                f"{lowest_mm:.2f} mm, less {CLEAR_MM:g} mm",
                hint="lower shape.clamp_mm or raise shape.wall_mm",
                at="shape.clamp_mm",
            )

    def soften(self, shape: DigitacShape) -> None:
        """There is no fillet to make smaller."""
        return None

    def target(self, shape: DigitacShape, layers: Layers) -> tuple[float, float, float]:
        """The ridge over the camera."""
        return 0.0, 0.0, float(shape.loaf(0.0).roof_mm(np.zeros((1, 2)))[0])

    def build(self, shape: DigitacShape, layers: Layers) -> Bodies:
        """Build the five bodies.

        Raises:
            DesignError: As `check`.
            GeometryError: If the CAD kernel returned something else than asked for, or a pin is
                missing.
        """
        self.check(shape, layers)
        skin_mm = layers.elastomer_mm
        outside, inside = shape.loaf(0.0), shape.loaf(skin_mm)
        pins = shape.pins(layers)
        tools = pin_bodies(pins)
        membrane = fuse(loaf_shell(outside, inside), tools, what="pins to the skin")
        core = cut(loaf_body(inside), tools, what="pins from the core")
        expect_pins(membrane, core, pins)
        return Bodies(
            membrane=membrane,
            outer=loaf_body(outside),
            core=core,
            support=_window(shape, layers),
            base=_foot(shape, layers),
            marks=_marks(shape, layers),
        )

    def fields(self, shape: DigitacShape, layers: Layers) -> Fields:
        """Loaves and cylinders as signed distance fields."""
        self.check(shape, layers)
        skin_mm, gap_mm = layers.elastomer_mm, shape.gap_mm
        inside = shape.loaf(skin_mm)
        window, air = shape.loaf(skin_mm + gap_mm), shape.loaf(skin_mm + gap_mm + layers.support_mm)
        pins = pin_field(shape.pins(layers))

        def core(points_mm: np.ndarray) -> np.ndarray:
            return np.maximum(inside.distance(points_mm), -pins(points_mm))

        def cavity(points_mm: np.ndarray) -> np.ndarray:
            # Everything inside the core that is not window: the gap belongs to neither.
            shell = np.maximum(window.distance(points_mm), -air.distance(points_mm))
            ring = np.maximum(inside.distance(points_mm), -air.distance(points_mm))
            ring = np.maximum(ring, points_mm[:, 2] - shape.clamp_mm)
            return -np.minimum(shell, ring)

        outside = shape.loaf(0.0)
        half, long = outside.half_mm, shape.length_mm / 2
        return Fields(
            outer=outside.distance,
            core=core,
            cavity=cavity,
            base=_foot(shape, layers),
            wall_mm=skin_mm,
            low_mm=(-half, -long, 0.0),
            high_mm=(half, long, outside.top_mm),
            marks=_marks(shape, layers),
        )


def _check_room(shape: DigitacShape, layers: Layers) -> None:
    """Refuse skins and gaps that leave no cavity under the window."""
    inside_mm = layers.elastomer_mm + shape.gap_mm + layers.support_mm
    for what, whole_mm, least_mm, at in (
        ("half width", shape.width_mm / 2, CAVITY_MM, "shape.width_mm"),
        ("front end", shape.front_mm, LEAST_END_MM, "shape.front_mm"),
        ("back end", shape.back_mm, LEAST_END_MM, "shape.back_mm"),
        ("height", shape.wall_mm + shape.dome_mm, CAVITY_MM, "shape.dome_mm"),
        ("dome", shape.dome_mm, CAVITY_MM / 5, "shape.dome_mm"),
    ):
        if whole_mm - inside_mm < least_mm:
            raise DesignError(
                f"skin, gap and window together {inside_mm:g} mm leave {whole_mm - inside_mm:.3g} "
                f"mm of the {what} of {whole_mm:g} mm, less than {least_mm:g} mm",
                hint=f"raise {at}, or lower shape.pin_length_mm, shape.pin_gap_mm, "
                "layers.elastomer_mm or layers.support_mm",
                at=at,
            )


def _marks(shape: DigitacShape, layers: Layers) -> Marks:
    pins = shape.pins(layers)
    clamp_mm = shape.clamp_mm
    backed = Region(
        label=Label.BACKED,
        number=0,
        within=Label.INNER,
        inside=lambda points_mm: points_mm[:, 2] - clamp_mm,
        imprint=True,
    )
    return Marks(
        regions=(backed, *pin_regions(pins)),
        tips_mm=tuple(pins.tips_mm),
        tip_radius_mm=shape.pin_radius_mm,
        backing_mm=shape.gap_mm,
    )


def _window(shape: DigitacShape, layers: Layers) -> Any:
    """The clear window under the gap, with a rim that fills the gap up to the clamp."""
    skin_mm, gap_mm = layers.elastomer_mm, shape.gap_mm
    window = loaf_shell(
        shape.loaf(skin_mm + gap_mm), shape.loaf(skin_mm + gap_mm + layers.support_mm)
    )
    inside, middle = shape.loaf(skin_mm), shape.loaf(skin_mm + gap_mm + layers.support_mm / 2)
    # Wider than the loaf, whose side is upright where it begins.
    slab = shape.loaf(-1.0).prism(0.0, shape.clamp_mm)
    ring = intersect(loaf_shell(inside, middle), slab, what="clamp ring")
    return fuse(window, ring, what="clamp ring to the window")


def _foot(shape: DigitacShape, layers: Layers) -> Any:
    plate = shape.loaf(-shape.base_lip_mm).prism(-shape.base_height_mm, 0.0)
    inside_mm = layers.elastomer_mm + shape.gap_mm + layers.support_mm
    return bored_plate(plate, shape.width_mm / 2 - inside_mm, shape.base_height_mm)


FAMILY = Digitac()
