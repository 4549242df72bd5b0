"""What is hidden in a twin: within its bounds, from streams of its own, the same by its seed."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from workbench.core.design.design import Elastomer, SensorDesign
from workbench.core.design.optics import Optics
from workbench.learning.dataset.looks import built
from workbench.learning.dataset.variation import Looks
from workbench.project.named_designs import load_design
from workbench.twin.draw import LAYER_MM, Draws, card, draw_twin, stream
from workbench.twin.printed_ball import layer_shares, printed_ball

SEEDS = range(200)


@pytest.fixture(scope="module")
def pad() -> SensorDesign:
    return load_design("pad")


def test_hidden_values_fill_their_ranges_and_leave_none(pad: SensorDesign) -> None:
    """Of 200 twins each value comes within a tenth of both ends of its range, and never beyond."""
    twins = [draw_twin(pad, seed) for seed in SEEDS]
    young = np.array([each.design.material.young_MPa for each in twins]) / 0.145 - 1.0
    wall = np.array([each.design.layers.elastomer_mm for each in twins]) - 4.0
    rubs = np.array([each.design.material.friction for each in twins]) - 0.3
    ball = np.array([each.ball_error_mm for each in twins])
    albedo = np.log(np.array([each.design.optics.coating.albedo for each in twins]) / 0.1)
    for values, most in (
        (young, 0.2),
        (wall, 0.15),
        (rubs, 0.2),
        (ball, 0.05),
        (albedo, np.log(1.3)),
    ):
        assert np.abs(values).max() <= most + 1e-5
        assert values.min() < -0.9 * most
        assert values.max() > 0.9 * most
    places = np.array([each.design.optics.camera.position_mm for each in twins])
    assert np.abs(places[:, :2]).max() <= 0.5


def test_friction_and_kinetic_friction_stay_physical(pad: SensorDesign) -> None:
    """At least .05, and what slides rubs no harder than what sticks."""
    slippery = dataclasses.replace(pad, material=Elastomer(friction=0.1, kinetic_friction=0.1))
    for seed in SEEDS:
        material = draw_twin(slippery, seed).design.material
        assert material.friction >= 0.05
        assert material.sliding_friction <= material.friction


def test_a_seed_is_a_twin(pad: SensorDesign) -> None:
    """Equal seeds are equal, others are not, and what is drawn beside it moves nothing."""
    assert draw_twin(pad, 3) == draw_twin(pad, 3)
    assert draw_twin(pad, 3) != draw_twin(pad, 4)
    assert card(draw_twin(pad, 3), pad)["young_MPa"] != card(draw_twin(pad, 4), pad)["young_MPa"]


def test_no_training_seed_draws_what_a_twin_draws() -> None:
    """A spawn key stands behind the padded seed: no three numbers make the same words.

    Even a data set whose seed and number are the twin's seed and stream draws another sensor.
    """
    own = stream(5, Draws.SENSOR).bit_generator.seed_seq
    assert isinstance(own, np.random.SeedSequence)
    assert own.spawn_key
    words = own.generate_state(4).tolist()
    for number in (*range(100), 0x7717):
        for last in (0, 1, 2, 0x7717):
            other = np.random.SeedSequence((5, number, last)).generate_state(4).tolist()
            assert words != other
    twin = draw_twin(load_design("pad"), 5).design.optics.ring
    optics: Optics = load_design("pad").optics
    assert all(built(optics, Looks(), seed=5, number=number).ring != twin for number in range(100))


def test_streams_of_one_twin_differ() -> None:
    """Presses and photons of equal numbers have nothing in common."""
    drawn = {float(stream(1, draws, number).random()) for draws in Draws for number in range(20)}
    assert len(drawn) == 20 * len(Draws)


def test_layers_are_terraces_as_high_as_a_layer() -> None:
    """The first has the radius sqrt(R a), and each stands where its middle meets the ball."""
    across = np.linspace(0.0, 2.6, 5_001)
    share = layer_shares(across, 3.0, LAYER_MM)
    smooth_mm = 3.0 - np.sqrt(9.0 - across**2)
    printed_mm = smooth_mm - LAYER_MM * (share - 0.5)
    layers = printed_mm / LAYER_MM
    np.testing.assert_allclose(layers, np.round(layers), atol=1e-6)
    assert np.abs(printed_mm - smooth_mm).max() == pytest.approx(0.5 * LAYER_MM, abs=1e-4)
    first = across[np.flatnonzero(layers > 0.5)[0]]
    assert first == pytest.approx(np.sqrt(3.0 * LAYER_MM), rel=0.02)
    assert layer_shares(np.array([2.8, 3.5]), 3.0, LAYER_MM).tolist() == [0.5, 0.5]


def test_solvers_feel_the_first_terrace_of_a_printed_ball() -> None:
    """The sampled distance of the ball is flatter at the pole than the ball, and as deep."""
    from sim.contact.objects.textures import heights

    ball = printed_ball(6.0, LAYER_MM)
    felt = heights(ball.texture, 0.1)
    across = np.array([[0.0, 0.0], [0.3, 0.0], [0.54, 0.0], [1.8, 0.9]])
    relief_mm = felt(across)
    smooth_mm = 3.0 - np.sqrt(9.0 - (across**2).sum(axis=1))
    height_mm = smooth_mm - relief_mm
    # From pole to .3 mm the ball falls by .015 mm, the terrace by less than half of that.
    assert height_mm[1] - height_mm[0] < 0.5 * smooth_mm[1]
    assert relief_mm[3] == pytest.approx(0.5 * LAYER_MM, abs=0.01)
    assert printed_ball(6.0, 0.0).texture.raised is False
