"""Measures of dents, by closed forms; and a power law of pressure that they tell."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from workbench.core.base.monitor import silent
from workbench.tasks.examples import Examples
from workbench.tasks.features import shown_to, usual_network, with_features
from workbench.tasks.networks.layer_pressure import POISSON, disc_pressure, layer_compliance
from workbench.tasks.networks.measures import COUNT, LEAST, TOP, measures
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
    (found,) = measures(shown([cone]))[:, 0, 0]
    assert found.shape == (COUNT,)
    one = found[COUNT // 2 :]
    np.testing.assert_allclose(found[: COUNT // 2], np.log(one + LEAST), rtol=1e-5)
    around_mm = np.sqrt(np.array(TOP) * MM_PER_PX**2 / np.pi)
    assert one[1:4] == pytest.approx(
        depth_mm * (1.0 - 2.0 * around_mm / (3.0 * radius_mm)), rel=0.02
    )
    volume_mm3 = np.pi * radius_mm**2 * depth_mm / 3.0
    beyond = [(1.0 - level / depth_mm) * radius_mm for level in (0.05, 0.1)]
    beyond += [(1.0 - share * one[1] / depth_mm) * radius_mm for share in (0.5, 0.8)]
    assert one[4:8] == pytest.approx(np.pi * np.square(beyond), rel=0.08)
    assert one[8] == pytest.approx(volume_mm3, rel=0.01)
    assert one[9] == pytest.approx(depth_mm / radius_mm, rel=0.05)
    assert one[10] == pytest.approx(np.pi * radius_mm**2 * 0.2**2, rel=0.05)
    assert one[0] == pytest.approx(disc_pressure(cone, 2.0).max(), rel=0.02)


def test_no_dent_and_skin_that_bulges_measure_nothing() -> None:
    """Nor does anything grow without bound."""
    flat = np.zeros((PATCH_PX, PATCH_PX))
    found = measures(shown([flat, flat - 0.3]))[:, 0, 0]
    assert (found[:, COUNT // 2 :] == 0.0).all()
    assert np.isfinite(found).all()


@pytest.mark.parametrize("poisson", [0.3, 0.45, 0.499])
def test_a_layer_is_a_half_space_to_short_waves_and_confined_to_long_ones(poisson: float) -> None:
    """Both limits of the compliance; it never sinks more than a half space."""
    thin = (1.0 - 2.0 * poisson) / (2.0 * (1.0 - poisson) ** 2)
    x = np.array([0.0, 1e-4, 30.0, 1e4])
    wanted = [0.0, 1e-4 * thin, 1.0, 1.0]
    np.testing.assert_allclose(layer_compliance(x, poisson), wanted, rtol=1e-4, atol=1e-12)
    between = layer_compliance(np.linspace(0.0, 30.0, 3000), poisson)
    assert (between <= 1.0 + 1e-9).all()


def test_a_hertzian_dent_has_the_pressure_of_hertz() -> None:
    """On a half space: the mean on a disc in the middle, by the closed form, to 3 %.

    Displacement inside and outside of the contact: Johnson, Contact mechanics, 1985, section 3.4.
    """
    reach_mm, disc_mm = 1.6, 2.0
    far = np.maximum(AWAY_MM, reach_mm)
    inside = np.pi * (2.0 * reach_mm**2 - AWAY_MM**2) / (4.0 * reach_mm)
    outside = (2.0 * reach_mm**2 - far**2) * np.arcsin(reach_mm / far)
    outside += far * reach_mm * np.sqrt(1.0 - (reach_mm / far) ** 2)
    dent_mm = np.where(AWAY_MM < reach_mm, inside, outside / (2.0 * reach_mm))
    ratio = (0.5 * disc_mm / reach_mm) ** 2
    mean = 2.0 / 3.0 * (1.0 - (1.0 - ratio) ** 1.5) / ratio
    middle = slice(PATCH_PX // 2 - 1, PATCH_PX // 2 + 1)
    found = disc_pressure(dent_mm, disc_mm, thick_mm=1000.0)
    assert found[middle, middle].mean() == pytest.approx(mean, rel=0.03)


def test_a_wide_dent_of_a_thin_layer_is_confined_compression() -> None:
    """Pressure (1 - nu)^2 u / (1 - 2 nu) h over E*, in the middle."""
    thick_mm, inward_mm = 0.1, 0.02
    found = disc_pressure(np.full((PATCH_PX, PATCH_PX), inward_mm), 2.0, thick_mm)
    wanted = (1.0 - POISSON) ** 2 * inward_mm / ((1.0 - 2.0 * POISSON) * thick_mm)
    assert found[PATCH_PX // 2, PATCH_PX // 2] == pytest.approx(wanted, rel=0.01)


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
