"""Measures of dents, by closed forms; and a power law of pressure that they tell."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from workbench.core.base.monitor import silent
from workbench.tasks.examples import Examples
from workbench.tasks.features import shown_to, usual_network, with_features
from workbench.tasks.networks.measures import COUNT, measures
from workbench.tasks.networks.patch import GREY_PER_MM, MM_PER_PX, PATCH_PX
from workbench.tasks.safety_scale import SafetyScale
from workbench.tasks.splits import at_random
from workbench.tasks.task import Net, task_of
from workbench.tasks.trained import Trainer

AWAY_MM = np.hypot(*np.meshgrid(*[(np.arange(PATCH_PX) - PATCH_PX / 2 + 0.5) * MM_PER_PX] * 2))


def shown(dents_mm: list[np.ndarray]) -> np.ndarray:
    """Dents as they are read, (N, 1, h, w, 3)."""
    grey = np.rint(GREY_PER_MM * np.stack(dents_mm)).astype(np.int16)
    return np.repeat(grey[:, None, :, :, None], 3, axis=4)


def test_a_cone_has_the_measures_of_a_cone() -> None:
    """.8 mm deep, 4 mm wide: slope .2, volume pi r^2 d / 3, half as deep within half the radius."""
    depth_mm, radius_mm = 0.8, 4.0
    cone = np.maximum(depth_mm * (1.0 - AWAY_MM / radius_mm), 0.0)
    (one,) = measures(shown([cone]))[:, 0, 0]
    assert one.shape == (COUNT,)
    deepest = float(one[0])
    assert deepest == pytest.approx(depth_mm, rel=0.06)
    assert one[1:3] == pytest.approx([deepest**1.5, deepest**2])
    volume_mm3 = np.pi * radius_mm**2 * depth_mm / 3.0
    beyond = [(1.0 - level / depth_mm) * radius_mm for level in (0.05, 0.1)]
    beyond += [(1.0 - share * deepest / depth_mm) * radius_mm for share in (0.5, 0.8)]
    assert one[5:9] == pytest.approx(np.pi * np.square(beyond), rel=0.08)
    assert one[9] == pytest.approx(volume_mm3, rel=0.01)
    assert one[11] == pytest.approx(depth_mm / radius_mm, rel=0.05)
    assert one[13] == pytest.approx(np.pi * radius_mm**2 * 0.2**2, rel=0.05)


def test_no_dent_and_skin_that_bulges_measure_nothing() -> None:
    """Nor does anything grow without bound."""
    flat = np.zeros((PATCH_PX, PATCH_PX))
    found = measures(shown([flat, flat - 0.3]))[:, 0, 0]
    assert (found == 0.0).all()


def pressed(count: int, rng: np.random.Generator) -> Examples:
    """Spheres of several sizes by several depths, whose pressure is .2 sqrt(depth / radius) MPa."""
    depths_mm, radii_mm = rng.uniform(0.2, 1.0, count), rng.uniform(2.0, 6.0, count)
    dents = [
        np.maximum(depth - AWAY_MM**2 / (2.0 * radius), 0.0)
        for depth, radius in zip(depths_mm, radii_mm, strict=True)
    ]
    return Examples(
        names=tuple(map(str, range(count))),
        places=np.array(["place"] * count),
        inputs=shown(dents),
        at=rng.normal(size=(count, 8)).astype(np.float32),
        feet_mm=np.zeros((count, 3)),
        axes=np.tile(np.eye(3), (count, 1, 1)),
        motion=np.zeros(count),
        truth=0.2 * np.sqrt(depths_mm / radii_mm)[:, None],
        outputs=("peak_MPa",),
    )


def test_hertzian_pressures_are_told_by_dents(tmp_path: Path) -> None:
    """Of spheres that nothing was learned from: a fifth of what the median leaves, or less."""
    task, rng = task_of("safety"), np.random.default_rng(2)
    assert usual_network(task) is Net.MEASURES
    found = pressed(120, rng)
    scale = SafetyScale.of(found)
    seen = with_features(scale.with_safety(found), task, Net.MEASURES, "cpu", silent)
    trainer = Trainer(task=task, net=Net.MEASURES, folder=tmp_path, safety=scale, device="cpu")
    parts = at_random(len(seen), 0)
    trained = trainer.trained("sim", seen, parts, 0, silent)
    other = scale.with_safety(pressed(40, rng))
    assert shown_to(Net.MEASURES, other).shape == (40, 1, 1, COUNT)
    told = trained.told(other)
    left = np.abs(told - other.truth).mean(axis=0)
    median = np.median(seen.truth[parts.train], axis=0)
    assert (left < 0.2 * np.abs(other.truth - median).mean(axis=0)).all()
