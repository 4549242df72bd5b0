"""Scores of rendered dents against the shipped photon-traced images.

A dent's image is the reference's own undeformed radiance plus gain times what the model says the
dent changes, so that models without a scale of their own can be compared; the gain is one scalar
per scene, fitted on the sphere, or 1. Scores are taken on 8-bit sRGB in the box around vertices
that moved by 0.1 mm or more, as seen, with 6 pixels about it. The null is the background; the
ceiling is one half of the photons against the other.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.optics.raster.display import choose_exposure, encode
from sim.optics.studio.metrics import psnr_dB, ssim
from sim.optics.studio.render import Studio
from workbench.core.base.errors import OpticsError, StoreError
from workbench.proof.validation.optics.light_scenes import body_digest

FILE = Path(__file__).with_name("photon_reference.npz")
CLEAR_MM = 0.1
MARGIN_PX = 6

Box = tuple[slice, slice]


@dataclass(frozen=True, kw_only=True, slots=True)
class Score:
    """How alike two images are in a box."""

    ssim_1: float
    psnr_dB: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Reference:
    """One frame of one scene."""

    light: np.ndarray
    """Display light, shape (H, W, 3), float32; of a dent right only in its box."""
    box: Box
    ceiling: Score
    """One half of the photons against the other."""
    photons: float
    """Of both halves."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SceneReference:
    """All frames of one scene, the undeformed one as `flat`."""

    frames: dict[str, Reference]
    exposure: float
    """From radiance to display light."""
    device: str


def score(light: np.ndarray, truth: np.ndarray, box: Box) -> Score:
    """Score of display light (H, W, 3) against another, as 8-bit sRGB in a box."""
    one, other = (encode(np.maximum(image, 0.0)[box], 1.0) for image in (light, truth))
    return Score(ssim_1=ssim(one, other), psnr_dB=min(psnr_dB(one, other), 100.0))


def fitted_gain(change: np.ndarray, truth: np.ndarray, box: Box) -> float:
    """The scalar g that brings g change nearest to the true change in a box."""
    return true_gain(change[box], change[box], truth[box])


def true_gain(one: np.ndarray, other: np.ndarray, truth: np.ndarray) -> float:
    """The scalar g that brings g times a model's change nearest to the true one, noise apart.

    Noise of what is fitted makes least squares read too little: g falls by its share of the square.
    Two bakes from different photons have noises that know nothing of each other (an instrumental
    variable; Fuller, Measurement Error Models, 1987, section 1.4).

    Args:
        one: Change of one bake, (H, W, 3).
        other: Change of another, alike.
        truth: True change, alike.
    """
    one, other = one.astype(np.float64), other.astype(np.float64)
    square = float((one * other).sum())
    return float(((one + other) * truth).sum()) / (2.0 * square) if square > 0.0 else 0.0


def box_around(uv_px: np.ndarray, size_px: tuple[int, int]) -> Box:
    """Rows and columns about pixel coordinates (N, 2), with a margin, inside (rows, columns)."""
    rows, columns = size_px
    low = np.floor(uv_px.min(axis=0)).astype(int) - MARGIN_PX
    high = np.ceil(uv_px.max(axis=0)).astype(int) + MARGIN_PX
    return (
        slice(max(int(low[1]), 0), min(int(high[1]), rows)),
        slice(max(int(low[0]), 0), min(int(high[0]), columns)),
    )


@functools.cache
def reference(scene: str) -> SceneReference:
    """What photons showed of a scene.

    Raises:
        StoreError: If the file is missing, knows no such scene, or saw another body in it.
    """
    hint = "write it: python -m workbench.proof.validation.optics.photon_reference"
    if not FILE.exists():
        raise StoreError(f"{FILE.name} is missing", hint=hint)
    frames, exposure, device = {}, 0.0, ""
    with np.load(FILE) as data:
        body = str(data[f"{scene}|body"]) if f"{scene}|body" in data.files else ""
        heads = [n.removesuffix("|light") for n in data.files if n.startswith(f"{scene}|")]
        for head in (h for h in heads if f"{h}|light" in data.files):
            numbers = data[f"{head}|numbers"]
            box = (slice(*numbers[:2].astype(int)), slice(*numbers[2:4].astype(int)))
            light = np.zeros((*numbers[4:6].astype(int), 3), dtype=np.float32)
            frame = head.split("|")[1]
            light[slice(None) if frame == "flat" else box] = data[f"{head}|light"]
            frames[frame] = Reference(
                light=light,
                box=box,
                ceiling=Score(ssim_1=float(numbers[6]), psnr_dB=float(numbers[7])),
                photons=float(numbers[8]),
            )
            exposure, device = float(numbers[9]), str(data["device"])
    if "flat" not in frames:
        raise StoreError(f"{FILE.name} knows no scene {scene}", hint=hint)
    if body != body_digest(scene.split(maxsplit=1)[0]):
        raise StoreError(f"{FILE.name} shows another body as {scene} than today's", hint=hint)
    return SceneReference(frames=frames, exposure=exposure, device=device)


def flat_exposure(radiance: np.ndarray) -> float:
    """Exposure of an undeformed image (H, W, 3), from the pixels that see any light."""
    lit = radiance.reshape(-1, 3)
    return choose_exposure(lit[lit.max(axis=1) > 0.0])


def dent_box(studio: Studio, displacement_mm: np.ndarray, size_px: tuple[int, int]) -> Box:
    """The box around what moved clearly, as the camera sees it at rest.

    Raises:
        OpticsError: If the camera sees nothing of it.
    """
    clear = np.linalg.norm(displacement_mm, axis=1) > CLEAR_MM
    seen = clear & studio.visible & np.isfinite(studio.vertex_pixels[:, 0])
    if not seen.any():
        raise OpticsError("the camera does not see the dent", hint="put it nearer to the tip")
    return box_around(studio.vertex_pixels[seen, :2], size_px)
