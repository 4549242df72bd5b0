"""What is made of a twin: how many photographs, by which contact and how much light."""

from __future__ import annotations

import enum
from dataclasses import dataclass

from workbench.core.base.check import within
from workbench.core.press.fem import QUALITY_MM

GPU_PHOTONS, CPU_PHOTONS, MITSUBA_PHOTONS = 64, 4, 16
"""Millions of photons of an image where nothing is said; Mitsuba traces on the processor."""
MOST_PHOTOS = 100_000


class Solver(enum.StrEnum):
    """What presses the twin."""

    FEM = "fem"
    """Finite elements: the truth of the product."""
    GENT = "gent"
    """Finite elements of a gel that hardens: another law than any that the product knows."""
    MPM = "mpm"
    """The contact solver: quicker, and what training sets are made by."""


class Light(enum.StrEnum):
    """What lights and sees the twin."""

    PHOTONS = "photons"
    """The product's own tracer and coating."""
    MITSUBA = "mitsuba"
    """Mitsuba 3: another tracer, another coating, and mirror images in the wall."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TwinPlan:
    """How much of a twin is photographed."""

    seed: int = 1
    """Of all that is drawn."""
    calibration: int = 20
    """Photographs of a ball for `workbench calibrate`."""
    presses: int = 140
    """Photographs of objects pressed in."""
    slides: int = 100
    """Sequences of objects that are dragged, half of them with slip."""
    contact: Solver = Solver.FEM
    light: Light = Light.PHOTONS
    photons_millions: int = 0
    """Photons of each image; 0: as many as suit the device."""
    width_px: int = 0
    """Width of the images, their shape kept; 0: the design's."""
    hex_mm: float = QUALITY_MM
    """Edge of a hexahedron of finite elements, and of the skin that images show."""
    ball_mm: float = 6.0
    """Diameter of the ball, as its printer was told."""
    object_mm: float = 6.0
    """Width of the other objects."""
    jobs: int = 1
    """Processes that press side by side."""

    def __post_init__(self) -> None:
        for name in ("calibration", "presses", "slides"):
            within(getattr(self, name), 0, MOST_PHOTOS, what=name, unit="", at=f"--{name}")
        what, unit = "photons of an image", "millions"
        within(self.photons_millions, 0, 10_000, what=what, unit=unit, at="--photons")
        if self.width_px:
            within(self.width_px, 16, 4096, what="width of images", unit="px", at="--width")
        within(self.hex_mm, 0.2, 3.0, what="mesh spacing", unit="mm", at="hex_mm")
        within(self.ball_mm, 1.0, 50.0, what="ball", unit="mm", at="ball_mm")
        within(self.object_mm, 1.0, 50.0, what="object", unit="mm", at="object_mm")
        within(self.jobs, 1, 1024, what="processes", unit="", at="--jobs")
        object.__setattr__(self, "contact", Solver(self.contact))
        object.__setattr__(self, "light", Light(self.light))

    def photons(self, device: str) -> int:
        """Photons of an image on a device, `cpu` or `cuda`."""
        usual = GPU_PHOTONS if device == "cuda" else CPU_PHOTONS
        if self.light is Light.MITSUBA:
            usual = MITSUBA_PHOTONS
        return 1_000_000 * (self.photons_millions or usual)
