"""How good a reader is on views that judge: built sensors and places that it never learned from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.reading.network.spec import Scales
from sim.reading.pixel_maps import TOUCHED_MM
from workbench.learning.readers.view_set import ViewSet

if TYPE_CHECKING:
    from sim.reading.network.loss import Wanted
    from sim.reading.network.predictor import Told
    from sim.reading.network.unet import UNet

NOISE_GREY = 1.0
"""Of photographs that judge: noise of half of it to all of it, and nothing else is off."""
BATCH = 16
ONE_SIGMA = 0.683
"""Share of a normal distribution within one standard deviation."""
LEAST_N = 0.2
"""Force from which a relative error is told."""
SEED = 11


@dataclass(frozen=True, kw_only=True, slots=True)
class Judged:
    """A batch of views: what a network told of it, and what is true."""

    told: Told
    wanted: Wanted


def judged(
    network: UNet, views: ViewSet, scales: Scales, device: str, *, most: int
) -> Iterator[Judged]:
    """What a network tells of views, evenly chosen of them all.

    Args:
        network: In use, not in training.
        views: That judge.
        scales: Its units.
        device: Where it computes.
        most: Views that are read at most.
    """
    import torch

    from sim.reading.network.augment import NONE, Disturbance, disturbed
    from sim.reading.network.given import given
    from sim.reading.network.predictor import told

    quiet = {name: getattr(NONE, name) for name in NONE.__slots__}
    noise = Disturbance(**{**quiet, "noise_grey": NOISE_GREY})
    generator = torch.Generator(device=device).manual_seed(SEED)
    chosen = np.unique(np.linspace(0, len(views) - 1, min(most, len(views))).round().astype(int))
    for first in range(0, len(chosen), BATCH):
        idle, photos, wanted = views.batch(chosen[first : first + BATCH].tolist(), device)
        idle, photos = disturbed(idle, photos, noise, generator)
        with torch.inference_mode():
            maps, force = network(given(idle, photos))
        yield Judged(told=told(maps[:, :, : photos.shape[2]], force, scales), wanted=wanted)


def scores(batches: Iterator[Judged]) -> dict[str, Any]:
    """Figures of all views together; every error beside that of saying nothing."""
    off, null, ratio, angle, forces, fooled = [], [], [], [], [], []
    both = either = views = 0
    for batch in batches:
        told, wanted = batch.told, batch.wanted
        depth_mm = wanted.depth_mm.cpu().numpy()
        seen = np.isfinite(depth_mm)
        moved = seen & (np.nan_to_num(depth_mm) > TOUCHED_MM)
        error = (told.depth_mm - depth_mm)[moved]
        off.append(np.abs(error))
        null.append(depth_mm[moved])
        ratio.append(np.abs(error) / told.sigma_mm[moved])
        turn = wanted.turn.permute(0, 2, 3, 1).cpu().numpy()
        angle.append(np.degrees(np.linalg.norm(told.turn - turn, axis=3)[moved]))
        fooled.append(np.abs(told.depth_mm[seen & ~moved]))
        both += int((told.contact & moved).sum())
        either += int(((told.contact & seen) | moved).sum())
        views += len(depth_mm)
        forces.append(_forces(told, wanted))
    force = np.concatenate(forces)
    loaded = force[force[:, 1] > LEAST_N]
    return {
        "views": views,
        "depth_mae_mm": _mean(np.concatenate(off)),
        "zero_mae_mm": _mean(np.concatenate(null)),
        "calm_mae_mm": _mean(np.concatenate(fooled)),
        "turn_deg": _mean(np.concatenate(angle)),
        "contact_iou": both / max(either, 1),
        "within_sigma": _mean(np.concatenate(ratio) < 1.0),
        "ratio_of_one_sigma": _quantile(np.concatenate(ratio)),
        "force_error": _mean(loaded[:, 0] / loaded[:, 1]),
        "force_median_error": float(np.median(loaded[:, 0] / loaded[:, 1])) if len(loaded) else 0.0,
        "force_size_N": _mean(loaded[:, 1]),
        "force_within_sigma": _mean(force[:, 2] < force[:, 3]),
        "force_ratio_of_one_sigma": _quantile(force[:, 2] / force[:, 3]),
    }


def honest(scales: Scales, found: dict[str, Any]) -> Scales:
    """Scales whose standard deviations hold 68 % of the errors that the scores are of."""
    return scales.with_factors(
        sigma=scales.sigma * found["ratio_of_one_sigma"],
        force_sigma=scales.force_sigma * found["force_ratio_of_one_sigma"],
    )


def _forces(told: Told, wanted: Wanted) -> np.ndarray:
    """Length of the error, of the force, error of the size, and its deviation [N], (B, 4)."""
    true_N = wanted.force_N.cpu().numpy()
    size_N = np.linalg.norm(true_N, axis=1)
    return np.column_stack(
        [
            np.linalg.norm(told.force_N - true_N, axis=1),
            size_N,
            np.abs(np.linalg.norm(told.force_N, axis=1) - size_N),
            told.force_sigma_N,
        ]
    )


def _mean(values: np.ndarray) -> float:
    return float(values.mean()) if values.size else 0.0


def _quantile(values: np.ndarray) -> float:
    """Below which 68 % lie; 1 where there is nothing to go by."""
    return max(float(np.quantile(values, ONE_SIGMA)), 1e-3) if values.size else 1.0
