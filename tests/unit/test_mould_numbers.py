"""Numbers of the moulds' checks against what can be written down, one small shape each."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from geometry.body import csg
from geometry.mould.core_release import DOWN, bend_strain, pin_strain
from geometry.mould.parting import COUNTS, Parting
from geometry.mould.squeezing import Ways, _along
from tests.unit.test_demoulding import body
from workbench.core.result.results import Label, LabelledSurface


def test_places_along_a_way_are_inside_it_and_even() -> None:
    """Their mean is the middle, they step evenly, and none is at an end."""
    start, vector = np.array([[1.0, 2.0, 3.0]]), np.array([[0.0, 0.0, -10.0]])
    places = _along(Ways(start, vector))
    np.testing.assert_allclose(places.mean(axis=0), [1.0, 2.0, -2.0])
    heights = places[:, 2]
    assert heights.max() < 3.0 and heights.min() > -7.0
    np.testing.assert_allclose(np.diff(heights), np.diff(heights)[0])


@pytest.mark.parametrize("count", COUNTS)
def test_every_part_has_a_name_and_a_pull(count: int) -> None:
    """At most four letters: as many names as pulls, which leave evenly to all sides."""
    some = {"middle_mm": np.zeros(2), "curve_mm": np.zeros((2, 2)), "undercut": 0.0}
    parting = Parting(count=count, azimuth_deg=20.0, **some)  # type: ignore[arg-type]
    assert len(set(parting.names)) == len(parting.pulls) == count
    np.testing.assert_allclose(parting.pulls.sum(axis=0), 0.0, atol=1e-12)


def cone(root_mm: float, tip_mm: float) -> LabelledSurface:
    """A pin hanging from z = 10, seen by two rings of points: radius `root_mm` there, `tip_mm`
    at z = 0."""
    turn = 2.0 * np.pi * np.arange(8) / 8
    ring = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(8)])
    low, high = tip_mm * ring, root_mm * ring + [0.0, 0.0, 10.0]
    k = np.arange(8)
    beside = (k + 1) % 8
    faces = np.vstack(
        [np.column_stack([k, beside, k + 8]), np.column_stack([beside, beside + 8, k + 8])]
    )
    count = len(faces)
    return LabelledSurface(
        points_mm=np.vstack([low, high]) + np.array([3.0, 4.0, 0.0]),
        faces=faces.astype(np.int32),
        labels=np.full(count, Label.PIN, np.uint8),
        numbers=np.zeros(count, np.int16),
    )


@pytest.mark.parametrize(("root_mm", "tip_mm", "strain"), [(1.0, 1.2, 0.2), (1.0, 0.8, 0.0)])
def test_a_pin_wider_at_its_tip_stretches_by_the_ratio(
    root_mm: float, tip_mm: float, strain: float
) -> None:
    """Of two slices alone: tip over root, less 1; one that narrows lets go."""
    worst = pin_strain(cone(root_mm, tip_mm))
    assert worst.value == pytest.approx(strain)
    if strain:
        np.testing.assert_allclose(worst.place_mm, [3.0, 4.0, 5.0])


def test_a_bent_core_that_leaves_aslant_strains_as_the_upright_one_does() -> None:
    """Sheared by (0.2, -0.1) it goes along its own lean: the same strain, below the same place."""
    arc = csg.Union(
        parts=tuple(
            csg.moved(csg.cylinder(3.0, z, z + 2.0), (0.004 * z * z, 0.0, 0.0))
            for z in np.arange(0.0, 30.0, 1.5).tolist()
        )
    )
    straight = body(arc)
    lean = np.array([0.2, -0.1, 0.0])
    sheared = dataclasses.replace(
        straight, points_mm=straight.points_mm + straight.points_mm[:, 2:] * lean
    )
    way = -np.array([0.2, -0.1, 1.0]) / np.linalg.norm([0.2, -0.1, 1.0])
    upright, aslant = (
        bend_strain(made, skin(made), along) for made, along in ((straight, DOWN), (sheared, way))
    )
    assert upright.value > 0.05
    assert aslant.value == pytest.approx(upright.value, rel=1e-6)
    x, y, z = upright.place_mm
    np.testing.assert_allclose(aslant.place_mm, (x + 0.2 * z, y - 0.1 * z, z), atol=1e-6)


def skin(core: csg.Body) -> LabelledSurface:
    """The core's own surface as that of the elastomer."""
    return LabelledSurface(
        points_mm=core.points_mm,
        faces=core.faces,
        labels=np.zeros(len(core.faces), np.uint8),
    )
