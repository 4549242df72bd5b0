"""The thumb: closed forms of digit and nail, fields on the kernel's surface, walls, refusals."""

from __future__ import annotations

import math

import numpy as np
import pytest

from designs import nail
from designs.digit import Digit, digit_body
from designs.family import family, resolve_shape
from designs.thumb import ThumbShape
from geometry.body.solid import tessellate
from tests.families import expect_found_out, expect_refusal
from workbench.core.design.design import Layers

UPRIGHT = {"lean_deg": 0.0, "tip_lean_deg": 0.0, "taper": 1.0}
BENT = Digit(
    half_mm=(13.0, 11.0),
    corner_mm=(5.0, 6.0),
    root_mm=(13.0, 10.0),
    straight_mm=12.0,
    length_mm=30.0,
    tip_mm=12.0,
    lean=0.4,
    tip_lean=-0.1,
)


def test_a_digit_with_whole_corners_is_a_capped_elliptic_cylinder() -> None:
    """V = pi a b (L + 2/3 T), however it leans (Cavalieri)."""
    for lean, tip_lean in ((0.0, 0.0), (0.4, -0.1)):
        digit = Digit(
            half_mm=(13.0, 11.0),
            corner_mm=(13.0, 11.0),
            root_mm=(13.0, 11.0),
            straight_mm=12.0,
            length_mm=30.0,
            tip_mm=12.0,
            lean=lean,
            tip_lean=tip_lean,
        )
        assert digit.volume_mm3 == pytest.approx(math.pi * 143.0 * 38.0, rel=1e-12)


def test_the_kernel_integrates_a_bent_digit_to_the_quadrature() -> None:
    """Rational patches: to 1e-7; the flats take 4 a b - (4 - pi) r s of each section."""
    body = digit_body(BENT, what="digit")
    assert body.volume == pytest.approx(BENT.volume_mm3, rel=1e-7)
    low = BENT.sections(np.array([0.0, 6.0]))
    assert low == pytest.approx(
        np.array([[0.0, 13.0, 11.0, 5.0, 6.0], [2.4, 13.0, 11.0, 5.0, 6.0]])
    )
    box = body.bounding_box()
    # The kernel's box of curved faces is wider by its own tolerance.
    assert [*box.min, *box.max] == pytest.approx(np.ravel(BENT.box_mm()), abs=0.02)


def test_the_field_of_a_digit_vanishes_on_the_kernels_surface_with_slope_one() -> None:
    """f = 0 and |grad f| = 1 at every vertex between base and the field's flat cap."""
    points = tessellate(digit_body(BENT, what="digit")).points_mm
    points = points[(points[:, 2] > 1e-3) & (points[:, 2] < 41.9)]
    assert np.abs(BENT.distance(points)).max() < 1e-9
    step = 1e-4
    slope = [
        (BENT.distance(points + step * e) - BENT.distance(points - step * e)) / (2 * step)
        for e in np.eye(3)
    ]
    # Where flats turn into corners the section is bent abruptly, and differences span it.
    assert np.linalg.norm(slope, axis=0) == pytest.approx(1.0, abs=1e-3)


def test_a_nail_in_a_flat_back_takes_what_the_closed_form_says() -> None:
    """Between its lower end and the root of an upright thumb, with depth d, width w, side depth D:

    area = d w + (D - d) w / 3 + D^2 / flank.
    """
    from build123d import Box, Pos

    shape = ThumbShape(**UPRIGHT, corner_mm=4.0, nail_width_mm=12.0, nail_ratio=0.3)
    layers = Layers(elastomer_mm=3.0)
    depth = 0.3 * layers.elastomer_mm
    side = depth * (1.0 + nail.ARCH)
    exact = depth * 12.0 + (side - depth) * 4.0 + side**2 / nail.FLANK
    slab = Pos(0.0, 0.0, 26.0) * Box(60.0, 60.0, 6.0)
    whole = digit_body(shape.digit(0.0), what="body")
    left = family("thumb").build(shape, layers).outer
    taken = (whole & slab).volume - (left & slab).volume
    # Differences of 3600 mm3 that the kernel integrates to 1e-6.
    assert taken / 6.0 == pytest.approx(exact, rel=2e-3)


def test_fields_of_thumbs_vanish_on_the_kernels_surface() -> None:
    """The released one, one with hardly a nail, and one that bends toward its pad at the tip."""
    facet = {"nail_ratio": 0.1, "nail_width_mm": 10.0}
    forward = {"lean_deg": 0.0, "tip_lean_deg": 15.0, "corner_mm": 8.0, "nail_ratio": 0.25}
    for values in ({}, facet, forward):
        shape, layers = resolve_shape("thumb", values), Layers(elastomer_mm=3.0)
        fields = family("thumb").fields(shape, layers)
        bodies = family("thumb").build(shape, layers)
        for body, field in ((bodies.outer, fields.outer), (bodies.core, fields.core)):
            points = tessellate(body).points_mm
            points = points[points[:, 2] > 1e-3]
            # The field's flat cap leaves out a thousandth of the tip.
            assert np.abs(field(points)).max() < 1.1e-3 * shape.tip_mm


def test_the_wall_of_a_thumb_is_even_and_thicker_at_the_top() -> None:
    """3 mm square to the leaning sides, 3 + 4.5 mm at the top, less under the nail."""
    shape, layers = ThumbShape(), Layers(elastomer_mm=3.0)
    fields = family("thumb").fields(shape, layers)
    z = np.linspace(1.0, 16.0, 16)
    middle = math.tan(math.radians(22.0)) * z
    front = np.column_stack([0.0 * z, middle + shape.depth_mm / 2, z])
    side = np.column_stack([0.0 * z + shape.width_mm / 2, middle, z])
    for spots in (front, side):
        assert fields.outer(spots) == pytest.approx(0.0, abs=1e-9)
        assert fields.core(spots) == pytest.approx(3.0, abs=1e-6)
    core = shape.digit(3.0)
    assert shape.digit(0.0).top_mm - core.top_mm == pytest.approx(7.5)
    assert 0.4 * 3.0 < fields.wall_mm < 3.0 - 0.4 * 3.0


def test_a_kernel_that_cuts_no_nail_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """The boolean's own check is taken away: the nail's volume must still be missed."""
    expect_found_out(monkeypatch, "thumb", Layers(), (nail, "cut", "nail"), "the nail takes 0 mm3")


@pytest.mark.parametrize(
    ("shape", "layers", "at"),
    [
        ({"straight_mm": 22.0, "length_mm": 24.0, "nail_mm": 4.0}, {}, "shape.straight_mm"),
        ({"straight_mm": 20.0, "length_mm": 24.0, "taper": 0.8, "tip_mm": 24.0}, {}, "shape.taper"),
        ({"corner_mm": 8.0, "depth_mm": 18.0, "lean_deg": 25.0}, {}, "shape.corner_mm"),
        ({"tip_mm": 10.0, "tip_more_mm": 8.0}, {}, "shape.tip_more_mm"),
        ({"depth_mm": 18.0}, {"elastomer_mm": 5.0, "support_mm": 3.0}, "layers.elastomer_mm"),
        ({"nail_width_mm": 18.0, "width_mm": 20.0}, {}, "shape.nail_width_mm"),
        ({"nail_mm": 14.0, "length_mm": 18.0, "straight_mm": 10.0}, {}, "shape.length_mm"),
        ({"nail_ratio": 0.45}, {}, "shape.nail_ratio"),
    ],
)
def test_contradictions_are_refused_with_their_place(
    shape: dict[str, float], layers: dict[str, float], at: str
) -> None:
    """Each names value, limit and unit, and what to change."""
    expect_refusal("thumb", shape, layers, at)
