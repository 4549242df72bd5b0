"""Outlines of arcs: closed forms, insets and distances against polygons, and what makes none."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from geometry.body.arcs import Arcs, Lobe, around


def polygon(arcs: Arcs) -> shapely.Polygon:
    """The outline by 400 chords an arc: within 1e-5 of its area."""
    spots = np.stack([arcs.spots_mm(share) for share in np.arange(400) / 400], axis=1)
    return shapely.Polygon(spots.reshape(-1, 2))


def clover(valley_mm: float = 0.6) -> Arcs:
    """Two discs behind and three ovals in front."""
    lobes = [Lobe(x_mm=5.0, y_mm=-6.0, half_mm=(7.0, 7.0))]
    for turn in np.radians([20.0, 90.0, 160.0]):
        x, y = 9.0 * math.cos(turn), 9.0 * math.sin(turn)
        lobes.append(Lobe(x_mm=x, y_mm=y, half_mm=(6.0, 7.0)))
    found = around([*lobes, Lobe(x_mm=-5.0, y_mm=-6.0, half_mm=(7.0, 7.0))], valley_mm)
    assert found is not None
    return found


def test_two_discs_and_their_valleys_are_known() -> None:
    """Radius 5, centres 8 apart, valleys of 5: their centres are at y = +-sqrt(10^2 - 4^2).

    The outline is the rhombus of the four centres, two sectors of the discs outside it, and less
    two sectors of the valleys inside it; a side of the rhombus is 10 long.
    """
    left, right = (Lobe(x_mm=x, y_mm=0.0, half_mm=(5.0, 5.0)) for x in (-4.0, 4.0))
    arcs = around([right, left], 5.0)
    assert arcs is not None
    half = math.acos(0.4)
    sector, valley = 2.0 * math.pi - 2.0 * half, math.pi - 2.0 * half
    rhombus = 2.0 * 4.0 * math.sqrt(84.0)
    exact = rhombus + 25.0 * sector - 25.0 * valley
    assert arcs.area_mm2 == pytest.approx(exact, rel=1e-12)
    assert arcs.perimeter_mm == pytest.approx(10.0 * (sector + valley), rel=1e-12)
    assert arcs.bend_mm == pytest.approx(5.0)


def test_an_oval_has_its_half_axes_and_one_tangent_where_arcs_meet() -> None:
    """Half axes 3 and 4: sides of radius 3 + k, ends of 4 - k, k = 1 / (2 - sqrt 2)."""
    lobe = Lobe(x_mm=1.0, y_mm=2.0, half_mm=(3.0, 4.0))
    right, top, left, bottom = lobe.pieces()
    assert right.x_mm + right.radius_mm == pytest.approx(4.0)
    assert left.x_mm - left.radius_mm == pytest.approx(-2.0)
    assert top.y_mm + top.radius_mm == pytest.approx(6.0)
    assert bottom.y_mm - bottom.radius_mm == pytest.approx(-2.0)
    joint = math.sqrt(0.5)
    for first, second in ((right, top), (bottom, left)):
        sign = 1.0 if first is right else -1.0
        ends = [
            (
                piece.x_mm + sign * joint * piece.radius_mm,
                piece.y_mm + sign * joint * piece.radius_mm,
            )
            for piece in (first, second)
        ]
        assert ends[0] == pytest.approx(ends[1])
    assert lobe.bend_mm == pytest.approx(4.0 - 1.0 / (2.0 - math.sqrt(2.0)))


def test_area_length_and_inset_are_those_of_a_fine_polygon() -> None:
    """A clover and the same moved inward by 2 mm, which shapely does by itself."""
    arcs = clover()
    inner = arcs.inset(2.0)
    assert inner is not None
    shape = polygon(arcs)
    assert shape.is_valid
    # Chords of a 400th of an arc.
    assert arcs.area_mm2 == pytest.approx(shape.area, rel=2e-5)
    assert arcs.perimeter_mm == pytest.approx(shape.length, rel=2e-5)
    moved = shape.buffer(-2.0, quad_segs=64)
    assert inner.area_mm2 == pytest.approx(moved.area, rel=1e-4)
    assert polygon(inner).symmetric_difference(moved).area < 1e-3 * moved.area


def test_distance_is_that_to_the_polygon() -> None:
    """300 places in and about a clover; the sign by the polygon too."""
    arcs = clover()
    shape = polygon(arcs)
    places = np.random.default_rng(4).uniform(-20.0, 20.0, (300, 2))
    inside = shapely.contains_xy(shape, places[:, 0], places[:, 1])
    away = shapely.distance(shape.exterior, shapely.points(places))
    # The polygon's chords lie 7 mm (1.5 / 400)^2 / 8 beside their arcs.
    assert arcs.distance(places) == pytest.approx(np.where(inside, -away, away), abs=1e-4)


@pytest.mark.parametrize(
    ("apart_mm", "valley_mm"),
    [(30.0, 5.0), (1e-3, 0.5), (11.8, 0.5)],
    ids=["too far", "one in the other", "across each other"],
)
def test_lobes_that_make_no_outline_are_none(apart_mm: float, valley_mm: float) -> None:
    """Discs of 5 mm that no valley joins, that are one, or whose valleys meet between them."""
    half = apart_mm / 2
    right, left = (Lobe(x_mm=x, y_mm=0.0, half_mm=(5.0, 5.0)) for x in (half, -half))
    assert around([right, left], valley_mm) is None


def test_an_inset_wider_than_a_lobe_or_a_neck_is_none() -> None:
    """Discs of 5 mm; between those 11 mm apart, valleys of 4 mm leave a neck of 6.3 mm."""
    right, left = (Lobe(x_mm=x, y_mm=0.0, half_mm=(5.0, 5.0)) for x in (5.5, -5.5))
    arcs = around([right, left], 4.0)
    assert arcs is not None
    neck = 2.0 * (math.sqrt(81.0 - 5.5**2) - 4.0)
    assert arcs.inset(0.49 * neck) is not None
    assert arcs.inset(0.51 * neck) is None
    assert clover().inset(7.0) is None
