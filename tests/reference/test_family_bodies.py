"""Trunk and tentacle: closed forms, features that must not be lost, marks."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from designs import saddle, suckers, tentacle, trunk
from designs.arm import arm_body, arm_field
from designs.family import family
from designs.prisms import rounded_prism_mm3
from designs.saddle import saddle_field
from designs.tentacle import TentacleShape
from designs.trunk import TrunkShape
from geometry.body.solid import tessellate
from geometry.surface.surface import face_areas
from tests.families import expect_found_out, expect_refusal
from workbench.core.base.errors import GeometryError
from workbench.core.design.design import Layers, SensorDesign
from workbench.core.result.results import Label

ROUND = {"width_mm": 50.0, "depth_mm": 30.0, "lobe_mm": 2.0, "rim_mm": 4.0}
"""A trunk whose rim takes much of the corner over a thin wall."""
CUPS = {"cup_depth": 0.6}
"""A tentacle whose suckers are cupped."""


def test_a_rim_over_a_core_leaves_what_the_closed_form_says() -> None:
    """At the ends of a low saddle it is sqrt(2) t - (sqrt(2) - 1) (R - r).

    There the roof is level and its corner with the side square; toward the lobes more is left.
    """
    shape, layers = TrunkShape(**ROUND), Layers(elastomer_mm=0.5)
    core_mm = 0.3 * 14.5**2 / 24.5
    exact = 0.5 * math.sqrt(2.0) - (math.sqrt(2.0) - 1.0) * (4.0 - core_mm)
    assert exact < 0.12
    assert trunk.least_wall_mm(shape, layers) == pytest.approx(exact, abs=0.005)


def test_rounded_prism_volume() -> None:
    """A disc of radius R with rim r is a cylinder, a quarter torus and a ring: R 10, r 2, H 8."""
    radius, rim, top = 10.0, 2.0, 8.0
    inner = radius - rim
    quarter = math.pi * rim**2 / 4 * 2 * math.pi * (inner + 4 * rim / (3 * math.pi))
    exact = math.pi * radius**2 * (top - rim) + math.pi * inner**2 * rim + quarter
    found = rounded_prism_mm3(math.pi * radius**2, 2 * math.pi * radius, top, rim)
    assert found == pytest.approx(exact, rel=1e-12)


def test_a_trunk_with_low_lobes_is_an_elliptic_prism() -> None:
    """V = pi a b h as the lobes vanish; lobes add their mean over the ellipse, by a fine sum."""
    flat = TrunkShape(lobe_mm=1e-6).saddle
    assert flat.sharp_mm3 == pytest.approx(math.pi * 17.5 * 15.0 * 28.75, rel=1e-6)
    y = np.linspace(-15.0, 15.0, 200001)
    saddle = TrunkShape().saddle
    fine = np.trapezoid(saddle.roof_mm(y) * 35.0 * np.sqrt(1.0 - (y / 15.0) ** 2), y)
    assert saddle.sharp_mm3 == pytest.approx(float(fine), rel=1e-6)


def test_saddle_and_rim_touch_side_and_each_other() -> None:
    """R = (13.125^2 + 6.25^2) / 12.5 - 1.875 = 15.031 mm; the field is 0 on both arcs at x = 0."""
    saddle = TrunkShape().saddle
    assert saddle.arc_mm == pytest.approx(15.03125, abs=1e-9)
    field = saddle_field(saddle)
    peak, arc, rim = 13.125, saddle.arc_mm, 1.875
    flank = math.atan2(peak, arc + rim - 6.25 + 0.0)
    turn = np.linspace(-flank, flank, 41) * 0.999
    trough = np.column_stack([0 * turn, arc * np.sin(turn), 28.75 + arc - arc * np.cos(turn)])
    assert np.abs(field(trough)).max() < 1e-9
    # The rim goes from the upright side over the crest down to the saddle.
    turn = np.linspace(0.0, math.pi / 2 + flank, 41) * 0.999
    crest = np.column_stack([0 * turn, peak + rim * np.cos(turn), 33.125 + rim * np.sin(turn)])
    assert np.abs(field(crest)).max() < 1e-6
    assert field(np.array([[0.0, peak, 36.0]]))[0] == pytest.approx(1.0, abs=1e-6)


def test_published_trunk_is_35_by_30_by_50_mm(
    made: Callable[[SensorDesign, str], Any],
) -> None:
    """With its foot of 15 mm; top and back of both lobes are marked, equal on both sides."""
    solid = made(SensorDesign(family="trunk", layers=Layers(elastomer_mm=2.5)), "build")
    points = np.concatenate([solid.membrane.points_mm, solid.base.points_mm])
    # Chords of 0.02 mm and 0.05 mm.
    assert np.ptp(points, axis=0) == pytest.approx([35.0, 30.0, 50.0], abs=0.05)
    membrane = solid.membrane
    corners = membrane.points_mm[membrane.faces]
    area = face_areas(membrane.points_mm, membrane.faces)
    driven = membrane.has(Label.ACTUATOR)
    areas = [area[driven & (membrane.numbers == number)].sum() for number in range(4)]
    # The tessellation is not symmetric: chords of 0.1 rad are good to 1e-3.
    assert areas[0] == pytest.approx(areas[1], rel=5e-3)
    assert areas[2] == pytest.approx(areas[3], rel=5e-3)
    # Down to the height of the core's top, and two thirds of the width, as on the released mesh.
    assert corners[driven][:, :, 2].min() == pytest.approx(28.75 - 2.5, abs=1e-3)
    assert np.abs(corners[driven & (membrane.numbers >= 2)][:, :, 0]).max() == pytest.approx(
        0.67 * 17.5, abs=1e-3
    )
    # Backs end where the tops begin, at half the height of the lobes, and look outward.
    backs = driven & (membrane.numbers >= 2)
    assert corners[backs][:, :, 2].max() == pytest.approx(28.75 + 3.125, abs=1e-3)
    assert corners[driven & ~backs][:, :, 2].min() == pytest.approx(28.75 + 3.125, abs=1e-3)
    assert np.abs(corners[backs][:, :, 1]).min() > 8.0
    assert not np.any(driven & membrane.has(Label.INNER))


@pytest.mark.parametrize(
    ("module", "design", "boolean", "feature", "says"),
    [
        (tentacle, "tentacle", "fuse", "sucker", "rim of sucker 1"),
        (suckers, ("tentacle", CUPS), "cut", "cup", "rim of sucker 1"),
        (saddle, "trunk", "cut", "saddle", "saddle: expected"),
    ],
)
def test_a_kernel_that_returns_the_uncut_body_is_found_out(
    monkeypatch: pytest.MonkeyPatch, module: Any, design: Any, boolean: str, feature: str, says: str
) -> None:
    """The boolean's own checks are taken away too: the feature's check must still see it."""
    expect_found_out(monkeypatch, design, Layers(), (module, boolean, feature), says)


def test_one_lost_sucker_is_named() -> None:
    """A body without its second sucker fails as sucker 2."""
    shape = TentacleShape(rows=1.0, **CUPS)
    first, _, third = shape.suckers
    body = arm_body(shape.arm, what="arm")
    for sucker in (first, third):
        body = body + suckers.sucker_body(sucker)
    with pytest.raises(GeometryError, match="rim of sucker 2"):
        suckers.expect_suckers(body, shape.suckers)


def test_a_bent_arm_has_the_volume_of_pappus() -> None:
    """V = pi 18 13 40 rad(80) = 41057.5 mm3; inset by 3.2 its end is 3.2 mm thick or more."""
    arm = TentacleShape().arm
    exact = math.pi * 18.0 * 13.0 * 40.0 * math.radians(80.0)
    assert arm.volume_mm3 == pytest.approx(exact, rel=1e-12)
    assert arm_body(arm, what="arm").volume == pytest.approx(exact, rel=1e-7)
    core = arm.inset(3.2)
    nearest = core.place_mm(core.turn, -core.half_mm[1])
    # Along the circle to the end's plane it is a little more than straight to it.
    assert arm_field(arm)(nearest[None])[0] == pytest.approx(-3.2, rel=2e-3)


def test_arm_field_vanishes_on_the_kernels_surface() -> None:
    """f = 0 at every vertex above the base, side and end; 1 mm off the end it is 1."""

    arm = TentacleShape().arm
    points = tessellate(arm_body(arm, what="arm")).points_mm
    field = arm_field(arm)
    assert np.abs(field(points[points[:, 2] > 1e-3])).max() < 1e-6
    ridge, end = arm.place_mm(0.7, 14.0), arm.place_mm(arm.turn, 0.0)
    ahead = np.array([0.0, math.sin(arm.turn), math.cos(arm.turn)])
    # k (k - 1) / |grad k| with k = 14 / 13 is 1.08 mm: second order.
    assert field(ridge[None])[0] == pytest.approx(1.0, abs=0.1)
    assert field((end + ahead)[None])[0] == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("cup_depth", [0.0, 0.6])
def test_suckers_add_what_the_quadrature_says(cup_depth: float) -> None:
    """Six cylinders over the bent side, each the same by symmetry, as the kernel has it to 1e-4."""
    shape = TentacleShape(cup_depth=cup_depth)
    parts = [suckers.sucker_mm3(shape.arm, sucker) for sucker in shape.suckers]
    assert parts == pytest.approx([parts[0]] * 6, rel=1e-9)
    outer = family("tentacle").build(shape, Layers()).outer
    assert outer.volume - shape.arm.volume_mm3 == pytest.approx(sum(parts), rel=1e-3)
    # Over the ridge of a nearly flat side a sucker is a whole cylinder.
    flat = TentacleShape(rows=1.0, bend_radius_mm=1e5, width_mm=2e5).arm
    alone = suckers.suckers_along(flat, suckers.Row(1, 0.0, 4.0, 5.0, 0.5, 0.0), (0.0,))[0]
    assert suckers.sucker_mm3(flat, alone) == pytest.approx(math.pi * 16.0 * 5.0, rel=1e-4)


@pytest.mark.parametrize(
    ("name", "shape", "layers", "at"),
    [
        ("trunk", {"depth_mm": 20.0}, {"elastomer_mm": 5.5}, "layers.elastomer_mm"),
        ("trunk", ROUND, {"elastomer_mm": 0.5}, "shape.rim_mm"),
        ("trunk", {"lobe_mm": 9.0, "depth_mm": 24.0}, {}, "shape.lobe_mm"),
        ("trunk", {"width_mm": 50.0, "depth_mm": 20.0, "rim_mm": 2.0}, {}, "shape.rim_mm"),
        ("tentacle", {"bend_radius_mm": 20.0, "depth_mm": 34.0}, {}, "shape.bend_radius_mm"),
        ("tentacle", {"sucker_count": 4.0}, {}, "shape.sucker_count"),
        ("tentacle", {"sucker_count": 2.5}, {}, "shape.sucker_count"),
        ("tentacle", {"rows": 1.5}, {}, "shape.rows"),
        ("tentacle", {"row_mm": 16.0}, {}, "shape.sucker_count"),
        ("tentacle", {"turn_deg": 66.0}, {}, "shape.sucker_count"),
        ("tentacle", {"row_mm": 20.0}, {}, "shape.sucker_radius_mm"),
        ("tentacle", {"cup_ratio": 0.8, "sucker_radius_mm": 1.5, **CUPS}, {}, "shape.cup_ratio"),
        ("tentacle", {"depth_mm": 18.0}, {"elastomer_mm": 5.0}, "layers.elastomer_mm"),
        ("tentacle", {"turn_deg": 15.0, "sucker_count": 1.0}, {}, "shape.turn_deg"),
    ],
)
def test_contradictions_are_refused_with_their_place(
    name: str, shape: dict[str, float], layers: dict[str, float], at: str
) -> None:
    """Each names value, limit and unit, and what to change."""
    expect_refusal(name, shape, layers, at)
