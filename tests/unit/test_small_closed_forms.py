"""Small functions against what can be written down: places, angles, heights, and shares."""

from __future__ import annotations

import itertools
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from geometry.body import csg
from geometry.body.csg_mesh import evaluate
from geometry.housing.camera_mount import cup_front_mm, cup_seat
from geometry.housing.led_holder import LEAST_WALL_MM
from geometry.housing.led_room import holder_mm
from geometry.mould.castability import draft_deg
from geometry.mould.parting import Parting, _aside
from geometry.mould.seams import END_MM, TALL_MM, _key_heights
from geometry.surface.spread import Spread
from geometry.volume.hexmesh import _chord_share
from geometry.volume.ogrid import Pace
from geometry.volume.pointlabels import _samples
from geometry.volume.slab import _outline_sides
from sim.contact.engine.batch import needed_bytes
from sim.contact.objects.samples import SampleGrid, read_slopes, read_spline
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedRing
from workbench.core.design.making import Housing


def test_samples_lie_in_rows_of_x_then_y_then_z() -> None:
    """Sample (i, j, k) is at origin + spacing (i, j, k), the last index fastest."""
    grid = SampleGrid(origin_mm=np.array([1.0, -2.0, 5.0]), spacing_mm=0.5, shape=(2, 3, 4))
    counted = itertools.product(range(2), range(3), range(4))
    expected = [(1.0 + 0.5 * i, -2.0 + 0.5 * j, 5.0 + 0.5 * k) for i, j, k in counted]
    np.testing.assert_array_equal(grid.places(), expected)


def test_splines_slope_as_the_polynomials_that_they_are() -> None:
    """Coefficients i^2 + 3 j - 2 j k make x^2 + 1/4 + 3 y - 2 y z: slope (2 x, 3 - 2 z, -2 y).

    Quadratic B-splines hold i, j and k as they are, and a variance of 1/4 about i.
    """
    i, j, k = np.meshgrid(np.arange(9.0), np.arange(8.0), np.arange(7.0), indexing="ij")
    coefficients = i**2 + 3.0 * j - 2.0 * j * k
    places = np.random.default_rng(6).uniform(2.0, 4.0, (50, 3))
    x, y, z = places.T
    exact = x**2 + 0.25 + 3.0 * y - 2.0 * y * z
    np.testing.assert_allclose(read_spline(coefficients, places), exact, atol=1e-12)
    # Rounding of values up to 40 over a way of 2e-4.
    slopes = np.stack([2.0 * x, 3.0 - 2.0 * z, -2.0 * y], axis=1)
    np.testing.assert_allclose(read_slopes(coefficients, places), slopes, atol=1e-9)


@pytest.mark.parametrize(
    ("count", "one", "other", "aside"),
    [
        (2, 0.0, 22.5, True),
        (2, 0.0, 22.0, False),
        (2, 0.0, 160.0, False),
        (2, 5.0, 95.0, True),
        (4, 0.0, 11.25, True),
        (4, 0.0, 11.0, False),
        (4, 0.0, 80.0, False),
    ],
)
def test_partings_are_aside_from_an_eighth_of_their_period(
    count: int, one: float, other: float, aside: bool
) -> None:
    """Two halves repeat after 180 degrees, four parts after 90; either way around."""
    some: dict[str, Any] = {"middle_mm": np.zeros(2), "curve_mm": np.zeros((2, 2)), "undercut": 0.0}
    pair = [Parting(count=count, azimuth_deg=turn, **some) for turn in (one, other)]
    assert _aside(*pair) is aside


def test_the_least_draft_is_that_of_the_worst_hundredth() -> None:
    """Of 201 equal areas at 0.0, 0.1 ... 20.0 degrees two are left out as noise: 0.2 degrees."""
    angle_deg = np.random.default_rng(3).permutation(np.arange(201)) / 10.0
    angle = np.radians(angle_deg)
    normals = np.stack([np.cos(angle), np.zeros(201), np.sin(angle)], axis=1)
    points = np.stack([angle_deg, np.zeros(201), np.zeros(201)], axis=1)
    worst = draft_deg(Spread(points, normals, 1.0), np.array([0.0, 0.0, 1.0]))
    assert worst.value == pytest.approx(0.2, abs=1e-9)
    assert worst.place_mm[0] == pytest.approx(0.2)


@pytest.mark.parametrize("seed", range(5))
def test_no_place_of_a_triangle_is_far_from_a_sample(seed: int) -> None:
    """The longer row beside it is at most a step away, and a sample half a step along that."""
    random, step_mm = np.random.default_rng(seed), 0.1
    corners = random.uniform(-1.0, 1.0, (4, 3, 3)) * [3.0, 1.0, 0.3]
    points, face = _samples(corners, step_mm)
    shares = random.dirichlet([1.0, 1.0, 1.0], 200)
    for number, triangle in enumerate(corners):
        own = points[face == number]
        flat = np.linalg.norm(np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0]))
        away = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0]) / flat
        assert np.abs((own - triangle[0]) @ away).max() < 1e-12
        gaps = np.linalg.norm((shares @ triangle)[:, None] - own[None], axis=2).min(axis=1)
        assert gaps.max() <= step_mm * np.sqrt(1.25) + 1e-9
        # And not many more than the area asks for: a row and a column more, and rounding up.
        edges = np.linalg.norm(triangle - np.roll(triangle, 1, axis=0), axis=1)
        most = 0.5 * flat / step_mm**2 + 2.0 * edges.sum() / step_mm + 6.0
        assert len(own) <= most


@pytest.mark.parametrize("start", [0, 1, 7, 30])
def test_the_sides_of_a_rectangle_go_from_corner_to_corner(start: int) -> None:
    """Of 24 x 20 mm, every 2 mm from (12, -10) counter-clockwise, wherever its outline begins."""
    up, across = np.arange(-10.0, 10.0), np.arange(-12.0, 12.0)
    outline = np.concatenate(
        [
            np.stack([np.full(20, 12.0), up], axis=1),
            np.stack([-across, np.full(24, 10.0)], axis=1),
            np.stack([np.full(20, -12.0), -up], axis=1),
            np.stack([across, np.full(24, -10.0)], axis=1),
        ]
    )
    expected = outline[::2]
    sides = _outline_sides(np.roll(outline, -start, axis=0), Pace(2.0))
    assert [len(side) for side in sides] == [10, 12, 10, 12]
    np.testing.assert_allclose(np.concatenate(sides), expected, atol=1e-12)


def test_a_tall_seam_has_two_keys_and_a_low_one_has_one_in_the_middle() -> None:
    """Near both ends, and halfway between base and top."""
    tall: Any = SimpleNamespace(base_mm=2.0, top_mm=2.0 + TALL_MM)
    low: Any = SimpleNamespace(base_mm=2.0, top_mm=1.0 + TALL_MM)
    assert _key_heights(tall) == [2.0 + END_MM, 2.0 + TALL_MM - END_MM]
    assert _key_heights(low) == pytest.approx([1.5 + TALL_MM / 2.0])


def test_the_share_that_chords_cut_off() -> None:
    """(h / r)^2 / 6 of a body 20 mm wide and longer in y, at a spacing of 1 mm: 1 / 600."""
    points = np.array([[-10.0, -30.0, 0.0], [10.0, 30.0, 5.0], [0.0, 0.0, 70.0]])
    assert _chord_share(SimpleNamespace(points_mm=points), 1.0) == pytest.approx(1.0 / 600.0)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("tilt_deg", "lowered"), [(0, True), (20, True), (-30, False), (30, False)]
)
def test_only_an_upright_camera_keeps_its_cup_below_the_led_ring(
    tilt_deg: int, lowered: bool
) -> None:
    """Up to arccos 0.9 = 25.8 degrees about Y, whichever way; beyond, 0.3 of its depth of 6 mm."""
    half = np.radians(tilt_deg) / 2.0
    ring, options = LedRing(), Housing()
    # So high that the room under the ring's holder ends 3 mm behind the optical centre.
    end_mm = ring.height_mm - holder_mm(ring, options) - 2.0 * options.clearance_mm
    place, turn = (0.0, 0.0, end_mm + 3.0), (float(np.cos(half)), 0.0, float(np.sin(half)), 0.0)
    front_mm = cup_front_mm(Camera(position_mm=place, wxyz=turn), ring, options)
    assert front_mm == pytest.approx(-3.0 if lowered else -1.8)


@pytest.mark.parametrize(
    ("ledge_mm", "taken"), [(-0.3, False), (0.1, True), (0.7, True), (0.9, False)]
)
@pytest.mark.parametrize("width_mm", [8.5, 20.0])
def test_a_ledge_thinner_than_a_wall_goes_with_the_seat_of_the_cup(
    width_mm: float, ledge_mm: float, taken: bool
) -> None:
    """The seat ends a gap over the cup's front, a ledge below the ring's seat; where that is below
    0.8 mm, 0.8 mm higher: the ledge is gone, in the ring's seat or all over the cup."""
    ring, options = LedRing(), Housing(camera_width_mm=width_mm, camera_height_mm=width_mm)
    camera, gap_mm = Camera(position_mm=(0.0, 0.0, -1.5)), options.clearance_mm
    ring_seat_mm = ring.height_mm - holder_mm(ring, options) - gap_mm
    front_mm = ring_seat_mm - ledge_mm - gap_mm + 1.5
    parts = cup_seat(camera, ring, options, front_mm)
    top_mm = evaluate(csg.Union(parts=parts)).bounding_box()[5]
    expected_mm = ring_seat_mm - ledge_mm + (LEAST_WALL_MM if taken else 0.0)
    assert top_mm == pytest.approx(expected_mm, abs=1e-9)
    assert (top_mm > ring_seat_mm) == (taken or ledge_mm < 0.0)


def test_the_memory_of_a_case_is_that_of_its_numbers() -> None:
    """Of four bytes: 81 + 9 + 8 + 4 + 27 a cell, twice 9 + 7 for its nodes, and 26 a point."""
    assert needed_bytes(1000, 0) == 4 * 161 * 1000
    assert needed_bytes(0, 10) == 4 * 26 * 10
    assert needed_bytes(1000, 10) == needed_bytes(1000, 0) + needed_bytes(0, 10)
