"""The lights a designer chooses, and how their light is computed."""

from __future__ import annotations

import enum
import math
import re
from dataclasses import dataclass

from workbench.core.base.check import within
from workbench.core.base.errors import DesignError, shown
from workbench.core.base.records import names

Vector = tuple[float, float, float]

HEX = re.compile(r"#[0-9a-fA-F]{6}")
SPECTRUM = re.compile(r"(\d+(?:\.\d+)?)nm(?:/(\d+(?:\.\d+)?)nm)?")
TEMPERATURE = re.compile(r"(\d+(?:\.\d+)?)K")


class LightModel(enum.StrEnum):
    """How light travels from an LED to a point of the skin: a file of `sim.optics.field.models`."""

    _ignore_ = "model"
    for model in names("sim.optics.field.models"):
        vars()[model.upper()] = model


class LedMount(enum.StrEnum):
    """Where the LEDs sit."""

    CAVITY = "cavity"
    """In the air inside the support shell."""
    SHELL = "shell"
    """At the base edge of the transparent support, feeding light into it."""


class LampKind(enum.StrEnum):
    """Form of a light that is not on the ring."""

    POINT = "point"
    LINE = "line"
    """`length_mm` along `along`."""
    AREA = "area"
    """A rectangle, `length_mm` along `along` and `width_mm` across it, shining along `axis`."""


def check_colour(colour: str, *, at: str) -> None:
    """Refuse what does not name a colour: `#rrggbb`, `525nm`, `525nm/35nm` or `5600K`.

    Raises:
        DesignError: If it has none of these forms, or a number leaves its range.
    """
    spectrum, temperature = SPECTRUM.fullmatch(colour), TEMPERATURE.fullmatch(colour)
    if spectrum:
        within(float(spectrum[1]), 380.0, 780.0, what="peak wavelength", unit="nm", at=at)
        if spectrum[2]:
            width = float(spectrum[2])
            within(width, 1.0, 300.0, what="width of the spectrum", unit="nm", at=at)
    elif temperature:
        kelvin = float(temperature[1])
        within(kelvin, 1000.0, 20000.0, what="colour temperature", unit="K", at=at)
    elif not HEX.fullmatch(colour):
        raise DesignError(
            f"LED colour {shown(colour)} is not of the form #rrggbb, 525nm, 525nm/35nm or 5600K",
            hint="for example #ff0000 for red",
            at=at,
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class LedRing:
    """LEDs evenly spaced on a circle about +Z, coloured in equal sectors."""

    count: int = 9
    """0 for a sensor that has only `lamps`."""
    radius_mm: float = 9.0
    height_mm: float = 0.5
    """Height of the LEDs above the base [mm]."""
    phase_deg: float = 50.0
    """Azimuth of the first LED from +X toward +Y [degree]."""
    tilt_deg: float = 0.0
    """Tilt of the emission axis from +Z outward [degree]."""
    power: float = 1.0
    """Relative power of each LED; exposure follows it, so only ratios matter."""
    powers: tuple[float, ...] = ()
    """A factor on the power of each LED in the order of azimuth; () is 1 for all."""
    emission_exponent: float = 1.0
    """Radiant intensity falls as cos(angle)^exponent; 1 is Lambertian."""
    cone_deg: float = 180.0
    """Full angle of the cone that an LED shines into [degree]; 180 is the half space."""
    size_mm: float = 1.5
    """Diameter of an LED's emitting disc [mm]; for traced photons, shadows and glare."""
    colours: tuple[str, ...] = ("#ff0000", "#00ff00", "#0000ff")
    """Linear RGB of each sector as #rrggbb, or its light as `525nm`, `525nm/35nm`, `5600K`."""
    mount: LedMount = LedMount.CAVITY

    def __post_init__(self) -> None:
        at = "optics.ring"
        within(self.count, 0, 64, what="LED count", unit="", at=f"{at}.count")
        within(self.radius_mm, 0.0, 200.0, what="LED ring radius", unit="mm", at=f"{at}.radius_mm")
        within(self.height_mm, 0.0, 200.0, what="LED height", unit="mm", at=f"{at}.height_mm")
        for name, low, high in (("phase_deg", -360.0, 360.0), ("tilt_deg", -90.0, 180.0)):
            what, hint = (
                f"LED {name.removesuffix('_deg')}",
                f"choose from {low:g} to {high:g} degree",
            )
            value = getattr(self, name)
            within(value, low, high, what=what, unit="degree", at=f"{at}.{name}", hint=hint)
        within(self.power, 0.0, 1e3, what="LED power", unit="", at=f"{at}.power")
        _check_emission(self.emission_exponent, self.cone_deg, at=at)
        within(self.size_mm, 0.05, 20.0, what="LED size", unit="mm", at=f"{at}.size_mm")
        for colour in self.colours:
            check_colour(colour, at=f"{at}.colours")
        if not self.colours:
            raise DesignError(
                "the LED ring has no colour", hint="name at least one #rrggbb", at=f"{at}.colours"
            )
        for factor in self.powers:
            within(factor, 0.0, 1e3, what="factor on an LED's power", unit="", at=f"{at}.powers")
        if self.powers and len(self.powers) != self.count:
            raise DesignError(
                f"{len(self.powers)} powers are given for {self.count} LEDs",
                hint=f"give {self.count} factors, or none",
                at=f"{at}.powers",
            )


def _check_emission(exponent: float, cone_deg: float, *, at: str) -> None:
    field = f"{at}.emission_exponent"
    within(exponent, 0.0, 100.0, what="emission exponent", unit="", at=field)
    within(cone_deg, 1.0, 180.0, what="emission cone", unit="degree", at=f"{at}.cone_deg")


@dataclass(frozen=True, kw_only=True, slots=True)
class Lamp:
    """A light besides the ring: a point, a line or an area, divided into equal points."""

    kind: LampKind = LampKind.POINT
    position_mm: Vector = (0.0, 0.0, 0.5)
    """Its centre [mm], sensor frame."""
    axis: Vector = (0.0, 0.0, 1.0)
    """Direction that it shines in; any length."""
    along: Vector = (1.0, 0.0, 0.0)
    """Direction of its length, for lines and areas; any length, not along `axis`."""
    length_mm: float = 5.0
    width_mm: float = 2.0
    samples: int = 9
    """Points that a line or an area is divided into; an area takes the nearest whole grid."""
    colour: str = "#ffffff"
    """Linear RGB as #rrggbb, or its light as `525nm`, `525nm/35nm`, `5600K`."""
    power: float = 1.0
    """Power of the whole lamp, in units of a ring LED's."""
    emission_exponent: float = 1.0
    cone_deg: float = 180.0
    size_mm: float = 1.5
    """Diameter of the emitting disc of a point [mm]; for traced photons, shadows and glare."""
    mount: LedMount = LedMount.CAVITY

    def __post_init__(self) -> None:
        at = "optics.lamps"
        for axis_mm in self.position_mm:
            within(axis_mm, -500.0, 500.0, what="lamp position", unit="mm", at=f"{at}.position_mm")
        for name in ("axis", "along"):
            vector = getattr(self, name)
            if not all(map(math.isfinite, vector)) or math.hypot(*vector) < 1e-6:
                raise DesignError(
                    f"the lamp's {name} {vector} has no direction",
                    hint="give x, y, z of any length but 0; 0, 0, 1 is up",
                    at=f"{at}.{name}",
                )
            for part in vector:
                # Beyond it the squares of lengths and products leave what a float holds.
                what = f"part of the lamp's {name}"
                within(part, -1e6, 1e6, what=what, unit="", at=f"{at}.{name}")
        within(self.length_mm, 0.05, 200.0, what="lamp length", unit="mm", at=f"{at}.length_mm")
        within(self.width_mm, 0.05, 200.0, what="lamp width", unit="mm", at=f"{at}.width_mm")
        within(self.samples, 1, 256, what="points of a lamp", unit="", at=f"{at}.samples")
        within(self.power, 0.0, 1e3, what="lamp power", unit="", at=f"{at}.power")
        within(self.size_mm, 0.05, 20.0, what="lamp size", unit="mm", at=f"{at}.size_mm")
        _check_emission(self.emission_exponent, self.cone_deg, at=at)
        check_colour(self.colour, at=f"{at}.colour")
        self._check_plane(at)

    @property
    def grid(self) -> tuple[int, int]:
        """Points along and across the lamp: cells as square as whole numbers near `samples` allow.

        With n = sqrt(samples length / width) along, rounded, and samples / n across, rounded.
        """
        if self.kind is LampKind.POINT:
            return 1, 1
        if self.kind is LampKind.LINE:
            return self.samples, 1
        along = max(1, round(math.sqrt(self.samples * self.length_mm / self.width_mm)))
        along = min(along, self.samples)
        return along, max(1, round(self.samples / along))

    @property
    def points(self) -> int:
        """Points that the lamp is divided into; of an area as near to `samples` as `grid` gets."""
        along, across = self.grid
        return along * across

    def _check_plane(self, at: str) -> None:
        if self.kind is LampKind.POINT:
            return
        dot = sum(a * b for a, b in zip(self.axis, self.along, strict=True))
        if abs(dot) > 0.999 * math.hypot(*self.axis) * math.hypot(*self.along):
            raise DesignError(
                f"the {self.kind.value} lamp shines along its own length",
                hint="choose `along` across `axis`",
                at=f"{at}.along",
            )


@dataclass(frozen=True, kw_only=True, slots=True)
class Ambient:
    """Light that falls on the skin evenly from all sides: from a glowing base or from outside."""

    power: float = 0.0
    """Power that falls on the whole skin, in units of a ring LED's."""
    colour: str = "#ffffff"
    """Linear RGB as #rrggbb, or its light as `525nm`, `525nm/35nm`, `5600K`."""

    def __post_init__(self) -> None:
        at = "optics.ambient"
        within(self.power, 0.0, 1e3, what="ambient power", unit="", at=f"{at}.power")
        check_colour(self.colour, at=f"{at}.colour")


@dataclass(frozen=True, kw_only=True, slots=True)
class Baking:
    """How finely traced light is gathered; used by `table`, `hybrid` and `photons`."""

    photons: int = 4_000_000
    """Photons of a bake, or of each frame with the model `photons`."""
    nodes: int = 5_000
    """Places on the skin at which light is gathered, about."""
    seed: int = 1
    """Of the random numbers; equal seeds give equal light."""

    def __post_init__(self) -> None:
        at = "optics.baking"
        within(self.photons, 10_000, 10_000_000_000, what="photons", unit="", at=f"{at}.photons")
        within(self.nodes, 200, 100_000, what="nodes of the bake", unit="", at=f"{at}.nodes")
        within(self.seed, 0, 2**20, what="seed", unit="", at=f"{at}.seed")
