"""The table of radiance by tilt: kernels against their plain twins, and exact entries."""

from typing import Any

import numpy as np
import pytest

from sim.optics.field.table import (
    bin_directions,
    collapse,
    filled,
    look_up,
    mean_reflectance,
    tilted_normals,
)
from sim.optics.light.bins import bin_cosines, bin_shares, sharpened
from workbench.core.design.optics import Coating
from workbench.core.result.light import AZIMUTHS, SINES, TILT_SPAN, TILTS

BINS = AZIMUTHS * (len(SINES) - 1)


@pytest.fixture(scope="module")
def looked_up(taichi_device: str) -> Any:
    """The kernel's look-up at all vertices of a random table, and the same by the plain twin."""
    import taichi as ti
    import taichi.math as tm

    from sim.optics.field import table_kernels

    @ti.kernel
    def run(
        table: ti.types.ndarray(dtype=ti.f32, ndim=5),  # pyright: ignore
        nodes: ti.types.ndarray(dtype=ti.i32, ndim=2),  # pyright: ignore
        weights: ti.types.ndarray(dtype=ti.f32, ndim=2),  # pyright: ignore
        frames: ti.types.ndarray(dtype=ti.f32, ndim=3),  # pyright: ignore
        normals: ti.types.ndarray(dtype=tm.vec3, ndim=1),  # pyright: ignore
        out: ti.types.ndarray(dtype=tm.vec3, ndim=1),  # pyright: ignore
    ):
        for v in range(normals.shape[0]):
            out[v] = table_kernels.look_up(table, nodes, weights, frames, v, 1, normals[v])

    rng = np.random.default_rng(3)
    table = rng.random((2, 6, TILTS, TILTS, 3)).astype(np.float32)
    nodes = rng.integers(0, 6, (40, 3)).astype(np.int32)
    weights = rng.dirichlet((1, 1, 1), 40).astype(np.float32)
    frames = np.linalg.qr(rng.normal(size=(6, 3, 3)))[0].astype(np.float32)
    normals = rng.normal(size=(40, 3)).astype(np.float32)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    out = np.zeros((40, 3), dtype=np.float32)
    run(table, nodes, weights, frames, normals, out)
    return out, look_up(table[1], nodes, weights, frames, normals)


def test_look_up_equals_its_plain_twin(looked_up: Any) -> None:
    """Radiance of the kernel = radiance of the twin, for normals inside and beyond the table."""
    kernel, plain = looked_up
    # Values are up to 1 and pass three products in single precision.
    np.testing.assert_allclose(kernel, plain, atol=3e-6)


def test_a_tabulated_normal_finds_its_entry() -> None:
    """The radiance of the entry's own normal is the entry."""
    rng = np.random.default_rng(4)
    values = rng.random((1, TILTS, TILTS, 3))
    normals = tilted_normals()
    inside = np.hypot(normals[..., 0], normals[..., 1]) < TILT_SPAN - 0.01
    inside[-1], inside[:, -1] = False, False
    chosen = normals[inside]
    zeros = np.zeros((len(chosen), 3), dtype=int)
    weights = np.tile([1.0, 0.0, 0.0], (len(chosen), 1))
    found = look_up(values, zeros, weights, np.eye(3)[None], chosen)
    np.testing.assert_allclose(found, values[0][inside], atol=1e-12)


def test_collapse_equals_its_plain_twin(taichi_device: str) -> None:
    """The kernel's table = the twin's table, for glossy skin under random light."""
    from sim.optics.field.table_kernels import collapse as collapse_nodes

    rng = np.random.default_rng(5)
    count = len(bin_directions())
    received = rng.random((2, 3, count)).astype(np.float32)
    views = np.array([[0.0, 0.6, 0.8], [0.96, 0.0, 0.28]], dtype=np.float32)
    values = np.zeros((2, TILTS, TILTS, 3), dtype=np.float32)
    directions = bin_directions().astype(np.float32)
    coating = Coating(albedo=0.6, specular=0.04, roughness=0.35)
    collapse_nodes(received, directions, views, 0.6, 0.04, 0.35, values)
    # 384 products of single precision, summed.
    np.testing.assert_allclose(values, collapse(received, views, coating), rtol=2e-4)


def test_even_light_makes_a_matte_skin_as_bright_as_its_albedo() -> None:
    """Under radiance 1 from the hemisphere a matte skin of albedo 0.5 has radiance 0.5."""
    matte = Coating(albedo=0.5, specular=0.0)
    fine = (np.arange(100_000) + 0.5) / 100_000
    low, share = bin_shares(fine)
    rows = np.bincount(low, 1.0 - share, len(SINES) - 1)
    rows += np.bincount(np.minimum(low + 1, len(SINES) - 2), share, len(SINES) - 1)
    even = np.tile(np.repeat(rows / 100_000, AZIMUTHS) * 2.0 * np.pi / AZIMUTHS, (1, 3, 1))
    assert even[0, 0].sum() == pytest.approx(2.0 * np.pi)
    flat = collapse(filled(even, even, matte), np.array([[0.0, 0.0, 1.0]]), matte)
    # Light below the lowest cosine, 0.01, stands there: 0.5 * 0.01^2 of the whole too much.
    middle = (TILTS - 1) // 2
    np.testing.assert_allclose(flat[0, middle, middle], 0.5, rtol=2e-4)


def test_below_the_horizon_lies_skin_that_receives_the_same() -> None:
    """The horizon's total is 2 pi R E0 / pi with R = albedo where nothing is glossy."""
    matte = Coating(albedo=0.5, specular=0.0)
    assert mean_reflectance(matte) == pytest.approx(0.5)
    light = np.zeros((1, 3, BINS))
    light[0, 0, -1] = 2.0
    below = filled(light, light, matte)[0, :, BINS:].sum(axis=1)
    np.testing.assert_allclose(below, [2.0 * np.pi * 0.5 * 2.0 / np.pi, 0.0, 0.0], rtol=1e-6)


def test_light_is_summed_with_a_lobe_without_the_width_of_bins() -> None:
    """Even light times a lobe quadratic in the cosine: the exact integral.

    Sums over bins as they are gathered err by h^2 f'' / 12, sharpened ones only at the two ends.
    """
    centres = bin_cosines()
    fine = np.linspace(centres[1], centres[-2], 200_001)
    low, share = bin_shares(fine)
    rows = np.bincount(low, 1.0 - share, len(centres))
    rows += np.bincount(low + 1, share, len(centres))
    light = np.zeros((1, 3, len(centres), AZIMUTHS))
    light[:] = (rows / len(fine))[:, None] / AZIMUTHS
    lobe = np.repeat(centres**2, AZIMUTHS)
    light, exact = light.reshape(1, 3, -1), np.mean(fine**2)
    blurred, clear = light[0, 0] @ lobe, sharpened(light)[0, 0] @ lobe
    assert abs(clear / exact - 1.0) < 0.1 * abs(blurred / exact - 1.0)


def test_sharpening_keeps_all_light_and_narrows_a_beam() -> None:
    """The sum stays; a beam between two bins returns the peak of a narrow lobe, not less."""
    rng = np.random.default_rng(3)
    light = rng.random((2, 3, BINS))
    np.testing.assert_allclose(sharpened(light).sum(axis=2), light.sum(axis=2), rtol=1e-6)
    beam = np.zeros((1, 3, BINS))
    row = 6 * AZIMUTHS
    beam[..., row + 3 : row + 5] = 0.5
    turn = 2.0 * np.pi * (np.arange(AZIMUTHS) - 3.5) / AZIMUTHS
    width = 0.5
    lobe = np.tile(np.exp(-0.5 * (np.angle(np.exp(1j * turn)) / width) ** 2), len(SINES) - 1)
    blurred, clear = (beam[0, 0] * lobe).sum(), (sharpened(beam)[0, 0] * lobe).sum()
    assert blurred < clear
