"""A force that is asked for: its depth on a curve of known form, and what is said of the wall."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from workbench.view.force_asked import WayIn
from workbench.view.wall_under import wall_under_mm

DEPTH_MM = np.linspace(0.0, 1.6, 401)
HERTZ = 2.0 * DEPTH_MM**1.5
"""Force of a ball on a half-space by depth."""


def test_the_depth_of_a_force_is_that_of_the_curve() -> None:
    """A law that is inverted by hand; beyond its end nothing is invented."""
    way = WayIn(depth_mm=DEPTH_MM, force_N=HERTZ)
    for wanted_N in (0.01, 0.5, 3.0):
        assert way.depth_at(wanted_N) == pytest.approx((wanted_N / 2.0) ** (2 / 3), rel=1e-3)
    assert way.depth_at(0.0) == 0.0
    assert way.depth_at(5.0) is None
    assert "4.05 N at 1.6 mm" in way.words(5.0)


def test_a_force_that_falls_counts_where_it_is_first_reached() -> None:
    """A skin that buckles has a force at two depths."""
    way = WayIn(depth_mm=np.array([0.0, 1.0, 2.0, 3.0]), force_N=np.array([0.0, 2.0, 1.0, 4.0]))
    assert way.depth_at(1.5) == pytest.approx(0.75)
    assert way.depth_at(3.0) == pytest.approx(2.0 + 2.0 / 3.0)


def test_the_wall_that_is_left_is_told() -> None:
    """Half, near the support, through; and nothing where the skin has no support behind it."""
    way = WayIn(depth_mm=DEPTH_MM, force_N=HERTZ, wall_mm=2.0)
    assert way.wall_words(1.0) == "1 of 2 mm of elastomer are left."
    assert "near the support" in way.wall_words(1.6)
    assert "bottoms out" in way.wall_words(2.0)
    assert "left" not in WayIn(depth_mm=DEPTH_MM, force_N=HERTZ).words(1.0)


def shells(wall_mm: float, gap_mm: float) -> SimpleNamespace:
    """A slab of elastomer from z = 0 down, and a slab that may carry it."""
    import trimesh

    def slab(top_mm: float, thick_mm: float) -> SimpleNamespace:
        box = trimesh.creation.box((10.0, 10.0, thick_mm))
        middle = np.array([0.0, 0.0, top_mm - thick_mm / 2])
        points = np.asarray(box.vertices) + middle
        return SimpleNamespace(points_mm=points, faces=np.asarray(box.faces))

    return SimpleNamespace(membrane=slab(0.0, wall_mm), support=slab(-wall_mm - gap_mm, 1.0))


def test_the_wall_is_measured_where_the_support_carries_it() -> None:
    """Straight and slanting through a slab; None beside it, and over a gap."""
    up = np.array([0.0, 0.0, 1.0])
    place = np.array([1.0, 2.0, 0.0])
    assert wall_under_mm(cast(Any, shells(2.5, 0.0)), place, up) == pytest.approx(2.5)
    slanting = np.array([0.6, 0.0, 0.8])
    found = wall_under_mm(cast(Any, shells(2.0, 0.0)), place, slanting)
    assert found == pytest.approx(2.0 / 0.8, rel=1e-6)
    assert wall_under_mm(cast(Any, shells(2.0, 1.5)), place, up) is None
    assert wall_under_mm(cast(Any, shells(2.0, 0.0)), np.array([9.0, 0.0, 0.0]), up) is None
