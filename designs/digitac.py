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

The loaf is half an ellipse, extruded along Y and revolved at both ends. Between skin and window is
the gap, filled with gel of `material.backing_MPa` (0: air). Pins are parallel to Z and not normal
to the skin, so that the core pulls out of a cast. The window is the support of the other families.

Sources: DigiTac (Lepora and others, RA-L 2022): about 20 x 26 mm of skin on a DIGIT, pins of about
1 mm on a regular grid with white tips. Counts, gap and clamp are our choice.
Leaves out: the hard rim of the printed skin, mushroom heads of pins.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from designs.bodies import Bodies, Fields
from designs.loaf import Loaf, loaf_body, loaf_shell
from designs.plates import bored_plate
from designs.sliders import slider
from workbench.core.base.booleans import cut, fuse
from workbench.core.base.errors import DesignError, GeometryError
from workbench.core.design.design import Layers
from workbench.core.result.marks import Marks, Region
from workbench.core.result.results import Label

CAVITY_MM = 2.5
"""Smallest half width and height of the cavity under the window [mm]."""
BETWEEN_MM = 0.6
"""Smallest gap between neighbouring pins, and from a pin to the side of the loaf [mm]."""
CLEAR_MM = 0.1
"""Least distance from a tip's rim to the window, and least length of a pin on its short side
[mm]: the dome falls under a pin, so both are less there than on the pin's axis."""
DOME_SHARE = 0.8
"""Farthest a pin's axis stands out on the dome, over the half width: it falls steeply beyond."""
RIM_PLACES = 32
"""Places on a tip's rim that are looked at; the farthest out is off by at most 0.5 % of r."""
ROOT_SHARE = 0.5
"""How deep a pin is rooted in the skin, over the skin's thickness."""
DIGITAC = "DigiTac (Lepora and others, RA-L 2022)"


@dataclass(frozen=True, kw_only=True, slots=True)
class DigitacShape:
    """The DigiTac's own parameters."""

    width_mm: float = slider(20.0, (16.0, 40.0, 0.5), "mm", "Width", "Across the loaf", DIGITAC)
    length_mm: float = slider(26.0, (18.0, 60.0, 0.5), "mm", "Length", "Along the loaf", DIGITAC)
    wall_mm: float = slider(4.0, (2.0, 15.0, 0.25), "mm", "Upright part", "Below the dome")
    dome_mm: float = slider(7.0, (5.0, 15.0, 0.25), "mm", "Dome", "Height of the curved part")
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
        """The loaf whose half width and dome are smaller by the inset."""
        return Loaf(
            half_mm=self.width_mm / 2 - inset_mm,
            straight_mm=self.length_mm - self.width_mm,
            wall_mm=self.wall_mm,
            dome_mm=self.dome_mm - inset_mm,
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
        if shape.length_mm < shape.width_mm:
            raise DesignError(
                f"length {shape.length_mm:g} mm is less than the width {shape.width_mm:g} mm",
                hint="raise shape.length_mm or lower shape.width_mm",
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
        if shape.clamp_mm > shape.wall_mm:
            raise DesignError(
                f"clamp {shape.clamp_mm:g} mm is higher than the upright part of "
                f"{shape.wall_mm:g} mm",
                hint="lower shape.clamp_mm or raise shape.wall_mm",
                at="shape.clamp_mm",
            )
        _check_pins(shape, layers)

    def soften(self, shape: DigitacShape) -> None:
        """There is no fillet to make smaller."""
        return None

    def target(self, shape: DigitacShape, layers: Layers) -> tuple[float, float, float]:
        """The middle of the dome."""
        return 0.0, 0.0, shape.wall_mm + shape.dome_mm

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
        tools = _all_pins(shape, layers)
        membrane = fuse(loaf_shell(outside, inside), tools, what="pins to the skin")
        core = cut(loaf_body(inside), tools, what="pins from the core")
        _expect_pins(membrane, core, shape, layers)
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
        pins = np.array(_pins(shape, layers))

        def core(points_mm: np.ndarray) -> np.ndarray:
            return np.maximum(inside.distance(points_mm), -_pin_distance(shape, pins, points_mm))

        def cavity(points_mm: np.ndarray) -> np.ndarray:
            # Everything inside the core that is not window: the gap belongs to neither.
            shell = np.maximum(window.distance(points_mm), -air.distance(points_mm))
            ring = np.maximum(inside.distance(points_mm), -air.distance(points_mm))
            ring = np.maximum(ring, points_mm[:, 2] - shape.clamp_mm)
            return -np.minimum(shell, ring)

        outside = shape.loaf(0.0)
        half, long = outside.half_mm, outside.half_mm + outside.straight_mm / 2
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


def _check_pins(shape: DigitacShape, layers: Layers) -> None:
    """Refuse pins that touch, stand in the window or stay in the skin, and skins without any."""
    reach_x, reach_y = _pin_reach(shape, layers)
    for name, count, reach in (
        ("pin_rows", shape.pin_rows, reach_x),
        ("pin_columns", shape.pin_columns, reach_y),
    ):
        pitch_mm = 2 * reach / (count - 1) if count > 1 else math.inf
        least_mm = 2 * shape.pin_radius_mm + BETWEEN_MM
        if pitch_mm < least_mm:
            raise DesignError(
                f"{count:g} {name.replace('_', ' ')} stand {max(pitch_mm, 0.0):.2g} mm apart, less "
                f"than the {least_mm:g} mm that pins of radius {shape.pin_radius_mm:g} mm need",
                hint=f"lower shape.{name} or shape.pin_radius_mm, or raise the size of the skin",
                at=f"shape.{name}",
            )
    tips = np.array(_pins(shape, layers))
    if not len(tips):
        raise DesignError(
            f"none of {shape.pin_rows:g} x {shape.pin_columns:g} pins stands within "
            f"{DOME_SHARE:.0%} of the dome, at least 1 must: all are corners",
            hint="choose 1 or 3 and more for shape.pin_rows or shape.pin_columns",
            at="shape.pin_rows",
        )
    turn = np.linspace(0.0, 2 * np.pi, RIM_PLACES, endpoint=False)
    circle = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(RIM_PLACES)])
    rims = (tips[:, None] + shape.pin_radius_mm * circle).reshape(-1, 3)
    _check_rims(rims, shape, layers)


def _check_rims(rims_mm: np.ndarray, shape: DigitacShape, layers: Layers) -> None:
    inside = shape.loaf(layers.elastomer_mm)
    # Beyond the inner face's outline there is skin only.
    out_mm = np.where(inside.share(rims_mm) < 1.0, inside.roof_mm(rims_mm) - rims_mm[:, 2], 0.0)
    if out_mm.min() < CLEAR_MM:
        raise DesignError(
            f"a pin of {shape.pin_length_mm:g} mm stands {out_mm.min():.2f} mm out of the skin on "
            f"its short side, less than {CLEAR_MM:g} mm",
            hint="raise shape.pin_length_mm, or lower shape.pin_radius_mm or shape.dome_mm",
            at="shape.pin_length_mm",
        )
    # The clamp ring comes no nearer: pins end within the inner 80 % of the dome.
    clear_mm = shape.loaf(layers.elastomer_mm + shape.gap_mm).distance(rims_mm).min()
    if clear_mm < CLEAR_MM:
        raise DesignError(
            f"a pin's tip stands {clear_mm:.2f} mm from the window on its long side, less than "
            f"{CLEAR_MM:g} mm (negative: inside it)",
            hint="raise shape.pin_gap_mm, or lower shape.pin_radius_mm or shape.pin_length_mm",
            at="shape.pin_gap_mm",
        )


def _pin_reach(shape: DigitacShape, layers: Layers) -> tuple[float, float]:
    """Farthest pin axes from the middle along X and Y [mm]: the inner 70 % of the dome."""
    inside = shape.loaf(layers.elastomer_mm)
    across = 0.7 * inside.half_mm
    return across, across + inside.straight_mm / 2


def _pins(shape: DigitacShape, layers: Layers) -> list[tuple[float, float, float]]:
    """Axis (x, y) and height of the tip of each pin [mm], row by row; corners are left out.

    Tips follow the dome at `pin_length_mm` below the skin's inner face on the pin's axis.
    """
    reach_x, reach_y = _pin_reach(shape, layers)
    inside = shape.loaf(layers.elastomer_mm)

    def spread(count: float, reach: float) -> np.ndarray:
        return np.linspace(-reach, reach, int(count)) if count > 1 else np.zeros(1)

    places = []
    for x in spread(shape.pin_rows, reach_x):
        for y in spread(shape.pin_columns, reach_y):
            roof = float(inside.roof_mm(np.array([[x, y]]))[0])
            rim = float(inside.share(np.array([[x, y]]))[0])
            # A pin nearer the dome's rim would leave it sideways.
            if rim <= DOME_SHARE:
                places.append((float(x), float(y), roof - shape.pin_length_mm))
    return places


def _all_pins(shape: DigitacShape, layers: Layers) -> Any:
    """Every pin, each from its tip to the middle of the skin above its axis."""
    from build123d import Compound, Plane, Solid

    length_mm = shape.pin_length_mm + ROOT_SHARE * layers.elastomer_mm
    return Compound(
        [
            Solid.make_cylinder(shape.pin_radius_mm, length_mm, Plane(origin=place))
            for place in _pins(shape, layers)
        ]
    )


def _pin_distance(shape: DigitacShape, pins: np.ndarray, points_mm: np.ndarray) -> np.ndarray:
    """Signed distance to the nearest pin, long enough to reach through the skin [mm]."""
    from scipy.spatial import KDTree

    beside, nearest = KDTree(pins[:, :2]).query(points_mm[:, :2])
    return np.maximum(beside - shape.pin_radius_mm, pins[nearest, 2] - points_mm[:, 2])


def _expect_pins(membrane: Any, core: Any, shape: DigitacShape, layers: Layers) -> None:
    """Each pin must have its tip: a plane face of its own at its height, in skin and core."""
    disc = math.pi * shape.pin_radius_mm**2
    for body, what in ((membrane, "skin"), (core, "core")):
        found = [
            face.center()
            for face in body.faces()
            if abs(face.area - disc) < 1e-6 and abs(abs(face.normal_at().Z) - 1.0) < 1e-9
        ]
        wanted = _pins(shape, layers)
        met = sum(any(math.dist((c.X, c.Y, c.Z), place) < 1e-4 for c in found) for place in wanted)
        if met != len(wanted):
            raise GeometryError(
                f"{what}: {met} of {len(wanted)} pins are there",
                hint="change the last shape parameter a little",
                at="shape",
            )


def _marks(shape: DigitacShape, layers: Layers) -> Marks:
    pins = _pins(shape, layers)
    clamp_mm = shape.clamp_mm
    backed = Region(
        label=Label.BACKED,
        number=0,
        within=Label.INNER,
        inside=lambda points_mm: points_mm[:, 2] - clamp_mm,
        imprint=True,
    )
    regions = [
        Region(label=Label.PIN, number=number, within=Label.INNER, inside=_on_pin(shape, place))
        for number, place in enumerate(pins)
    ]
    return Marks(
        regions=(backed, *regions),
        tips_mm=tuple(pins),
        tip_radius_mm=shape.pin_radius_mm,
        backing_mm=shape.gap_mm,
    )


def _on_pin(shape: DigitacShape, place: tuple[float, float, float]) -> Callable[..., np.ndarray]:
    """Positive on the pin's side and tip: within its radius, where the roof has no face."""
    radius_mm, axis = shape.pin_radius_mm * 1.005 + 1e-4, np.array(place[:2])

    def inside(points_mm: np.ndarray) -> np.ndarray:
        return radius_mm - np.linalg.norm(points_mm[:, :2] - axis, axis=1)

    return inside


def _window(shape: DigitacShape, layers: Layers) -> Any:
    """The clear window under the gap, with a rim that fills the gap up to the clamp."""
    skin_mm, gap_mm = layers.elastomer_mm, shape.gap_mm
    window = loaf_shell(
        shape.loaf(skin_mm + gap_mm), shape.loaf(skin_mm + gap_mm + layers.support_mm)
    )
    inside, middle = shape.loaf(skin_mm), shape.loaf(skin_mm + gap_mm + layers.support_mm / 2)
    ring = cut(
        inside.prism(0.0, shape.clamp_mm), middle.prism(0.0, shape.clamp_mm), what="clamp ring"
    )
    return fuse(window, ring, what="clamp ring to the window")


def _foot(shape: DigitacShape, layers: Layers) -> Any:
    plate = shape.loaf(-shape.base_lip_mm).prism(-shape.base_height_mm, 0.0)
    inside_mm = layers.elastomer_mm + shape.gap_mm + layers.support_mm
    return bored_plate(plate, shape.width_mm / 2 - inside_mm, shape.base_height_mm)


FAMILY = Digitac()
