"""Scalars of a design for its score card, and image scores with their null.

The null of a tactile image is the background: what a method scores that shows no contact at all.
Scores are taken in the contact box, the smallest rectangle around the pixels whose depth changed
clearly, because elsewhere both images are equal, or nearly, by construction.
"""

from __future__ import annotations

import numpy as np

from sim.optics.field.model import Shading, model_of
from workbench.core.result.light import LightField
from workbench.core.result.results import MembraneMesh, Skin
from workbench.core.result.sensing import Contact, Metrics, TactileFrames

PEAK = 255.0
"""Largest grey level."""
CONTACT_SHARE = 0.1
"""Share of the largest change of depth at which a pixel belongs to the contact [1]."""
EDGE_PX = 5
"""Side of the square whose median leaves out edges behind which the skin jumps to another depth."""
REGION_SHARE = 0.1
"""Pixels of a region of the contact over those of the largest one [1], at least."""
DEEP_SHARE = 0.5
"""Largest change of a region over the largest of all [1], at least."""
FEWEST_LIGHTS = 3
"""Directions of light that determine a normal (photometric stereo)."""
SSIM_WINDOW_PX = 11
SSIM_SIGMA_PX = 1.5
"""Gaussian window of the structural similarity. Source: Wang and others 2004."""
SSIM_C1 = (0.01 * PEAK) ** 2
SSIM_C2 = (0.03 * PEAK) ** 2
"""Stabilising constants. Source: Wang and others 2004, eq. 13."""


def measure(
    mesh: MembraneMesh, contact: Contact, frames: TactileFrames, light: LightField
) -> Metrics:
    """Score card of a press; the last frame stands for it. Names end in their units."""
    background, image = frames.rgb[0], frames.rgb[-1]
    seen = np.isfinite(frames.depth_z_mm[0])
    displacement = np.linalg.norm(contact.displacement_mm, axis=2)
    peak = int(np.argmax(contact.normal_N))
    values = {
        "normal_force_N": float(contact.normal_N[-1]),
        "peak_normal_force_N": float(contact.normal_N[peak]),
        "stiffness_N_per_mm": _stiffness(contact, peak),
        "tangential_force_N": _tangential(contact),
        "displacement_max_mm": float(displacement.max()),
        "penetration_max_mm": float(contact.penetration_mm.max()),
        "image_covered_percent": 100.0 * float(seen.mean()),
        "image_evenness_p5_over_p95": _evenness(background[seen]),
        "contact_pixels_percent": 100.0 * float(contact_pixels(frames, -1).mean()),
    }
    if model_of(light.model).shading is Shading.DIRECT:
        # The other fields hold directions along the skin and no falloff: nothing to score there.
        values["skin_light_p5_over_p95"] = _ratio(light.irradiance.sum(axis=0))
        values["skin_lit_by_three_percent"] = 100.0 * lit_share(mesh.seen, light)
    box = contact_box(contact_pixels(frames, -1))
    if box is not None:
        change = np.abs(image[box].astype(np.float64) - background[box])
        values["contact_change_mean_grey"] = float(change.mean())
        values["contact_change_max_grey"] = float(change.max())
        values["contact_contrast_1"] = contrast(background[box], image[box])
        # Equal images have no finite ratio, and a table of variants holds finite numbers.
        values["contact_null_psnr_dB"] = min(psnr_dB(background[box], image[box]), 100.0)
        values["contact_null_ssim_1"] = ssim(background[box], image[box])
        values["change_per_force_grey_per_N"] = float(change.mean()) / max(
            float(contact.normal_N[-1]), 1e-12
        )
    return Metrics(values=values)


def contact_pixels(frames: TactileFrames, number: int) -> np.ndarray:
    """Moved pixels whose depth_z changed by a tenth of the largest change or more, (H, W) bool.

    The faint rim of a dent reaches far and would dilute the scores. A pixel that gained or lost
    the skin changed as much as any. An edge of the skin far from the contact, which moves by a
    hundredth and shows another depth behind it, neither says how much is large nor belongs to it;
    nor does a wall that the press bends a little.
    """
    import cv2

    moved = frames.moved[number]
    change = np.abs(frames.depth_z_mm[number] - frames.depth_z_mm[0])
    change = np.where(moved, np.nan_to_num(change, nan=np.inf), 0.0).astype(np.float32)
    finite = np.where(np.isfinite(change), change, np.float32(0.0))
    smooth = cv2.medianBlur(finite, EDGE_PX)
    if not smooth.any():
        smooth = finite
    chosen = moved & (change >= CONTACT_SHARE * smooth.max(initial=0.0))
    return _main_regions(chosen, smooth)


def _main_regions(chosen: np.ndarray, change: np.ndarray) -> np.ndarray:
    """Connected pixels without the regions that are small or shallow beside the main one, (H, W).

    Args:
        chosen: Shape (H, W), bool.
        change: Of each pixel, without edges, shape (H, W).
    """
    import cv2

    count, labels, found, _ = cv2.connectedComponentsWithStats(
        chosen.astype(np.uint8), connectivity=8
    )
    region = np.asarray(labels, dtype=np.int32)
    areas, deepest = found[:, cv2.CC_STAT_AREA], np.zeros(count)
    np.maximum.at(deepest, region, change)
    areas[0] = deepest[0] = 0
    large = areas >= REGION_SHARE * areas.max()
    return chosen & (large & (deepest >= DEEP_SHARE * deepest.max()))[region]


def lit_share(skin: Skin, light: LightField, count: int = FEWEST_LIGHTS) -> float:
    """Share of skin vertices lit from inside by at least `count` LEDs [1]."""
    shining = np.any(light.led_rgb > 0.0, axis=1, keepdims=True)
    from_inside = np.einsum("lvi,vi->lv", light.direction, skin.normals) < 0.0
    reaches = shining & from_inside & (light.irradiance > 0.0)
    return float((reaches.sum(axis=0) >= count).mean())


def contrast(background: np.ndarray, image: np.ndarray) -> float:
    """Standard deviation of the change of an image over the mean of its background [1]."""
    change = image.astype(np.float64) - background
    level = float(background.mean())
    return float(change.std()) / level if level > 0.0 else 0.0


def contact_box(moved: np.ndarray) -> tuple[slice, slice] | None:
    """Rows and columns of the smallest rectangle around the moved pixels; None without any."""
    rows, columns = np.flatnonzero(moved.any(axis=1)), np.flatnonzero(moved.any(axis=0))
    if not len(rows):
        return None
    return slice(int(rows[0]), int(rows[-1]) + 1), slice(int(columns[0]), int(columns[-1]) + 1)


def mae_grey(image: np.ndarray, reference: np.ndarray) -> float:
    """Mean absolute error in grey levels."""
    return float(np.abs(image.astype(np.float64) - reference).mean())


def psnr_dB(image: np.ndarray, reference: np.ndarray) -> float:
    """Peak signal to noise ratio [dB], 10 log10(255^2 / mean square error); inf when equal."""
    square = float(((image.astype(np.float64) - reference) ** 2).mean())
    return float("inf") if square == 0.0 else 10.0 * float(np.log10(PEAK**2 / square))


def ssim(image: np.ndarray, reference: np.ndarray) -> float:
    """Mean structural similarity over pixels and channels, 1 when equal.

    Source: Wang and others 2004, eq. 13, Gaussian window of 11 pixels, sigma 1.5.
    """
    import cv2

    def smooth(values: np.ndarray) -> np.ndarray:
        size = (SSIM_WINDOW_PX, SSIM_WINDOW_PX)
        return cv2.GaussianBlur(values, size, SSIM_SIGMA_PX)

    one, other = image.astype(np.float64), reference.astype(np.float64)
    mean_one, mean_other = smooth(one), smooth(other)
    variance_one = smooth(one * one) - mean_one**2
    variance_other = smooth(other * other) - mean_other**2
    covariance = smooth(one * other) - mean_one * mean_other
    luminance = (2 * mean_one * mean_other + SSIM_C1) / (mean_one**2 + mean_other**2 + SSIM_C1)
    structure = (2 * covariance + SSIM_C2) / (variance_one + variance_other + SSIM_C2)
    return float((luminance * structure).mean())


def _tangential(contact: Contact) -> float:
    force, normal = contact.reaction_N[-1], contact.normal
    return float(np.linalg.norm(force - (force @ normal) * normal))


def _stiffness(contact: Contact, peak: int) -> float:
    """Secant stiffness [N/mm]: normal force over the deepest inward displacement of that frame."""
    deepest_mm = float((-contact.displacement_mm[peak] @ contact.normal).max())
    return float(contact.normal_N[peak]) / deepest_mm if deepest_mm > 0.0 else 0.0


def _evenness(pixels: np.ndarray) -> float:
    from sim.optics.raster.display import srgb_decode

    return _ratio(srgb_decode(pixels.astype(np.float64) / PEAK).mean(axis=1))


def _ratio(values: np.ndarray) -> float:
    low, high = np.percentile(values, [5, 95])
    return float(low / high) if high > 0 else 0.0
