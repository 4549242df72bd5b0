"""What the camera sees by: coating, markers, and all of a sensor's optics together."""

from __future__ import annotations

import enum
from dataclasses import dataclass, field

from workbench.core.base.check import within
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import Ambient, Baking, Lamp, LedRing, LightModel
from workbench.core.design.photo import Photo
from workbench.core.design.unit import Unit

BEST = LightModel("hybrid")
"""Light of a new design."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Coating:
    """How the skin's inner face reflects light.

    The defaults stand for silicone ink with aluminium flakes, the semi-specular skin that shows
    the slightest tilt. Our choice, not measured: a matte grey skin has 0.6, 0.04 and 0.35.
    """

    albedo: float = 0.1
    """Diffuse reflectance in [0, 1], grey."""
    specular: float = 0.4
    """Reflectance at normal incidence of the glossy lobe; 0.04 is a dielectric of index 1.5."""
    roughness: float = 0.2
    """GGX alpha in (0, 1]; used by all but the paper's fields."""
    phong_diffuse: float = 0.6
    """k_d of the paper's Eq. 4; used by the paper's fields."""
    phong_specular: float = 0.2
    """k_s of the paper's Eq. 4."""
    phong_exponent: float = 8.0
    """alpha of the paper's Eq. 4."""

    def __post_init__(self) -> None:
        at = "optics.coating"
        for name in ("albedo", "specular", "phong_diffuse", "phong_specular"):
            within(getattr(self, name), 0.0, 1.0, what=name, unit="", at=f"{at}.{name}")
        within(self.roughness, 0.01, 1.0, what="roughness", unit="", at=f"{at}.roughness")
        exponent = self.phong_exponent
        within(exponent, 1.0, 1e3, what="Phong exponent", unit="", at=f"{at}.phong_exponent")


class Composition(enum.StrEnum):
    """How a frame is put together."""

    OVER_BACKGROUND = "over_background"
    """Skin that did not move keeps the background exactly, as the paper composes images."""
    ABSOLUTE = "absolute"
    """Dents cast the shadows of their lights on all of the skin; slower."""


class MarkerPattern(enum.StrEnum):
    """How the dots are laid out."""

    EVEN = "even"
    """All over the skin, none nearer to another than the spacing."""
    GRID = "grid"
    """Rows and columns about the tip, a spacing apart along the skin."""
    RINGS = "rings"
    """Circles about the tip, a spacing apart along the skin, and as far apart on each circle."""
    PICTURE = "picture"
    """Where `picture` is dark, wrapped over the skin from above."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Markers:
    """Dots printed on the skin that move with it."""

    visible: bool = False
    pattern: MarkerPattern = MarkerPattern.EVEN
    spacing_mm: float = 3.0
    diameter_mm: float = 0.8
    reflectance: float = 0.08
    """Share of the light that the ink returns, relative to the bare skin; black pigment."""
    picture: Photo | None = None
    """Dark places become markers; for the pattern `picture`."""
    picture_mm: float = 30.0
    """Width that the picture has on the skin [mm]."""

    def __post_init__(self) -> None:
        at = "optics.markers"
        within(self.spacing_mm, 0.5, 50.0, what="marker spacing", unit="mm", at=f"{at}.spacing_mm")
        widest = self.spacing_mm
        within(self.reflectance, 0.0, 20.0, what="ink", unit="", at=f"{at}.reflectance")
        within(self.picture_mm, 1.0, 500.0, what="picture", unit="mm", at=f"{at}.picture_mm")
        at = f"{at}.diameter_mm"
        within(self.diameter_mm, 0.1, widest, what="marker diameter", unit="mm", at=at)


@dataclass(frozen=True, kw_only=True, slots=True)
class Transport:
    """What traced photons meet on their way, and how many there are."""

    coating: Coating
    """Its Phong fields at their defaults: photons do not read them."""
    refractive_index: float
    baking: Baking


@dataclass(frozen=True, kw_only=True, slots=True)
class Optics:
    """Cameras, lights, coating and markers."""

    camera: Camera = field(default_factory=Camera)
    cameras: tuple[Camera, ...] = ()
    """Further cameras of the same sensor."""
    ring: LedRing = field(default_factory=LedRing)
    lamps: tuple[Lamp, ...] = ()
    """Further lights."""
    ambient: Ambient = field(default_factory=Ambient)
    coating: Coating = field(default_factory=Coating)
    markers: Markers = field(default_factory=Markers)
    refractive_index: float = 1.41
    """Index of elastomer and support [1]. Source: silicone, 1.40-1.43."""
    light_model: LightModel = BEST
    baking: Baking = field(default_factory=Baking)
    background: Photo | None = None
    """Photograph of the real sensor at rest, to which the contact is added; None renders it."""
    unit: Unit | None = None
    """How one built sensor differs from the design: its image at rest, which stands behind the
    contact where there is no `background`, and a residual. `workbench calibrate` writes it."""
    composition: Composition = Composition.OVER_BACKGROUND
    detail: bool = True
    """Show textures of the object that are finer than the grid of the contact solver."""

    def __post_init__(self) -> None:
        at = "optics.refractive_index"
        within(self.refractive_index, 1.0, 2.5, what="refractive index", unit="", at=at)
        within(len(self.cameras), 0, 7, what="further cameras", unit="", at="optics.cameras")
        within(len(self.lamps), 0, 64, what="lamps", unit="", at="optics.lamps")
        within(
            self.lights,
            1,
            512,
            what="points of light",
            unit="",
            at="optics.ring.count",
            hint="give the ring an LED or add a lamp; an area of light is divided by `samples`",
        )

    @property
    def lights(self) -> int:
        """Points of light: LEDs of the ring, and the points that lamps are divided into."""
        return self.ring.count + sum(lamp.points for lamp in self.lamps)

    @property
    def transport(self) -> Transport:
        """What traced light depends on besides the lights."""
        coating = self.coating
        return Transport(
            coating=Coating(
                albedo=coating.albedo, specular=coating.specular, roughness=coating.roughness
            ),
            refractive_index=self.refractive_index,
            baking=self.baking,
        )

    @property
    def all_cameras(self) -> tuple[Camera, ...]:
        """The camera and the further ones."""
        return (self.camera, *self.cameras)
