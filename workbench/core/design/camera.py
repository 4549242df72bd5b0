"""The camera a designer chooses: lens, place, focus, and the image sensor behind it."""

from __future__ import annotations

import enum
import itertools
import math
from dataclasses import dataclass, field
from typing import Any

from workbench.core.base.check import within
from workbench.core.base.errors import DesignError


class LensModel(enum.StrEnum):
    """How a direction becomes a pixel; theta is the angle to the optical axis."""

    PINHOLE = "pinhole"
    """r = f tan(theta)."""
    EQUIDISTANT = "equidistant"
    """Fisheye, r = f theta: the wide-angle lens of finger-shaped sensors."""
    OPENCV = "opencv"
    """Pinhole with OpenCV's distortion k1, k2, p1, p2, k3."""
    OPENCV_FISHEYE = "opencv_fisheye"
    """r = f (theta + k1 theta^3 + k2 theta^5 + k3 theta^7 + k4 theta^9)."""


WIDEST_DEG = {
    LensModel.PINHOLE: 175.0,
    LensModel.OPENCV: 175.0,
    LensModel.EQUIDISTANT: 180.0,
    LensModel.OPENCV_FISHEYE: 180.0,
}
"""Largest field of view of each lens model [degree]."""
COEFFICIENTS = {LensModel.OPENCV: (4, 5), LensModel.OPENCV_FISHEYE: (4,)}
"""How many distortion coefficients each lens model takes, besides none at all."""
LEAST_KEPT, MOST_KEPT = 0.02, 4.0
"""Shares of light between which a measured fall-off may lie [1]: a photograph is divided by it."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ImageSensor:
    """From light on a pixel to its grey level. The defaults add nothing to the light itself."""

    exposure: float = 0.0
    """Display light per radiance; 0 chooses it so that the background is well exposed."""
    gain_dB: float = 0.0
    """Amplification of signal and noise [dB]. With exposure 0 it stands for a shorter exposure."""
    gain_rgb: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """Amplification of each colour: the white balance. A photograph as background sets its own."""
    gamma: float = 0.0
    """Display value = light^(1 / gamma); 0 is the curve of sRGB."""
    response: tuple[float, ...] = ()
    """Measured curve instead of `gamma`: rising display values in [0, 1] at even steps of light
    from none to white, straight between them; () is none."""
    vignetting: float = 0.0
    """Share of the natural fall-off cos^4 of the angle to the optical axis, in [0, 1]."""
    falloff: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Measured fall-off on top: light times 1 + k1 r^2 + k2 r^4 + k3 r^6, with the distance r from
    the middle of the image over half its diagonal."""
    noise: bool = False
    """Draw the noise of each image from the numbers below."""
    full_well_e: float = 10_000.0
    """Electrons of a white pixel at gain 0. Source: small CMOS sensors, 4,000 to 20,000."""
    read_noise_e: float = 3.0
    """Standard deviation of the read-out [electrons]. Source: small CMOS sensors, 2 to 5."""
    seed: int = 0
    """Of the noise; equal seeds give equal images."""

    def __post_init__(self) -> None:
        at = "optics.camera.sensor"
        within(self.exposure, 0.0, 1e9, what="exposure", unit="", at=f"{at}.exposure")
        within(self.gain_dB, 0.0, 60.0, what="gain", unit="dB", at=f"{at}.gain_dB")
        within(self.gamma, 0.0, 5.0, what="gamma", unit="", at=f"{at}.gamma")
        if 0.0 < self.gamma < 0.2:
            raise DesignError(
                f"gamma {self.gamma:g} is less than 0.2",
                hint="use 2.2, 1 for linear images, or 0 for the curve of sRGB",
                at=f"{at}.gamma",
            )
        within(self.vignetting, 0.0, 1.0, what="vignetting", unit="", at=f"{at}.vignetting")
        for gain in self.gain_rgb:
            within(gain, 0.01, 100.0, what="gain of a colour", unit="", at=f"{at}.gain_rgb")
        self._check_response(f"{at}.response")
        self._check_falloff(f"{at}.falloff")
        at_well = f"{at}.full_well_e"
        within(self.full_well_e, 10.0, 1e7, what="full well", unit="electrons", at=at_well)
        at_read = f"{at}.read_noise_e"
        within(self.read_noise_e, 0.0, 1e4, what="read noise", unit="electrons", at=at_read)
        within(self.seed, 0, 2**31 - 1, what="seed", unit="", at=f"{at}.seed")

    def _check_response(self, at: str) -> None:
        if not self.response:
            return
        within(len(self.response), 2, 1025, what="values of the response", unit="", at=at)
        for value in self.response:
            within(value, 0.0, 1.0, what="value of the response", unit="", at=at)
        if any(after <= before for before, after in itertools.pairwise(self.response)):
            raise DesignError(
                "the response does not rise from each value to the next",
                hint="give display values at even steps of light, from 0 for none to 1 for white",
                at=at,
            )

    def _check_falloff(self, at: str) -> None:
        for value in self.falloff:
            within(value, -10.0, 10.0, what="coefficient of the fall-off", unit="", at=at)
        kept = [falloff_share(self.falloff, step / 100.0) for step in range(101)]
        if not LEAST_KEPT <= min(kept) <= max(kept) <= MOST_KEPT:
            worst = min(kept) if min(kept) < LEAST_KEPT else max(kept)
            raise DesignError(
                f"the fall-off leaves {worst:.3g} of the light somewhere between the middle and "
                f"the corner, beyond {LEAST_KEPT:g} to {MOST_KEPT:g}",
                hint="fit 1 + k1 r^2 + k2 r^4 + k3 r^6 to the light of an evenly lit sheet, r = 1 "
                "at the corner",
                at=at,
            )


def falloff_share(coefficients: tuple[float, float, float], radius: Any) -> Any:
    """Share of light kept at a radius [1], of numbers or arrays: `ImageSensor.falloff`.

    Source: the even polynomial of lens profiles; Goldman, IEEE PAMI 32 (2010) 2276, eq. 3.
    """
    square = radius * radius
    k1, k2, k3 = coefficients
    return 1.0 + square * (k1 + square * (k2 + square * k3))


@dataclass(frozen=True, kw_only=True, slots=True)
class Camera:
    """One camera inside the sensor."""

    width_px: int = 640
    height_px: int = 480
    fov_x_deg: float = 100.0
    """Horizontal field of view, distortion included [degree]; the only one there is.

    Source: a 1.5 mm lens on an OV5640 sees about 101 degrees across.
    """
    lens: LensModel = LensModel.PINHOLE
    distortion: tuple[float, ...] = ()
    """Coefficients in OpenCV's order, for the two lens models that have them; () is none."""
    position_mm: tuple[float, float, float] = (0.0, 0.0, 0.3)
    """Optical centre [mm], sensor frame."""
    wxyz: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    """Rotation camera to sensor as a unit quaternion; identity looks along +Z."""
    focus_mm: float = 25.0
    """Distance along the line of sight that is in focus [mm]."""
    aperture_mm: float = 0.0
    """Diameter of the entrance pupil [mm]; 0 has no blur. A 1.5 mm lens at f/2.2 has 0.7 mm."""
    sensor: ImageSensor = field(default_factory=ImageSensor)

    def __post_init__(self) -> None:
        for name in ("width_px", "height_px"):
            at = f"optics.camera.{name}"
            within(getattr(self, name), 16, 4096, what=name, unit="px", at=at)
        widest, at = WIDEST_DEG[self.lens], "optics.camera.fov_x_deg"
        hint = f"choose from 5 to {widest:g} degrees; lens = 'equidistant' sees up to 180"
        if self.lens in (LensModel.EQUIDISTANT, LensModel.OPENCV_FISHEYE):
            hint = "choose from 5 to 180 degrees; lenses of this size see 60 to 180"
        within(self.fov_x_deg, 5.0, widest, what="field of view", unit="degree", at=at, hint=hint)
        hint = "give x, y, z in mm from the centre of the base, each from -500 to 500"
        at = "optics.camera.position_mm"
        for axis_mm in self.position_mm:
            within(axis_mm, -500.0, 500.0, what="camera position", unit="mm", at=at, hint=hint)
        if not 0.99 < sum(q * q for q in self.wxyz) < 1.01:
            raise DesignError(
                f"camera quaternion {self.wxyz} has length {math.hypot(*self.wxyz):.3f}, not 1",
                hint="give w, x, y, z of length 1; (1, 0, 0, 0) looks along +Z",
                at="optics.camera.wxyz",
            )
        at = "optics.camera.focus_mm"
        within(self.focus_mm, 1.0, 1e4, what="focus distance", unit="mm", at=at)
        at = "optics.camera.aperture_mm"
        within(self.aperture_mm, 0.0, 10.0, what="aperture", unit="mm", at=at)
        self._check_distortion()

    def _check_distortion(self) -> None:
        at = "optics.camera.distortion"
        for value in self.distortion:
            within(value, -10.0, 10.0, what="distortion coefficient", unit="", at=at)
        counts = COEFFICIENTS.get(self.lens, ())
        if not self.distortion or len(self.distortion) in counts:
            return
        takes = " or ".join(str(count) for count in counts) or "no"
        raise DesignError(
            f"the lens model {self.lens.value} takes {takes} distortion coefficients, "
            f"not {len(self.distortion)}",
            hint="opencv: k1, k2, p1, p2, k3; opencv_fisheye: k1, k2, k3, k4; else leave it empty",
            at=at,
        )
