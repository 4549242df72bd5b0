"""The coating, an LED and the lens direction by direction, against formulas written a second time.

The formulas are those of the literature, see `sim.optics.proof.lobe_checks`: nothing of the
product's own arrangement of them is used. Nulls are what a lobe 30 % too wide gives.
"""

from __future__ import annotations

import dataclasses
import functools

import numpy as np

from workbench.core.design.optics import Coating
from workbench.proof.row import Row, bounded, compared

COATINGS = {
    "default coating": Coating(),
    "matte grey": Coating(albedo=0.6, specular=0.04, roughness=0.35),
    "mirror-like": Coating(albedo=0.0, specular=0.5, roughness=0.1),
    "rough metal": Coating(albedo=0.0, specular=1.0, roughness=0.6),
}
WIDER = 1.3
DOUBLE_PRECISION, SINGLE_PRECISION = 1e-5, 2e-4
"""The lobe's peak is a difference of numbers near 1, over a^4 of the roughness."""
QUADRATURE = 1e-3
LEDS = ((0.0, 180.0), (1.0, 180.0), (3.0, 180.0), (20.0, 180.0), (1.0, 60.0), (3.0, 30.0))
"""Exponents and cones [degree]."""
PHOTONS = 100_000
SHARE_LIMIT = 2e-3
"""The emission's lattice is far more even than chance."""


def rows() -> list[Row]:
    """All of them."""
    return [
        *(row for name, coating in COATINGS.items() for row in _coating_rows(name, coating)),
        *(row for exponent, cone_deg in LEDS for row in _led_rows(exponent, cone_deg)),
        *_lens_rows(),
    ]


def _coating_rows(name: str, coating: Coating) -> list[Row]:
    from sim.optics.proof import lobe_checks as checks

    what = f"{name}: directions to 80 degrees against Walter's formula"
    null = "null: a lobe 30 % wider"
    wide = checks.lobe_error(coating, too_wide)
    return [
        bounded(
            "coating_lobe",
            f"{what}; {null}",
            functools.partial(checks.lobe_error, coating),
            unit="1",
            limit=DOUBLE_PRECISION,
            null=wide,
        ),
        bounded(
            "coating_lobe",
            f"{what}, as the device computes; {null}",
            functools.partial(checks.lobe_error, coating, checks.on_device),
            unit="1",
            limit=SINGLE_PRECISION,
            null=wide,
        ),
        bounded(
            "coating_reciprocity",
            f"{name}: light and eye exchanged, directions to 80 degrees",
            functools.partial(checks.reciprocity_error, coating),
            unit="1",
            limit=DOUBLE_PRECISION,
        ),
        bounded(
            "coating_energy",
            f"{name}: largest share of a beam that is returned, beams to 80 degrees",
            functools.partial(checks.most_returned, coating),
            unit="1",
            limit=1.0,
        ),
        compared(
            "coating_head_on",
            f"{name}: share of a beam along the normal that is returned; exact: one integral; "
            f"{null}",
            functools.partial(checks.returned, coating, 0.0),
            functools.partial(checks.head_on_returned, coating),
            unit="1",
            limit=QUADRATURE,
            null=functools.partial(checks.returned, coating, 0.0, too_wide),
        ),
    ]


def too_wide(
    coating: Coating, to_light: np.ndarray, normal: np.ndarray, to_eye: np.ndarray
) -> np.ndarray:
    """The product's coating with a roughness 30 % too large."""
    from sim.optics.light.coating import glossy

    wide = dataclasses.replace(coating, roughness=WIDER * coating.roughness)
    return glossy(wide, to_light, normal, to_eye)


def _led_rows(exponent: float, cone_deg: float) -> list[Row]:
    from sim.optics.proof import lobe_checks as checks

    what = f"cos^{exponent:g} into {cone_deg:g} degrees"
    within_deg = 20.0 if cone_deg >= 60.0 else 10.0
    wider = functools.partial(checks.exact_led_share, exponent + 1.0, cone_deg, within_deg)
    return [
        compared(
            "led_flux",
            f"{what}: power through a sphere about an LED of power 1",
            functools.partial(checks.led_flux, exponent, cone_deg),
            1.0,
            unit="1",
            limit=1e-6,
        ),
        compared(
            "led_share",
            f"{what}: photons within {within_deg:g} degrees of the axis; null: exponent "
            f"{exponent + 1.0:g}",
            functools.partial(checks.led_share, exponent, cone_deg, within_deg, PHOTONS),
            functools.partial(checks.exact_led_share, exponent, cone_deg, within_deg),
            unit="1",
            limit=SHARE_LIMIT,
            null=wider,
        ),
    ]


def _lens_rows() -> list[Row]:
    from sim.optics.proof import lobe_checks as checks

    return [
        bounded(
            "vignetting",
            "pinhole: share of light at each pixel against cos^4; null: even",
            checks.vignetting_error,
            unit="1",
            limit=1e-6,
            null=checks.vignetting_error(vignetting=0.0),
        )
    ]
