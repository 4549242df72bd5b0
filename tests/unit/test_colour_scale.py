"""The colour scales are even to the eye and safe for colour-blind people.

Lightness and differences are those of CIELAB (D65). Colour blindness is simulated by the matrices
of Machado, Oliveira and Fernandes, IEEE TVCG 15, 2009, for severity 1, on linear light.
"""

from __future__ import annotations

import numpy as np
import pytest

from ui.page.imaging import heat_colours
from ui.scene.sensor import SKIN_COLOUR
from workbench.view.colour_scale import NOTHING_GREY, viridis

SRGB_XYZ = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
WHITE = np.array([0.95047, 1.0, 1.08883])
BLIND = {
    "normal": np.eye(3),
    "protanopia": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "deuteranopia": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
}
STEPS = 21
NOTICED = 2.3
"""Just noticeable difference in CIELAB (Sharma, Digital Color Imaging Handbook, 2003)."""


def lab(colours: np.ndarray, eye: str = "normal") -> np.ndarray:
    """CIELAB of sRGB colours (N, 3), uint8, as an eye sees them, shape (N, 3)."""
    display = np.asarray(colours) / 255.0
    linear = np.where(display <= 0.04045, display / 12.92, ((display + 0.055) / 1.055) ** 2.4)
    linear = np.clip(linear @ BLIND[eye].T, 0.0, 1.0)
    share = linear @ SRGB_XYZ.T / WHITE
    f = np.where(share > 0.008856, np.cbrt(share), 7.787 * share + 16 / 116)
    return np.stack(
        [116 * f[:, 1] - 16, 500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2])], axis=1
    )


def steps_lab(colours: np.ndarray, eye: str = "normal") -> np.ndarray:
    """CIELAB differences of neighbouring colours."""
    return np.linalg.norm(np.diff(lab(colours, eye), axis=0), axis=1)


def test_white_and_black_are_known() -> None:
    """White has L 100, black L 0, both without hue; else the yardstick is wrong."""
    found = lab(np.array([[255, 255, 255], [0, 0, 0]]))
    assert found == pytest.approx(np.array([[100.0, 0.0, 0.0], [0.0, 0.0, 0.0]]), abs=0.1)


@pytest.mark.parametrize("eye", list(BLIND))
def test_scale_grows_lighter_for_every_eye(eye: str) -> None:
    """From dark to light without a turn: the order is kept in grey and for colour-blind people."""
    lightness = lab(viridis(np.linspace(0, 1, STEPS)), eye)[:, 0]
    assert (np.diff(lightness) > 0.0).all()
    assert lightness[-1] - lightness[0] > 60.0


@pytest.mark.parametrize("eye", list(BLIND))
def test_neighbouring_steps_are_told_apart(eye: str) -> None:
    """Each of twenty steps is more than a just noticeable difference."""
    assert steps_lab(viridis(np.linspace(0, 1, STEPS)), eye).min() > NOTICED


def test_lightness_grows_evenly() -> None:
    """Lightness is a straight line in the value, to 2 of 100; viridis was made so in CAM02-UCS."""
    share = np.linspace(0, 1, 101)
    lightness = lab(viridis(share))[:, 0]
    line = np.polyval(np.polyfit(share, lightness, 1), share)
    # CIELAB is not CAM02-UCS: the published table bends by 1.4 here, the polynomial by 1.1.
    assert np.abs(lightness - line).max() < 2.0
    steps = steps_lab(viridis(np.linspace(0, 1, STEPS)))
    assert steps.max() / steps.min() < 2.5


@pytest.mark.parametrize("eye", list(BLIND))
def test_pressed_skin_tells_rest_from_contact(eye: str) -> None:
    """From 5 % on the colours are those of the scale; the skin at rest is none of them."""
    share = np.linspace(0.05, 1, STEPS)
    scale = heat_colours(share, SKIN_COLOUR)
    assert np.array_equal(scale, viridis(share))
    for ground in (SKIN_COLOUR, NOTHING_GREY):
        apart = np.linalg.norm(lab(scale, eye) - lab(np.array([ground]), eye), axis=1)
        assert apart.min() > 4 * NOTICED
