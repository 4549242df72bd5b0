"""Trunk and tentacle: closed forms, features that must not be lost, marks."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from designs import saddle, suckers, tentacle, trunk
from designs.column import Column, column_body, column_field
from designs.prisms import rounded_prism_mm3
from designs.tentacle import TentacleShape
from designs.trunk import TrunkShape
from geometry.body.solid import tessellate
from tests.families import expect_found_out, expect_refusal
from workbench.core.base.errors import GeometryError
from workbench.core.design.design import Layers, SensorDesign
from workbench.core.result.results import Label

SHARP = {"width_mm": 50.0, "depth_mm": 24.0, "lobe_mm": 12.0, "lobe_ratio": 0.6, "rim_mm": 3.0}
"""A trunk whose ridges, of radius 0.88 mm, are sharper than its rim."""
BENT = Column(
    foot_mm=(13.0, 11.0), head_mm=(12.0, 8.0), length_mm=30.0, tip_mm=9.0, bend_mm=(2.0, 6.0)
)


def test_straight_column_is_a_capped_cylinder() -> None:
    """V = pi 15^2 (27 + 2/3 15) = 26153.76 mm3; bending it changes nothing (Cavalieri)."""
    exact = math.pi * 225.0 * 37.0
    for bend in ((0.0, 0.0), (3.0, 8.0)):
        column = Column(
            foot_mm=(15.0, 15.0), head_mm=(15.0, 15.0), length_mm=27.0, tip_mm=15.0, bend_mm=bend
        )
        assert column.volume_mm3 == pytest.approx(exact, rel=1e-12)
        # Rational Bezier patches: the kernel integrates them to about 1e-9.
        assert column_body(column, what="column").volume == pytest.approx(exact, rel=1e-7)


def test_column_field_vanishes_on_the_kernels_surface_with_slope_one() -> None:
    """f = 0 and |grad f| = 1 at every vertex above the base."""
    points = tessellate(column_body(BENT, what="column")).points_mm
    points = points[points[:, 2] > 1e-3]
    field = column_field(BENT)
    assert np.abs(field(points)).max() < 1e-9
    step = 1e-5
    slope = [(field(points + step * e) - field(points - step * e)) / (2 * step) for e in np.eye(3)]
    # Central differences of 1e-5 mm: rounding 1e-10 relative.
    assert np.linalg.norm(slope, axis=0) == pytest.approx(1.0, abs=1e-5)


def test_wall_share_of_a_column_is_that_of_its_slope() -> None:
    """Slope 2 (24 - 6) / 20 = 1.8 leaves 1 / sqrt(1 + 1.8^2) = 0.486; a tip sheared by 1.2, 0.566.

    Both are measured on the fields too, the wall being the distance from core to outside.
    """
    for foot, head, bend, exact in ((24.0, 6.0, 0.0, 0.4856), (10.0, 10.0, 12.0, 0.5662)):
        column = Column(
            foot_mm=(foot, foot),
            head_mm=(head, head),
            length_mm=20.0,
            tip_mm=head,
            bend_mm=(0.0, bend),
        )
        assert column.wall_share == pytest.approx(exact, abs=1e-4)
        core = column.inset(0.1)
        z = np.concatenate([np.linspace(0.0, 20.0, 801), 20.0 + np.linspace(0.0, head - 0.1, 801)])
        above = np.clip((z - 20.0) / (head - 0.1), 0.0, 1.0)
        width = core.half_axes(z)[:, 1] * np.sqrt(1.0 - above**2)
        sides = [np.column_stack([0.0 * z, core.centres(z)[:, 1] + s * width, z]) for s in (-1, 1)]
        wall = -column_field(column)(np.concatenate(sides)).max()
        # A wall of 0.1 mm on radii of 6 mm and more: first order is good to 2 %.
        assert wall / 0.1 == pytest.approx(exact, rel=0.02)


def test_a_rim_on_a_square_edge_leaves_what_the_closed_form_says() -> None:
    """Flat trunk: sqrt(2) t - (sqrt(2) - 1) (R - r) over the core's rim."""
    shape, layers = TrunkShape(lobe_mm=0.0, depth_mm=20.0, rim_mm=3.0), Layers(elastomer_mm=1.0)
    core_mm = 0.3 * 9.0**2 / 16.0
    exact = math.sqrt(2.0) - (math.sqrt(2.0) - 1.0) * (3.0 - core_mm)
    assert exact < 0.85
    # Between its axes the inset ellipse is not quite parallel: 1 % of the wall of 1 mm.
    assert trunk.least_wall_mm(shape, layers) == pytest.approx(exact, abs=0.015)


def test_rounded_prism_volume() -> None:
    """A disc of radius R with rim r is a cylinder, a quarter torus and a ring: R 10, r 2, H 8."""
    radius, rim, top = 10.0, 2.0, 8.0
    inner = radius - rim
    quarter = math.pi * rim**2 / 4 * 2 * math.pi * (inner + 4 * rim / (3 * math.pi))
    exact = math.pi * radius**2 * (top - rim) + math.pi * inner**2 * rim + quarter
    found = rounded_prism_mm3(math.pi * radius**2, 2 * math.pi * radius, top, rim)
    assert found == pytest.approx(exact, rel=1e-12)


def test_trunk_without_lobes_is_an_elliptic_prism() -> None:
    """V = pi a b h with lobe 0; a lobe adds its mean over the ellipse, checked by a fine sum."""
    flat = TrunkShape(lobe_mm=0.0)
    assert flat.saddle.sharp_mm3 == pytest.approx(math.pi * 17.0 * 13.0 * 30.0, rel=1e-12)
    y = np.linspace(-13.0, 13.0, 200001)
    shape = TrunkShape()
    fine = np.trapezoid(shape.saddle.roof_mm(y) * 34.0 * np.sqrt(1.0 - (y / 13.0) ** 2), y)
    assert shape.saddle.sharp_mm3 == pytest.approx(float(fine), rel=1e-6)


def test_published_trunk_is_34_by_26_by_50_mm(
    made: Callable[[SensorDesign, str], Any],
) -> None:
    """With its foot of 14 mm; both lobes are marked, equal in area, above half their height."""
    solid = made(SensorDesign(family="trunk", layers=Layers(elastomer_mm=2.5)), "build")
    points = np.concatenate([solid.membrane.points_mm, solid.base.points_mm])
    # Chords of 0.02 mm and 0.05 mm.
    assert np.ptp(points, axis=0) == pytest.approx([34.0, 26.0, 50.0], abs=0.05)
    membrane = solid.membrane
    corners = membrane.points_mm[membrane.faces]
    area = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    driven = membrane.has(Label.ACTUATOR)
    first, second = (area[driven & (membrane.numbers == number)].sum() for number in (0, 1))
    # The tessellation is not symmetric: chords of 0.1 rad are good to 1e-3.
    assert first == pytest.approx(second, rel=5e-3)
    assert corners[driven][:, :, 2].min() == pytest.approx(33.0, abs=1e-3)
    assert not np.any(driven & membrane.has(Label.INNER))


@pytest.mark.parametrize(
    ("module", "name", "boolean", "feature", "says"),
    [
        (tentacle, "tentacle", "fuse", "sucker", "rim of sucker 1"),
        (suckers, "tentacle", "cut", "cup", "rim of sucker 1"),
        (saddle, "trunk", "cut", "saddle", "saddle: expected"),
    ],
)
def test_a_kernel_that_returns_the_uncut_body_is_found_out(
    monkeypatch: pytest.MonkeyPatch, module: Any, name: str, boolean: str, feature: str, says: str
) -> None:
    """The boolean's own checks are taken away too: the feature's check must still see it."""
    expect_found_out(monkeypatch, name, Layers(), (module, boolean, feature), says)


def test_one_lost_sucker_is_named() -> None:
    """A body without its second sucker fails as sucker 2."""
    shape = TentacleShape()
    first, _, third = shape.suckers
    body = column_body(shape.column, what="arm")
    for sucker in (first, third):
        body = body + suckers.sucker_body(sucker)
    with pytest.raises(GeometryError, match="rim of sucker 2"):
        suckers.expect_suckers(body, shape.suckers)


@pytest.mark.parametrize(
    ("name", "shape", "layers", "at"),
    [
        ("trunk", {"depth_mm": 20.0}, {"elastomer_mm": 5.5}, "layers.elastomer_mm"),
        ("trunk", SHARP, {"elastomer_mm": 0.8, "support_mm": 0.4}, "shape.rim_mm"),
        ("tentacle", {"tip_radius_mm": 15.0}, {}, "shape.tip_radius_mm"),
        ("tentacle", {"sucker_count": 6.0}, {}, "shape.sucker_count"),
        ("tentacle", {"sucker_count": 2.5}, {}, "shape.sucker_count"),
        ("tentacle", {"cup_ratio": 0.8, "sucker_ratio": 0.2}, {}, "shape.cup_ratio"),
        (
            "tentacle",
            {"base_radius_mm": 24.0, "tip_radius_mm": 6.0, "length_mm": 20.0, "sucker_count": 1.0},
            {},
            "shape.length_mm",
        ),
        ("tentacle", {"tip_radius_mm": 5.0}, {"elastomer_mm": 3.0}, "layers.elastomer_mm"),
    ],
)
def test_contradictions_are_refused_with_their_place(
    name: str, shape: dict[str, float], layers: dict[str, float], at: str
) -> None:
    """Each names value, limit and unit, and what to change."""
    expect_refusal(name, shape, layers, at)
