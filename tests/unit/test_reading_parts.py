"""The parts of a reader: tilts, evidence, deviations, change."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.sparse import csc_matrix, csr_matrix, eye

from sim.optics.maps.signal import tangents
from sim.optics.raster.gbuffer import sum_area_vectors
from sim.reading.banded import Banded
from sim.reading.changed import change
from sim.reading.deviation import UNKNOWN, Linear, deviations_mm
from sim.reading.noise import LEAST_GREY
from sim.reading.patch import Patch
from sim.reading.pixels import Slopes, gathered, gathered_plainly, jacobian, on_tilts
from sim.reading.rest_skin import RestSkin, bending, neighbours, normals_of
from sim.reading.tilt_light import SPAN, STEPS, TiltLight


def dome(count: int = 9) -> RestSkin:
    """A curved skin of count x count vertices, 1 mm apart, seen from below."""
    line = np.arange(count, dtype=np.float64)
    x, y = (grid.ravel() for grid in np.meshgrid(line, line))
    middle = (count - 1) / 2
    z = -0.03 * ((x - middle) ** 2 + 0.5 * (y - middle) ** 2)
    points_mm = np.stack([x, y, z], axis=1)
    corner = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    faces = np.concatenate(
        [
            np.stack([corner, corner + 1, corner + count], axis=1),
            np.stack([corner + 1, corner + count + 1, corner + count], axis=1),
        ]
    )
    area_mm2 = sum_area_vectors(points_mm, faces, len(points_mm))
    inward = -area_mm2 / np.linalg.norm(area_mm2, axis=1, keepdims=True)
    one, two = tangents(inward)
    return RestSkin(
        points_mm=points_mm,
        faces=faces,
        inward=inward,
        one=one,
        two=two,
        area_mm2=-area_mm2,
        side=np.full(len(points_mm), -1.0),
    )


@pytest.fixture
def patch() -> tuple[RestSkin, Patch]:
    """The inner vertices of the dome."""
    skin = dome()
    free = np.zeros(skin.count, dtype=bool)
    places = skin.points_mm[:, :2]
    free |= ((places > 1.5) & (places < 6.5)).all(axis=1)
    return skin, Patch(skin, free)


def test_a_patch_at_rest_is_not_tilted(patch: tuple[RestSkin, Patch]) -> None:
    """Whatever its curvature."""
    _, part = patch
    posed = part.posed(np.zeros(part.free))
    np.testing.assert_allclose(posed.tilts, 0.0, atol=1e-12)


def test_tilts_are_those_of_the_whole_skin(patch: tuple[RestSkin, Patch]) -> None:
    """The normals of a patch are the renderer's of all vertices, also around it."""
    skin, part = patch
    moves = np.random.default_rng(1).uniform(0.0, 0.3, part.free)
    inward_mm = np.zeros(skin.count)
    inward_mm[part.vertices[: part.free]] = moves
    whole = normals_of(skin, inward_mm[:, None] * skin.inward)
    posed = part.posed(moves)
    np.testing.assert_allclose(posed.normals, whole[part.vertices], atol=1e-12)
    across = np.einsum("vc,vc->v", posed.normals, skin.one[part.vertices])
    np.testing.assert_allclose(posed.tilts[:, 0], across, atol=1e-12)


def test_slopes_of_tilts_are_their_differences(patch: tuple[RestSkin, Patch]) -> None:
    """By central differences of every move."""
    _, part = patch
    moves = np.random.default_rng(2).uniform(0.0, 0.3, part.free)
    found = part.tilt_slopes(part.posed(moves)).toarray()
    step = 1e-6
    expected = np.empty_like(found)
    for number in range(part.free):
        way = step * (np.arange(part.free) == number)
        ahead, behind = (part.posed(moves + sign * way).tilts for sign in (1.0, -1.0))
        expected[:, number] = ((ahead - behind) / (2.0 * step)).ravel()
    np.testing.assert_allclose(found, expected, atol=1e-7)


def some_slopes(random: np.random.Generator) -> Slopes:
    """Of forty blocks on two of three triangles; a few see none."""
    weights = random.uniform(0.0, 1.0, (40, 3))
    return Slopes(
        faces=np.array([[0, 1, 2], [1, 3, 2], [2, 3, 4]]),
        triangles=random.integers(-1, 2, 40),
        corner_weights=weights / weights.sum(axis=1, keepdims=True),
        grey=random.uniform(50.0, 200.0, (40, 3)),
        light=random.normal(size=(5, 3, 2)),
    )


@pytest.mark.usefixtures("taichi_device")
def test_evidence_on_the_device_is_that_of_its_plain_twin() -> None:
    """Products and pulls of all triangles, also of the one that no block sees."""
    random = np.random.default_rng(3)
    slopes = some_slopes(random)
    residual, weight = random.normal(size=(40, 3)), random.uniform(0.1, 1.0, (40, 3))
    found, expected = (each(slopes, residual, weight) for each in (gathered, gathered_plainly))
    np.testing.assert_allclose(found.products, expected.products, rtol=1e-10, atol=1e-9)
    np.testing.assert_allclose(found.pulls, expected.pulls, rtol=1e-10, atol=1e-9)
    assert not found.products[2].any()


def test_evidence_of_triangles_is_that_of_pixels() -> None:
    """Summed over triangles and then on tilts, or at once as dense matrices."""
    random = np.random.default_rng(3)
    slopes = some_slopes(random)
    residual, weight = random.normal(size=(40, 3)), random.uniform(0.1, 1.0, (40, 3))
    matrix, pull = on_tilts(slopes.faces, 5, gathered_plainly(slopes, residual, weight))
    dense = np.zeros((120, 10))
    for block, triangle in enumerate(slopes.triangles):
        for corner, vertex in enumerate(slopes.faces[triangle] if triangle >= 0 else []):
            share = slopes.corner_weights[block, corner] * slopes.grey[block][:, None]
            dense[3 * block : 3 * block + 3, 2 * vertex : 2 * vertex + 2] += (
                share * slopes.light[vertex]
            )
    weighted = weight.ravel()[:, None] * dense
    np.testing.assert_allclose(matrix.toarray(), dense.T @ weighted, rtol=1e-10, atol=1e-9)
    np.testing.assert_allclose(pull, weighted.T @ residual.ravel(), rtol=1e-10, atol=1e-9)


@pytest.mark.usefixtures("taichi_device")
def test_light_by_tilt_on_the_device_is_that_of_its_plain_twin() -> None:
    """Values and slopes, also of tilts beyond the table."""
    random = np.random.default_rng(4)
    light = TiltLight(random.uniform(0.0, 1.0, (7, STEPS, STEPS, 3)).astype(np.float32))
    rows = random.integers(0, 7, 200)
    tilts = random.uniform(-1.2 * SPAN, 1.2 * SPAN, (200, 2))
    np.testing.assert_allclose(light.at(rows, tilts), light.plainly_at(rows, tilts), atol=1e-5)
    np.testing.assert_allclose(
        light.slopes(rows, tilts), light.plain_slopes(rows, tilts), atol=1e-4
    )


def test_banded_factors_solve() -> None:
    """A chain of springs with its links in any order, with and without damping."""
    random = np.random.default_rng(8)
    order = random.permutation(50)
    dense = np.zeros((50, 50))
    for one, two in itertools.pairwise(order):
        dense[[one, two], [one, two]] += 1.0
        dense[[one, two], [two, one]] -= 1.0
    dense += 0.1 * np.eye(50)
    right = random.normal(size=(50, 2))
    found = Banded(csc_matrix(dense)).solved(right)
    np.testing.assert_allclose(dense @ found, right, atol=1e-10)
    damped = dense + 0.5 * np.diag(np.diag(dense))
    found = Banded(csc_matrix(dense), damping=0.5).solved(right[:, 0])
    np.testing.assert_allclose(damped @ found, right[:, 0], atol=1e-10)


def test_bending_knows_a_paraboloid() -> None:
    """The Laplacian of .05 (x^2 + y^2) is .2 per mm inside a plane skin; of a plane it is none."""
    skin = dome()
    flat = RestSkin(
        points_mm=skin.points_mm * [1.0, 1.0, 0.0],
        faces=skin.faces,
        inward=np.tile([0.0, 0.0, -1.0], (skin.count, 1)),
        one=skin.one,
        two=skin.two,
        area_mm2=-sum_area_vectors(skin.points_mm * [1.0, 1.0, 0.0], skin.faces, skin.count),
        side=skin.side,
    )
    x, y, _ = flat.points_mm.T
    inside = (np.minimum(x, y) > 0.5) & (np.maximum(x, y) < 7.5)
    found = bending(flat)
    # Right angles count as if they were a little less.
    np.testing.assert_allclose((found @ (0.05 * (x**2 + y**2)))[inside], -0.2, rtol=0.03)
    np.testing.assert_allclose((found @ (0.3 * x - 0.1 * y))[inside], 0.0, atol=1e-12)
    assert neighbours(flat)[40].sum() == 6.0


def test_the_jacobian_of_blocks_is_that_of_their_evidence() -> None:
    """J^T W J and J^T W r of all blocks at once, or summed over triangles."""
    random = np.random.default_rng(3)
    slopes = some_slopes(random)
    residual, weight = random.normal(size=(40, 3)), random.uniform(0.1, 1.0, (40, 3))
    matrix, pull = on_tilts(slopes.faces, 5, gathered_plainly(slopes, residual, weight))
    whole = jacobian(slopes).toarray()
    weighted = weight.ravel()[:, None] * whole
    np.testing.assert_allclose(whole.T @ weighted, matrix.toarray(), rtol=1e-10, atol=1e-9)
    np.testing.assert_allclose(weighted.T @ residual.ravel(), pull, rtol=1e-10, atol=1e-9)


@pytest.mark.parametrize("error_grey", [1.0, 3.0])
def test_deviations_are_those_of_the_errors_drawn(error_grey: float) -> None:
    """Of h = M^-1 J^T W e: errors thrice as large as the weights say give thrice the deviation.

    Likewise of errors by the light, which the first draws do not touch; a prior adds its own.
    """
    random = np.random.default_rng(5)
    slopes = some_slopes(random)
    whole, weight = jacobian(slopes).toarray(), np.full((40, 3), 1.0)
    root = 5.0 * np.eye(10)
    matrix = whole.T @ whole + root.T @ root
    linear = Linear(
        factors=Banded(csc_matrix(matrix)),
        slopes=slopes,
        by_move=eye(10, format="csr"),
        weight=weight,
        root=csr_matrix(root),
    )
    noise = error_grey * random.normal(size=(40, 3, 4000))
    by_noise, by_light = deviations_mm(linear, noise, 0.5 * noise)
    inverse = np.linalg.inv(matrix)
    by_errors = error_grey**2 * np.diag(inverse @ whole.T @ whole @ inverse)
    by_prior = UNKNOWN**2 * np.diag(inverse @ root.T @ root @ inverse)
    # Of 4,000 draws a standard deviation is known to a ninetieth.
    np.testing.assert_allclose(by_noise, np.sqrt(by_errors + by_prior), rtol=0.06)
    np.testing.assert_allclose(by_light, 0.5 * np.sqrt(by_errors), rtol=0.06)


def test_change_finds_offset_noise_and_place() -> None:
    """A disc that is 12 grey brighter, in a photograph 3 grey brighter, at 2 grey of noise."""
    random = np.random.default_rng(6)
    row, column = np.mgrid[:120, :160]
    disc = np.hypot(row - 50, column - 90) < 14
    idle = np.full((120, 160, 3), 90.0)
    clean = idle + np.where(disc, 12.0, 0.0)[:, :, None] + [3.0, -2.0, 1.0]
    photo = np.round(clean + random.normal(size=clean.shape) * 2.0)
    found = change(idle, photo, np.ones((120, 160), dtype=bool))
    assert found.noise.grey == pytest.approx(2.0, rel=0.1)
    assert found.noise.shared_px < 1.5
    np.testing.assert_allclose((found.photo - idle)[~disc].mean(axis=0), 0.0, atol=0.6)
    core = np.hypot(row - 50, column - 90) < 12
    assert found.certain[core].all()
    assert not found.certain[np.hypot(row - 50, column - 90) > 20].any()
    assert found.near[np.hypot(row - 50, column - 90) < 19].all()


def test_an_untouched_photograph_has_not_changed() -> None:
    """Nor has its noise, of whole grey levels."""
    idle = np.full((60, 80, 3), 90.0)
    found = change(idle, idle, np.ones((60, 80), dtype=bool))
    assert not found.certain.any()
    assert found.noise.grey == LEAST_GREY
