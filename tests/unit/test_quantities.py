"""What is shown of a press: exact values on a made-up frame, and never a number that is none."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from ui.panels.results.forces import tangential_force_N
from workbench.core.press.motion import release, slide
from workbench.core.press.press import Press
from workbench.core.press.trajectory import Trajectory
from workbench.core.result.results import Skin
from workbench.core.result.sensing import Contact
from workbench.edit.path_template import template_csv
from workbench.view.forces import slip_curve
from workbench.view.frame_words import number, phase
from workbench.view.quantities import (
    LONGEST_ARROW_MM,
    Quantity,
    force_arrows,
    largest_arrow_N,
    shown,
    vertex_areas_mm2,
)

SQUARE = Skin(
    points_mm=np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], np.float32),
    faces=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    normals=np.tile(np.array([0, 0, 1], np.float32), (4, 1)),
)
"""A square of 4 mm2: its corners own 4/3, 2/3, 4/3 and 2/3 mm2."""


def contact(**changes: np.ndarray) -> Contact:
    """One frame: vertex 1 is pressed by 0.3 N and sheared by 0.4 N."""
    forces = np.zeros((1, 4, 3), np.float32)
    forces[0, 1] = [0.4, 0.0, -0.3]
    pressure = np.zeros((1, 4), np.float32)
    pressure[0, 1] = 0.3 / (2.0 / 3.0)
    made = Contact(
        displacement_mm=np.full((1, 4, 3), [0.0, 0.0, -0.5], np.float32),
        reaction_N=np.array([[-0.4, 0.0, 0.3]]),
        moment_Nmm=np.zeros((1, 3)),
        indenter_pose=np.array([[0.0, 0.0, 3.0, 1.0, 0.0, 0.0, 0.0]]),
        residual=np.zeros(1),
        penetration_mm=np.zeros(1),
        support_N=np.zeros((1, 3)),
        cut_N=np.zeros((1, 3)),
        friction_ratio=np.zeros(1),
        sliding=np.array([[False, True, False, False]]),
        sliding_share=np.ones(1),
        target_mm=np.zeros(3),
        normal=np.array([0.0, 0.0, 1.0]),
        tangent_u=np.array([1.0, 0.0, 0.0]),
        grid_mm=0.5,
        active_radius_mm=9.0,
        particles=8,
        substeps=5,
        device="cpu",
        contact_force_N=forces,
        pressure_MPa=pressure,
        tangential_N=np.array([0.4]),
        pressing_N=np.array([0.3]),
    )
    return dataclasses.replace(made, **changes)


def test_areas_of_the_corners_add_up_to_the_square() -> None:
    """4/3 + 2/3 + 4/3 + 2/3 = 4 mm2."""
    np.testing.assert_allclose(vertex_areas_mm2(SQUARE), [4 / 3, 2 / 3, 4 / 3, 2 / 3])


def test_shear_traction_is_the_tangential_force_over_the_area() -> None:
    """0.4 N on 2/3 mm2 is 600 kPa; the pressure beside it is 450 kPa."""
    assert shown(SQUARE, contact(), Quantity.SHEAR).values[0, 1] == pytest.approx(600.0, rel=1e-5)
    assert shown(SQUARE, contact(), Quantity.PRESSURE).top == pytest.approx(450.0)


@pytest.mark.parametrize("quantity", list(Quantity))
def test_old_and_broken_results_show_finite_values(quantity: Quantity) -> None:
    """A result without fields, and one with NaN, give finite values of the right shape."""
    without = contact(contact_force_N=np.zeros((0, 0, 3)), pressure_MPa=np.zeros((0, 0)))
    broken = contact(pressure_MPa=np.full((1, 4), np.nan), energy_MPa=np.full((1, 4), np.inf))
    for result in (without, broken):
        found = shown(SQUARE, result, quantity)
        assert found.values.shape == (1, 4)
        assert np.isfinite(found.values).all()
        assert np.isfinite(found.shares).all()


def test_the_largest_force_has_the_longest_arrow_and_ends_on_the_skin() -> None:
    """One force of 0.5 N: one arrow of 6 mm along it that ends at the moved vertex."""
    top_N = largest_arrow_N(SQUARE, contact())
    assert top_N == pytest.approx(0.5)
    (arrow,) = force_arrows(SQUARE, contact(), 0, top_N=top_N)
    np.testing.assert_allclose(arrow[1], [2.0, 0.0, -0.5], atol=1e-6)
    way = arrow[1] - arrow[0]
    np.testing.assert_allclose(way, LONGEST_ARROW_MM * np.array([0.8, 0.0, -0.6]), atol=1e-5)


def test_slip_curve_of_a_sliding_point() -> None:
    """Tangential over normal is 4/3, and all that touches slides; nothing touching gives 0."""
    ratio, share = slip_curve(contact())
    np.testing.assert_allclose(ratio, [4.0 / 3.0])
    np.testing.assert_allclose(share, [1.0])
    nothing = {"contact_force_N": np.zeros((1, 4, 3)), "sliding_share": np.zeros(1)}
    ratio, share = slip_curve(contact(pressing_N=np.zeros(1), **nothing))
    np.testing.assert_allclose([*ratio, *share], 0.0)
    # A result of an earlier version has no sums.
    ratio, share = slip_curve(contact(pressing_N=np.zeros(0), tangential_N=np.zeros(0)))
    np.testing.assert_allclose([*ratio, *share], [0.0, 1.0])


def test_tangential_force_is_that_of_the_sum() -> None:
    """Of (-0.4, 0, 0.3) N against the normal z: 0.4 N; all along the normal: none."""
    along = np.array([[0.0, 0.0, 2.0]])
    np.testing.assert_allclose(tangential_force_N(contact()), [0.4])
    np.testing.assert_allclose(tangential_force_N(contact(reaction_N=along)), [0.0], atol=1e-15)


def test_frames_are_named_by_what_happens() -> None:
    """Two frames each of approach, shear, slide and release."""
    press = Press(
        frames=2,
        shear_mm=(0.1, 0.0),
        strokes=(slide(3.0, 0.0, frames=2), release(frames=2)),
    )
    assert [phase(press, k) for k in (0, 1, 3, 5, 6, 7, 9)] == [
        "untouched",
        "approach",
        "shear",
        "stroke 1: slide 3,0",
        "stroke 1: slide 3,0",
        "stroke 2: let go 0.5",
        "at rest",
    ]
    poses = tuple((0.0, 0.0, z, 1.0, 0.0, 0.0, 0.0) for z in (46.0, 45.0))
    moved = Press(trajectory=Trajectory(times_s=(0.0, 1.0), poses=poses))
    assert phase(moved, 1) == "trajectory"


@pytest.mark.parametrize(
    ("value", "form", "text"),
    [(np.nan, ".3f", "–"), (np.inf, ".1e", "–"), (-1e-9, ".0f", "0"), (1.25, ".2f", "1.25")],
)
def test_numbers_on_screen_are_finite(value: float, form: str, text: str) -> None:
    """NaN and infinity are a dash, and there is no minus zero."""
    assert number(value, form) == text


def test_template_of_a_press_goes_straight_down() -> None:
    """From 1 mm above the place where the object stands to its depth, along its outward axis."""
    standing = np.array([0.0, 0.0, 10.0, 1.0, 0.0, 0.0, 0.0])
    lines = template_csv(Press(depth_mm=1.0, frames=2), None, standing).splitlines()
    assert lines[0] == "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz"
    assert [float(line.split(",")[3]) for line in lines[1:]] == [11.0, 9.5, 9.0]


def test_a_difference_is_the_length_of_that_of_displacements_and_the_size_of_others() -> None:
    """0.5 mm inward against 0.5 mm aside are sqrt(1/2) mm apart, not 0; pressures subtract."""
    aside = np.full((1, 4, 3), [0.5, 0.0, 0.0], np.float32)
    other = contact(displacement_mm=aside, pressure_MPa=np.full((1, 4), 0.1, np.float32))
    apart = shown(SQUARE, contact(), Quantity.DISPLACEMENT, other)
    assert apart.difference
    assert apart.values == pytest.approx(np.full((1, 4), 0.5**0.5), rel=1e-6)
    pressure = shown(SQUARE, contact(), Quantity.PRESSURE, other)
    assert pressure.values[0] == pytest.approx([100.0, 350.0, 100.0, 100.0], rel=1e-5)
    assert not shown(SQUARE, contact(), Quantity.PRESSURE).difference


def test_a_field_that_a_source_lacks_is_told_and_makes_no_difference() -> None:
    """A network predicts no stress: zero, and said to be unknown, not the other's stress."""
    stressed = contact(cauchy_MPa=np.ones((1, 4, 6), np.float32))
    without = contact()
    assert shown(SQUARE, stressed, Quantity.VON_MISES).known
    assert not shown(SQUARE, without, Quantity.VON_MISES).known
    apart = shown(SQUARE, without, Quantity.VON_MISES, stressed)
    assert not apart.known and apart.empty
    assert shown(SQUARE, without, Quantity.DISPLACEMENT, stressed).known
