"""What contact leaves of a texture, and how far a skin under pressure follows it."""

from __future__ import annotations

import numpy as np
import pytest

from sim.contact.objects.fine_surface import _frame, fine_surface
from sim.optics.studio.detail_filling import filling, followed_slope, full_pressure_MPa, gap_share
from workbench.core.press.texture import SMOOTH, HeightImage, Pattern, Texture

FINE = Texture(pattern=Pattern.WAVES, pitch_mm=0.5, height_mm=0.03)
PLANE_STRAIN_MPa = 0.18
COARSE = {"grid_mm": 0.5, "edge_mm": 0.4}


def line(length_mm: float) -> np.ndarray:
    """Places along X."""
    x = np.linspace(-length_mm, length_mm, 4001)
    return np.column_stack([x, np.full(len(x), 0.3)])


def test_waves_finer_than_the_samples_are_left_whole() -> None:
    """f = (H / 2) cos(2 pi x / P), its slope at most pi H / P: 0.1885."""
    surface = fine_surface(FINE, **COARSE)
    assert surface is not None
    place = line(3.0)
    height, slope = surface.read(place)
    # Linear between 64 points per period: (pi / 64)^2 / 2 = 0.12 %.
    assert height == pytest.approx(0.015 * np.cos(4.0 * np.pi * place[:, 0]), abs=3e-5)
    assert slope[:, 0].max() == pytest.approx(np.pi * 0.03 / 0.5, rel=3e-3)
    assert np.abs(slope[:, 1]).max() < 1e-6
    assert surface.slope_rms == pytest.approx(np.pi * 0.03 / 0.5 / 2.0**0.5, rel=3e-3)


def test_waves_that_the_skin_carries_are_left_in_part() -> None:
    """Five edges per period: 1 - exp(-(2 pi 0.4 / 2)^2 / 4) = 32.6 % of the amplitude 0.1 mm."""
    surface = fine_surface(Texture(pattern=Pattern.WAVES, pitch_mm=2.0, height_mm=0.2), **COARSE)
    assert surface is not None
    assert surface.high_mm == pytest.approx(0.03262, rel=1e-3)
    assert surface.low_mm == pytest.approx(-0.03262, rel=1e-3)


def test_the_raster_of_letters_ends_four_sigmas_beside_them() -> None:
    """Two letters of 1.5 mm with half a capital around: 4.5 x 3 mm, and 8 sigma of 0.2 mm."""
    text = Texture(pattern=Pattern.LETTERS, pitch_mm=1.5, height_mm=0.05, text="OK")
    origin_mm, step_mm, shape = _frame(text, 0.2, False)
    extent_mm = step_mm * (np.array(shape) - 1)
    np.testing.assert_allclose(extent_mm, [4.5 + 1.6, 3.0 + 1.6], atol=step_mm)
    np.testing.assert_allclose(origin_mm + 0.5 * extent_mm, 0.0, atol=1e-12)


@pytest.mark.parametrize(
    "texture",
    [
        Texture(pattern=Pattern.GRID, pitch_mm=0.8, height_mm=0.05),
        Texture(pattern=Pattern.DOTS, pitch_mm=3.0, height_mm=0.05),
        Texture(pattern=Pattern.LETTERS, pitch_mm=1.5, height_mm=0.05, text="OK"),
        Texture(
            pattern=Pattern.IMAGE,
            image=HeightImage(heights=np.eye(32)),
            pitch_mm=3.0,
            height_mm=0.05,
        ),
    ],
)
def test_detail_has_no_mean_and_ends(texture: Texture) -> None:
    """Mean of f is 0 to 1 % of the height; slopes are those of f; beside a picture there is 0."""
    surface = fine_surface(texture, **COARSE)
    assert surface is not None
    assert abs(surface.raster[..., 0].mean()) < 0.01 * texture.height_mm
    place = line(2.0)
    place = place[np.abs(place[:, 0]) < 1.5]
    height, slope = surface.read(place)
    # Slopes are differences over 0.04 mm; creases of crossing ridges are rounded by them.
    found = np.gradient(height, place[:, 0])
    assert np.percentile(np.abs(found - slope[:, 0]), 90) < 0.1 * np.abs(slope).max() + 1e-3
    if not surface.repeats:
        far = np.array([[50.0, 0.0], [0.0, -50.0]])
        assert not surface.read(far)[0].any() and not surface.read(far)[1].any()


def test_smooth_objects_leave_nothing() -> None:
    """No texture, one of height 0, and one that the skin carries whole."""
    assert fine_surface(SMOOTH, **COARSE) is None
    assert fine_surface(Texture(pattern=Pattern.DOTS, height_mm=0.0), **COARSE) is None
    wide = Texture(pattern=Pattern.WAVES, pitch_mm=60.0, height_mm=0.05)
    assert fine_surface(wide, **COARSE) is None


@pytest.mark.parametrize(
    ("share", "filled"), [(0.0, 0.0), (0.25, 0.46321), (0.5, 0.73358), (1.0, 1.0), (3.0, 1.0)]
)
def test_valleys_fill_by_the_share_of_westergaard(share: float, filled: float) -> None:
    """1 - sqrt(1 - q) + q arcosh(1 / sqrt(q)): 0.46321 at a quarter, 0.73358 at a half."""
    # A share of 0 is taken as 1e-6.
    assert 1.0 - gap_share(np.array(1.0), np.array(share)) == pytest.approx(filled, abs=2e-5)


def test_gap_is_the_integral_of_westergaards_slope() -> None:
    """gap' = 4 p* / (E* s^2)..., in units of H: 2 cos(y) sqrt(sin(y)^2 - q) over y = pi x / l."""
    q = 0.3
    y = np.linspace(np.arcsin(q**0.5), 0.5 * np.pi, 20001)
    rise = 2.0 * np.cos(y) * np.sqrt(np.maximum(np.sin(y) ** 2 - q, 0.0))
    integral = np.append(0.0, np.cumsum(0.5 * (rise[1:] + rise[:-1]) * np.diff(y)))
    found = gap_share(np.sin(y) ** 2, np.array(q))
    # The trapezoid rule at the root of the integrand.
    assert np.abs(found - integral).max() < 1e-6


def test_slope_of_the_skin_is_that_of_its_height() -> None:
    """d(f + gap) / df = 1 - sqrt(1 - q / t^2) below the contact's edge, 1 above."""
    depth = np.linspace(0.0, 1.0, 20001)
    skin = -depth + gap_share(depth, np.array(0.4))
    middle = 0.5 * (depth[1:] + depth[:-1])
    found = -np.diff(skin) / np.diff(depth)
    # The slope has a root at the edge of contact.
    assert np.abs(found - followed_slope(middle, np.array(0.4))).max() < 5e-3


def test_full_pressure_is_westergaards() -> None:
    """pi E* d / l = pi 0.18 0.015 / 0.5 = 16.96 kPa."""
    surface = fine_surface(FINE, **COARSE)
    assert surface is not None
    exact = np.pi * PLANE_STRAIN_MPa * 0.015 / 0.5
    found = full_pressure_MPa(surface.slope_rms, PLANE_STRAIN_MPa)
    assert found == pytest.approx(exact, rel=3e-3)


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 1.0, 2.0])
def test_skin_is_flat_without_pressure_and_the_relief_under_all_of_it(share: float) -> None:
    """Range over H: 0, then 1 - sqrt(1 - q) + q arcosh(1 / sqrt(q)), then 1; the mean stays 0."""
    surface = fine_surface(FINE, **COARSE)
    assert surface is not None
    relief = filling(surface, PLANE_STRAIN_MPa)
    # One thousand periods' phases, none twice.
    place = np.column_stack([0.5 * (np.arange(5000) + 0.5) / 5000.0, np.zeros(5000)])
    skin, slope = relief.heights(place, np.full(5000, share * relief.full_MPa))
    q = min(share, 1.0)
    filled = 1.0 - gap_share(np.array(1.0), np.array(q))
    assert np.ptp(skin) / 0.03 == pytest.approx(float(filled), abs=2e-3)
    # The mean gap is a table over 64 shares.
    assert abs(skin.mean()) < 2e-3 * 0.03
    # Heights are linear between 64 points per period: their slope is off by pi / 64 = 5 %.
    numeric = np.gradient(skin, place[:, 0])
    assert np.abs(slope[:, 0] - numeric)[2:-2].max() < 0.055 * np.pi * 0.03 / 0.5
