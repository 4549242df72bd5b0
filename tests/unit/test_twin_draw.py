"""What is hidden in a twin: within its bounds, from streams of its own, the same by its seed."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from geometry.surface.surface import mesh_volume, open_edges
from workbench.core.design.design import Elastomer, SensorDesign
from workbench.core.design.optics import Optics
from workbench.learning.dataset.looks import built
from workbench.learning.dataset.variation import Looks
from workbench.project.named_designs import load_design
from workbench.twin.draw import LAYER_MM, Draws, card, draw_twin, stream
from workbench.twin.printed_ball import layer_relief_mm, printed_ball

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


def test_a_printed_ball_is_a_closed_body_of_the_hidden_size() -> None:
    """Within .1 % of 4/3 pi r^3: layers take away as much as they add."""
    ball = printed_ball(6.03, LAYER_MM)
    assert ball.mesh is not None
    assert open_edges(ball.mesh.faces) == 0
    volume = mesh_volume(ball.mesh.points_mm, ball.mesh.faces)
    assert volume == pytest.approx(np.pi * 6.03**3 / 6.0, rel=3e-3)
    assert ball.size_mm == pytest.approx(6.03, abs=0.02)


def test_layers_are_terraces_at_the_pole_and_fade_where_no_solver_sees_them() -> None:
    """a / 2 pi high where the ball is flat; none beyond 30 degrees, where waves are .2 mm."""
    polar = np.linspace(0.0, np.pi, 20_001)
    relief = layer_relief_mm(polar, 3.0, LAYER_MM)
    flat = polar < np.arcsin(0.25)
    assert np.abs(relief[flat]).max() == pytest.approx(LAYER_MM / (2.0 * np.pi), rel=1e-3)
    assert not relief[np.sin(polar) > 0.5].any()
    assert not relief[polar > 0.5 * np.pi].any()
    # A terrace: height over the pole stands still at each layer and rises twice as fast between.
    ball_mm = 3.0 * (1.0 - np.cos(polar))
    rises = np.diff(ball_mm - relief * np.cos(polar))[10:] / np.diff(ball_mm)[10:]
    rises = rises[flat[11:]]
    assert rises.min() == pytest.approx(0.0, abs=0.05)
    assert rises.max() == pytest.approx(2.0, abs=0.05)
