"""Gauss-Newton of a calibration, what is known after it, and Young's modulus: closed forms."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from sim.optics.proof.specimen import finger
from workbench.calibration.ball_presses import BallPress
from workbench.calibration.derivatives import Fit
from workbench.calibration.determined import directions, parameters
from workbench.calibration.elasticity import LEAST_SCATTER, fitted_young
from workbench.calibration.gauss_newton import (
    Rows,
    alike_samples,
    normal_equations,
    robust_shares,
)
from workbench.calibration.light_basis import LightBasis, PressSamples
from workbench.calibration.light_sources import single_lights
from workbench.calibration.photo_rows import (
    Image,
    Slopes,
    Whitening,
    active_powers,
    image_rows,
    misfit,
    residuals,
    whitening,
)
from workbench.calibration.powers import Powers
from workbench.calibration.refine import Refined
from workbench.calibration.seen.photo_set import BallPhoto, Circle
from workbench.calibration.seen.seen_places import ContactPlace
from workbench.calibration.unknowns import Kind, Scene, Unknown, moved_scene, unknowns
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import Lamp, LedRing
from workbench.core.design.optics import Coating, Optics
from workbench.core.result.results import MembraneMesh

CIRCLE = Circle(column_px=10.0, row_px=10.0, radius_px=5.0)


def test_one_step_solves_a_linear_problem_with_its_prior() -> None:
    """Two measurements 3 and 5 of x with deviations 1, prior 0 +- 1: mean 8/3, variance 1/3."""
    rows = [
        Rows(residual=np.array([-measured]), slope=np.ones((1, 1)), value=np.array([0]))
        for measured in (3.0, 5.0)
    ]
    normal = normal_equations(rows, np.zeros(1), np.ones(1))
    assert normal.step() == pytest.approx([8.0 / 3.0])
    assert normal.covariance() == pytest.approx(np.array([[1.0 / 3.0]]))


def test_a_step_from_elsewhere_ends_at_the_same_place() -> None:
    """The prior pulls toward 0, not toward where the step began."""
    slope = np.array([[1.0, 2.0], [0.5, -1.0], [3.0, 0.1]])
    measured, prior_sd = np.array([1.0, -2.0, 0.7]), np.array([0.5, 2.0])
    ends = []
    for start in (np.zeros(2), np.array([4.0, -3.0])):
        rows = [Rows(residual=slope @ start - measured, slope=slope, value=np.arange(2))]
        ends.append(start + normal_equations(rows, start, prior_sd).step())
    exact = np.linalg.solve(slope.T @ slope + np.diag(prior_sd**-2.0), slope.T @ measured)
    assert ends[0] == pytest.approx(exact) and ends[1] == pytest.approx(exact)


def test_a_value_that_nothing_tells_keeps_its_prior() -> None:
    """Rows of another value leave variance and place alone; without a prior it stays too."""
    rows = [Rows(residual=np.array([2.0]), slope=np.ones((1, 1)), value=np.array([0]))]
    normal = normal_equations(rows, np.zeros(3), np.array([np.inf, 0.4, np.inf]))
    assert normal.step()[1:] == pytest.approx([0.0, 0.0])
    assert np.sqrt(normal.covariance()[1, 1]) == pytest.approx(0.4)
    assert normal.covariance()[2, 2] > 1e6


def test_alike_samples_of_noise_and_of_patches() -> None:
    """White noise: 1. Noise that is even over patches of 4 x 4: 16, less what slow waves lose."""
    noise = np.random.default_rng(2).normal(size=(16, 64, 64))
    grid = 64, 64
    white = alike_samples([(each.reshape(-1, 1), grid) for each in noise])
    # Falling makes the slow waves' variance that of the largest band.
    assert white == pytest.approx(1.0, abs=0.1)
    patches = np.kron(noise[:, :16, :16], np.ones((4, 4)))
    found = alike_samples([(each.reshape(-1, 1), grid) for each in patches])
    assert found == pytest.approx(16.0, rel=0.15)
    assert alike_samples([(np.zeros((64, 3)), (8, 8))]) == 1.0


def test_residuals_that_stand_out_count_less() -> None:
    """Of normal ones 1.2 % lie beyond 2.5 deviations; one of 25 deviations a ten thousandth."""
    values = np.random.default_rng(6).normal(size=20_000)
    values[0] = 25.0
    shares = robust_shares(values)
    assert shares[0] == pytest.approx(1e-4, rel=0.1)
    assert (shares < 1.0).mean() == pytest.approx(0.0124, abs=0.003)
    assert (robust_shares(np.zeros(5)) == 1.0).all()


def test_many_photographs_of_one_error_count_as_one() -> None:
    """Presses with the same residual: four of them weigh as much as one alone."""
    random = np.random.default_rng(8)
    left = random.normal(size=(100, 3))
    image = Image(light=left, weight=np.ones((100, 3)), grid=(10, 10), step_px=1)
    told = []
    for count in (1, 4):
        all_left = [left] * (1 + count)
        over = whitening([image] * (1 + count), all_left)
        told.append(misfit([image] * (1 + count), all_left, dataclasses.replace(over, rest=1e9)))
    assert told[0] == pytest.approx(told[1])


def basis_of(random: np.random.Generator) -> LightBasis:
    """Two lights, an image at rest of 4 x 6, a press of 5 x 5 in three depths."""
    shape = random.normal(size=(3, 25, 2))
    return LightBasis(
        lights=(Lamp(), Lamp()),
        rest_pixel=np.arange(24),
        rest=random.uniform(0.5, 1.0, (24, 2)),
        ambient=np.ones(24),
        presses=(
            PressSamples(pixel=np.arange(25), depths_mm=np.array([0.2, 0.6, 1.0]), change=shape),
        ),
    )


def test_rows_are_the_derivatives_of_the_residuals() -> None:
    """They give half the gradient of the misfit, which central differences give too."""
    random = np.random.default_rng(5)
    basis = basis_of(random)
    images = tuple(
        Image(
            light=random.normal(size=(count, 3)),
            weight=random.uniform(1.0, 2.0, (count, 3)),
            grid=grid,
            step_px=1,
        )
        for count, grid in ((24, (4, 6)), (25, (5, 5)))
    )
    powers = Powers(
        lights=np.array([[1.0, 0.5], [0.0, 0.7], [0.3, 0.2]]),
        ambient=np.array([0.1, 0.0, 0.2]),
        depths_mm=np.array([0.5]),
        error_grey=0.0,
        null_grey=0.0,
    )
    given = Slopes(
        rest=random.normal(size=(24, 3)),
        presses=(random.normal(size=(25, 3)),),
        places_mm=np.zeros((1, 3)),
    )
    shares = tuple(random.uniform(0.1, 1.0, each.light.shape) for each in images)
    over = Whitening(rest=2.0, press=4.0, shares=shares)
    active = active_powers(powers)
    count = 4 + len(active)
    rows = image_rows(images, (basis, powers), [given], over)
    product = normal_equations(rows, np.zeros(count), np.full(count, np.inf)).product

    def half(lights: np.ndarray, ambient: np.ndarray, depth: float) -> float:
        moved = dataclasses.replace(
            powers, lights=lights, ambient=ambient, depths_mm=np.array([depth])
        )
        return 0.5 * misfit(images, residuals(images, basis, moved), over)

    step = 1e-3
    for number, (colour, light) in enumerate(active):
        ends = []
        for sign in (1.0, -1.0):
            whole = np.column_stack([powers.lights, powers.ambient])
            whole[colour, light] += sign * step
            ends.append(half(whole[:, :2], whole[:, 2], 0.5))
        assert product[4 + number] == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-5)
    deeper, less = (half(powers.lights, powers.ambient, 0.5 + s * step) for s in (1.0, -1.0))
    # Between depths light is interpolated in single precision.
    assert product[1] == pytest.approx((deeper - less) / (2 * step), rel=1e-3)
    slopes = [given.rest, *given.presses]
    ends = []
    for sign in (1.0, -1.0):
        moved = [
            left + sign * step * slope * image.weight
            for image, left, slope in zip(
                images, residuals(images, basis, powers), slopes, strict=True
            )
        ]
        ends.append(0.5 * misfit(images, moved, over))
    assert product[0] == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-6)


def unknown(name: str, prior_sd: float) -> Unknown:
    return Unknown(
        name=name, unit="mm", kind=Kind.LED_PLACE, prior_sd=prior_sd, step=0.1, wanted=0.1
    )


def refined(covariance: np.ndarray) -> Refined:
    """Two unknowns of prior .4 mm and two lights of power 1 and 3 in one colour."""
    powers = Powers(
        lights=np.array([[1.0, 3.0], [0.0, 0.0], [0.0, 0.0]]),
        ambient=np.zeros(3),
        depths_mm=np.zeros(0),
        error_grey=0.0,
        null_grey=0.0,
    )
    scene = Scene(camera=Camera(), coating=Coating(), lights=(Lamp(), Lamp()))
    fit = Fit(
        values=np.array([0.1, -0.2]),
        scene=scene,
        circles=(),
        basis=basis_of(np.random.default_rng(1)),
        powers=powers,
    )
    among = (unknown("a", 0.4), unknown("b", 0.4))
    active = active_powers(powers)
    return Refined(fit=fit, among=among, covariance=covariance, active=active, steps=1)


def test_what_only_a_sum_tells_trades() -> None:
    """a + b seen to .01, each known before to .4: each alone to .4 / sqrt(2), correlation -1."""
    prior, seen = 0.4, 0.01
    information = np.eye(2) / prior**2 + np.ones((2, 2)) / seen**2
    covariance = np.zeros((4, 4))
    covariance[:2, :2] = np.linalg.inv(information)
    covariance[2:, 2:] = np.diag([0.01**2, 0.01**2])
    a, b, one, other = parameters(refined(covariance))
    assert a.sd == pytest.approx(prior / np.sqrt(2.0), rel=1e-3)
    assert not a.determined and "trades with b" in a.words
    assert not b.determined and "trades with a" in b.words
    # Powers 1 and 3 over their mean 2: d(p / mean) = dp / 2 - p / 8 (dp + dq).
    assert (one.value, other.value) == pytest.approx((0.5, 1.5))
    assert one.sd == pytest.approx(0.01 * np.hypot(3 / 8, 1 / 8)) and one.determined
    best, worst = directions(refined(covariance))
    # The sum over priors (a + b) / .4 / sqrt(2) has slope .4 sqrt(2) / .01; the difference none.
    assert best.singular_value == pytest.approx(prior * np.sqrt(2.0) / seen, rel=1e-3)
    assert worst.singular_value == pytest.approx(0.0, abs=1e-3)
    assert [name for name, _ in best.parts] in (["a", "b"], ["b", "a"])


def test_what_photographs_do_not_see_is_known_no_better_than_before() -> None:
    """The words say so."""
    a = parameters(refined(np.diag([0.39**2, 0.01**2, 1e-4, 1e-4])))[0]
    assert a.words == "known to 0.39 mm, no better than before"


@pytest.fixture(scope="module")
def mesh() -> MembraneMesh:
    return finger(edge_mm=0.8)


def scene_of() -> Scene:
    optics = Optics(ring=LedRing(count=3, radius_mm=9.0, height_mm=0.5))
    lights = tuple(single_lights(optics))
    return Scene(camera=optics.camera, coating=optics.coating, lights=lights)


def test_each_unknown_moves_what_it_names(mesh: MembraneMesh) -> None:
    """Values add up: camera, turn, LED along its own directions, lobe, coating as a factor."""
    scene = scene_of()
    among = unknowns(scene, known=True)
    names = [each.name for each in among]
    assert len(names) == 11 + 9 == len(set(names))
    values = np.zeros(len(among))
    for name, value in {
        "camera in height": 0.3,
        "camera turned about z": 2.0,
        "lobe of the lights": 0.5,
        "log of the roughness": np.log(1.5),
        "log of gloss over albedo": np.log(0.5),
        "light 2 outward": -0.3,
    }.items():
        values[names.index(name)] = value
    moved, got = moved_scene(scene, among, values, mesh)
    assert got == pytest.approx(values)
    assert moved.camera.position_mm == pytest.approx((0.0, 0.0, 0.6))
    half = np.radians(1.0)
    assert moved.camera.wxyz == pytest.approx((np.cos(half), 0.0, 0.0, np.sin(half)))
    assert moved.coating.roughness == pytest.approx(1.5 * scene.coating.roughness)
    assert moved.coating.specular == pytest.approx(0.5 * scene.coating.specular)
    assert [each.emission_exponent for each in moved.lights] == [1.5, 1.5, 1.5]
    radii = [np.hypot(*each.position_mm[:2]) for each in moved.lights]
    assert radii == pytest.approx([9.0, 8.7, 9.0])


def test_a_light_goes_as_far_as_there_is_room(mesh: MembraneMesh) -> None:
    """8 mm outward leave the cavity of a finger of radius 15 with 3 mm of walls; 2 mm do not."""
    scene = scene_of()
    among = unknowns(scene, known=True)
    outward = [each.name for each in among].index("light 1 outward")
    values = np.zeros(len(among))
    values[outward] = 8.0
    moved, got = moved_scene(scene, among, values, mesh)
    assert got[outward] == 2.0
    assert np.hypot(*moved.lights[0].position_mm[:2]) == pytest.approx(11.0)


def test_candidates_keep_their_places() -> None:
    """Of unknown lights only what they share is fitted."""
    kinds = {each.kind for each in unknowns(scene_of(), known=False)}
    assert Kind.LED_PLACE not in kinds and Kind.LOBE in kinds


def press(force_N: float | None, stiff: float) -> BallPress:
    """A press whose force is `stiff` times the depth [N]."""
    photo = BallPhoto(
        name="p.png",
        image=np.zeros((4, 4, 3), np.uint8),
        ball_mm=6.0,
        circle=CIRCLE,
        place_mm=None,
        depth_mm=None,
        force_N=force_N,
        held_out=False,
    )
    place = ContactPlace(point_mm=np.zeros(3), normal=np.array([0.0, 0.0, 1.0]), radius_mm=1.0)
    return BallPress(
        photo=photo,
        place=place,
        least_mm=0.1,
        most_mm=2.0,
        guess_mm=1.0,
        depths_mm=np.array([0.0, 1.0, 2.0]),
        displacement_mm=np.zeros((3, 2, 3), np.float32),
        normal_N=stiff * np.array([0.0, 1.0, 2.0]),
    )


def test_young_is_in_proportion_to_the_force() -> None:
    """Forces 1.5 times the solver's: 1.5 times the modulus; depths to 2 % add 2 % of it."""
    presses = [press(1.5 * 2.0 * 1.0, 2.0), press(1.5 * 2.0 * 0.5, 2.0), press(None, 2.0)]
    depths = np.array([1.0, 0.5, 0.7])
    none = np.zeros((3, 3))
    found = fitted_young(0.2, presses, depths, none)
    assert found is not None and found.presses == 2
    assert found.young_MPa == pytest.approx(0.3)
    assert found.sd_MPa == pytest.approx(0.3 * LEAST_SCATTER / np.sqrt(2.0))
    # d ln f / d depth is 1 / depth; depths that err together by 2 % of themselves.
    together = np.outer(0.02 * depths, 0.02 * depths)
    wider = fitted_young(0.2, presses, depths, together)
    assert wider is not None
    exact = 0.3 * np.sqrt(LEAST_SCATTER**2 / 2.0 + 0.02**2)
    assert wider.sd_MPa == pytest.approx(exact, rel=1e-3)


def test_young_scatters_as_its_presses_do() -> None:
    """Forces e^.2 and e^-.2 times the solver's: the modulus stays, its deviation is .2."""
    presses = [press(float(np.exp(power)), 1.0) for power in (0.2, -0.2)]
    found = fitted_young(1.0, presses, np.ones(2), np.zeros((2, 2)))
    assert found is not None
    assert found.young_MPa == pytest.approx(1.0) and found.sd_MPa == pytest.approx(0.2)


def test_without_a_force_there_is_no_young() -> None:
    """None."""
    assert fitted_young(1.0, [press(None, 1.0)], np.ones(1), np.zeros((1, 1))) is None
