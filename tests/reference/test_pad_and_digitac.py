"""Pad and DigiTac: closed forms, pins that must not be lost, contradictions that are refused."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from designs import digitac, pad
from designs.digitac import DigitacShape
from designs.family import family, resolve_shape
from designs.loaf import Loaf, loaf_body, loaf_shell
from designs.pad import PadShape, slab_mm3
from designs.plates import rectangle_distance
from geometry.surface.surface import face_areas
from tests.families import expect_found_out, expect_refusal
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers, SensorDesign
from workbench.core.result.results import Label
from workbench.pipeline.building import build_solid, coarse_volume_mm3

THIN = {"elastomer_mm": 1.2}
WIDE_PINS = {"pin_rows": 3.0, "pin_columns": 5.0, "pin_radius_mm": 0.8}
LONG_PINS = {"pin_rows": 4.0, "pin_columns": 1.0, "pin_length_mm": 3.0, "width_mm": 26.0}
LOW = {"wall_mm": 4.0, "dome_mm": 7.0, "back_mm": 9.7}
"""A DigiTac with an upright wall and two round ends."""
LOAF = Loaf(half_mm=10.0, straight_mm=(-2.0, 4.0), ends_mm=(5.0, 10.0), wall_mm=4.0, dome_mm=7.0)


def test_flat_pad_is_a_rounded_plate() -> None:
    """V = t (w d - (4 - pi) c^2) exactly, and the sensing side is the top."""
    shape = PadShape(width_mm=25.0, depth_mm=20.0, corner_mm=3.0, dome_mm=0.0)
    layers = Layers(elastomer_mm=3.0)
    exact = 3.0 * (500.0 - (4 - math.pi) * 9.0)
    assert slab_mm3(shape, layers) == pytest.approx(exact, rel=1e-12)
    solid = build_solid(family("pad"), shape, layers)
    assert solid.volume_mm3 == pytest.approx(exact, rel=1e-9)


def test_domed_pad_holds_what_a_fine_sum_says() -> None:
    """Mean height over a grid of 0.02 mm, good to 1e-4, for a dome of 1 mm."""
    shape, layers = PadShape(dome_mm=1.0), Layers(elastomer_mm=3.0)
    half_x, half_y = shape.width_mm / 2, shape.depth_mm / 2
    x, y = np.meshgrid(np.arange(0.01, half_x, 0.02), np.arange(0.01, half_y, 0.02))
    plan = np.column_stack([x.ravel(), y.ravel()])
    within = rectangle_distance(plan, half_x, half_y, shape.corner_mm) < 0.0
    radius = shape.sphere_mm
    height = 3.0 + 1.0 - radius + np.sqrt(radius**2 - (plan[within] ** 2).sum(axis=1))
    assert slab_mm3(shape, layers) == pytest.approx(4 * 0.02**2 * height.sum(), rel=1e-4)
    # At the farthest corner the dome has come down to the elastomer's thickness.
    corner = shape.half_diagonal_mm
    assert 1.0 - radius + math.sqrt(radius**2 - corner**2) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("name", ["outer", "membrane"])
def test_a_steep_dome_on_a_high_pad_cuts_only_its_top(name: str) -> None:
    """Sphere of 9.9 mm on a gel 24 mm up: the prism below stays whole, by kernel and fields."""
    shape = PadShape(width_mm=10.7, depth_mm=12.0, corner_mm=2.0, dome_mm=3.15, standoff_mm=24.0)
    layers = Layers(elastomer_mm=2.4, support_mm=2.0)
    area = 10.7 * 12.0 - (4 - math.pi) * 4.0
    below = 24.0 * area if name == "outer" else 0.0
    exact = slab_mm3(shape, layers) + below
    assert getattr(pad.FAMILY.build(shape, layers), name).volume == pytest.approx(exact, rel=1e-5)
    # A grid of 0.3 mm is good to 4e-4.
    if name == "membrane":
        fields = pad.FAMILY.fields(shape, layers)
        assert coarse_volume_mm3(fields, 0.3) == pytest.approx(exact, rel=2e-3)


def test_loaf_has_the_volume_of_prism_and_quarter_ellipsoids() -> None:
    """2 a w s + pi/2 a d s + pi/2 a (f + b) (w + 2/3 d) = 3182.0 mm3 by the kernel, to 1e-6."""
    exact = 2 * 10 * 4 * 6 + math.pi / 2 * 10 * 7 * 6 + math.pi / 2 * 10 * 15 * (4 + 14 / 3)
    assert LOAF.volume_mm3 == pytest.approx(exact, rel=1e-12)
    assert loaf_body(LOAF).volume == pytest.approx(exact, rel=1e-6)
    inside = dataclasses.replace(LOAF, half_mm=8.8, ends_mm=(3.8, 8.8), dome_mm=5.8)
    shell = loaf_shell(LOAF, inside)
    assert shell.volume == pytest.approx(exact - inside.volume_mm3, rel=1e-6)


@pytest.mark.parametrize("change", [{"wall_mm": 0.0}, {"straight_mm": (1.0, 1.0)}])
def test_a_loaf_may_have_no_wall_and_no_straight_part(change: dict[str, Any]) -> None:
    """Half an ellipsoid on a wall, or half a dome on the plane: both as in closed form."""
    loaf = dataclasses.replace(LOAF, **change)
    assert loaf_body(loaf).volume == pytest.approx(loaf.volume_mm3, rel=1e-6)
    assert loaf.prism(-2.0, 1.0).volume == pytest.approx(3.0 * loaf.area_mm2, rel=1e-6)


def test_loaf_field_is_zero_on_its_roof() -> None:
    """Points on the roof have distance 0; 0.1 mm above the ridge it is 0.1 mm to first order."""
    plan = np.array([[0.0, 0.0], [3.0, 4.0], [9.0, 1.0], [0.0, 12.5], [4.0, -5.5], [0.0, -6.9]])
    roof = np.column_stack([plan, LOAF.roof_mm(plan)])
    assert LOAF.distance(roof) == pytest.approx([0.0] * 6, abs=1e-12)
    # k (k - 1) / |grad k| with k = 7.1 / 7: second order is 1.4 % of 0.1 mm.
    assert LOAF.distance(np.array([[0.0, 0.0, 11.1]]))[0] == pytest.approx(0.1, rel=0.03)


def test_rectangle_distance_is_exact() -> None:
    """4 x 2 with corners of 0.5: beside a side, off a corner's centre, and in the middle."""
    places = np.array([[3.0, 0.0], [2.0, 1.0], [0.0, 0.0], [1.5 + 0.3, 0.5 + 0.4]])
    found = rectangle_distance(places, 2.0, 1.0, 0.5)
    assert found == pytest.approx([1.0, math.hypot(0.5, 0.5) - 0.5, -1.0, 0.0], abs=1e-12)


def test_digitac_pins_are_marked_one_by_one() -> None:
    """Each tip is a disc of pi r^2 at its height; skin without pins is backed above the clamp."""
    shape = resolve_shape("digitac", {"pin_rows": 3.0, "pin_columns": 3.0})
    layers = Layers(elastomer_mm=1.2)
    solid = build_solid(family("digitac"), shape, layers)
    membrane = solid.membrane
    assert len(solid.tips_mm) == 9 - 4
    assert solid.tip_radius_mm == shape.pin_radius_mm
    assert solid.backing_mm == pytest.approx(shape.pin_length_mm + shape.pin_gap_mm)
    area = face_areas(membrane.points_mm, membrane.faces)
    corners = membrane.points_mm[membrane.faces]
    pins = membrane.has(Label.PIN)
    for number, tip in enumerate(solid.tips_mm):
        own = pins & (membrane.numbers == number)
        flat = own & (np.abs(corners[:, :, 2] - tip[2]).max(axis=1) < 1e-6)
        # Chords of 0.1 rad: 2e-3 of a disc.
        assert area[flat].sum() == pytest.approx(math.pi * shape.pin_radius_mm**2, rel=0.02)
    backed = membrane.has(Label.BACKED)
    assert not np.any(backed & membrane.has(Label.OUTER))
    assert corners[backed & ~pins][:, :, 2].min() == pytest.approx(shape.clamp_mm, abs=1e-6)


def test_corner_pins_are_left_out() -> None:
    """Of 5 x 7 pins those that reach beyond 80 % of the dome are missing."""
    shape, layers = DigitacShape(), Layers(elastomer_mm=1.2)
    pins = np.array(shape.pins(layers).tips_mm)
    inside = shape.loaf(1.2)
    assert 0 < len(pins) < 35
    assert inside.share(pins[:, :2]).max() <= 0.8
    assert pins[:, 2] == pytest.approx(inside.roof_mm(pins[:, :2]) - shape.pin_length_mm)


@pytest.mark.parametrize(
    ("module", "name", "boolean", "feature", "says"),
    [
        (digitac, "digitac", "fuse", "pins to the skin", "skin: 0 of"),
        (digitac, "digitac", "cut", "pins from the core", "core: 0 of"),
        (pad, "pad", "intersect", "dome", "gel slab: expected"),
    ],
)
def test_a_kernel_that_returns_the_uncut_body_is_found_out(
    monkeypatch: pytest.MonkeyPatch, module: Any, name: str, boolean: str, feature: str, says: str
) -> None:
    """The boolean's own checks are taken away too: the family's check must still see it."""
    broken, shape = (module, boolean, feature), {"dome_mm": 9.0 if name == "digitac" else 1.0}
    expect_found_out(monkeypatch, (name, shape), Layers(elastomer_mm=1.2), broken, says)


@pytest.mark.parametrize(
    ("name", "shape", "layers", "at"),
    [
        ("pad", {"corner_mm": 8.0, "depth_mm": 12.0}, {}, "shape.corner_mm"),
        ("pad", {"standoff_mm": 8.0}, {"support_mm": 4.5}, "layers.support_mm"),
        ("digitac", {"length_mm": 19.0, "back_mm": 9.7}, {}, "shape.length_mm"),
        ("digitac", {"pin_rows": 2.0, "pin_columns": 2.0}, THIN, "shape.pin_rows"),
        ("digitac", {"dome_mm": 15.0, **WIDE_PINS}, THIN, "shape.pin_length_mm"),
        (
            "digitac",
            {**LOW, "dome_mm": 6.0, "pin_gap_mm": 0.2, **LONG_PINS},
            THIN,
            "shape.pin_gap_mm",
        ),
        ("digitac", {"pin_rows": 2.5}, {}, "shape.pin_rows"),
        (
            "digitac",
            {**LOW, "width_mm": 24.0, "pin_length_mm": 3.0},
            {"elastomer_mm": 3.0},
            "shape.dome_mm",
        ),
        ("digitac", {"back_mm": 4.5}, {}, "shape.back_mm"),
        ("digitac", {"clamp_mm": 6.0}, {"elastomer_mm": 1.0}, "shape.clamp_mm"),
        (
            "digitac",
            {"pin_rows": 9.0, "pin_radius_mm": 1.0},
            {"elastomer_mm": 1.0},
            "shape.pin_rows",
        ),
    ],
)
def test_contradictions_are_refused_with_their_place(
    name: str, shape: dict[str, float], layers: dict[str, float], at: str
) -> None:
    """Each names value, limit and unit, and what to change."""
    expect_refusal(name, shape, layers, at)


def test_every_accepted_pin_is_clear_of_window_and_skin() -> None:
    """On 3000 places of each tip's disc: 0.1 mm or more of pin, and no point inside the window."""
    layers = Layers(elastomer_mm=1.2)
    random = np.random.default_rng(2)
    radius, turn = np.sqrt(random.uniform(0.0, 1.0, 3000)), random.uniform(0.0, 2 * np.pi, 3000)
    disc = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.zeros(3000)])
    accepted = 0
    for _ in range(300):
        shape = DigitacShape(
            dome_mm=random.uniform(5.0, 15.0),
            pin_radius_mm=random.uniform(0.3, 1.0),
            pin_length_mm=random.uniform(0.5, 3.0),
            pin_gap_mm=random.uniform(0.2, 1.0),
            pin_rows=float(random.integers(1, 6)),
            pin_columns=float(random.integers(1, 8)),
        )
        try:
            digitac.FAMILY.check(shape, layers)
        except DesignError:
            continue
        accepted += 1
        tips = np.array(shape.pins(layers).tips_mm)
        places = (tips[:, None] + shape.pin_radius_mm * disc).reshape(-1, 3)
        window = shape.loaf(layers.elastomer_mm + shape.gap_mm)
        height = np.where(window.share(places) < 1.0, places[:, 2] - window.roof_mm(places), 9.0)
        # The rim is looked at in 32 places: the farthest out is missed by 0.5 % of its radius.
        assert height.min() > 0.09
        inside = shape.loaf(layers.elastomer_mm)
        assert (inside.roof_mm(places) - places[:, 2]).min() > 0.09
    assert accepted > 30


def test_the_narrow_side_is_named_with_its_own_limit() -> None:
    """Half of 16 mm less 5.7 mm of walls is 2.3 mm, and 2.5 mm are needed there."""
    shape = DigitacShape(width_mm=16.0, dome_mm=12.0, wall_mm=6.0, back_mm=9.7)
    with pytest.raises(DesignError, match=r"2\.3 mm of the half width of 8 mm, less than 2\.5 mm"):
        digitac.FAMILY.check(shape, Layers(support_mm=2.0, elastomer_mm=2.0))


@pytest.mark.slow
def test_support_points_of_a_digitac_lie_on_its_window(
    made: Callable[[SensorDesign, str], Any],
) -> None:
    """The gap from the skin, the roots of pins as well, whose sides once made it 0.3 mm."""
    from scipy.spatial import cKDTree

    from sim.contact.region.backing import backed_faces, bonded_faces, support_points_mm

    # As thick as in other tests, which share the mesh.
    shape, layers = DigitacShape(), Layers(elastomer_mm=1.2)
    mesh = made(SensorDesign(family="digitac", layers=layers), "mesh")
    bonded = len(np.unique(mesh.inner.faces[bonded_faces(mesh)]))
    assert backed_faces(mesh).any()
    skin = cKDTree(_dense_points_mm(shape.loaf(layers.elastomer_mm)))
    gap_mm, _ = skin.query(support_points_mm(mesh)[bonded:])
    # Chords of the mesh: +-0.021 mm.
    assert np.abs(gap_mm - shape.gap_mm).max() < 0.03


def _dense_points_mm(loaf: Loaf) -> np.ndarray:
    """Points of a loaf's dome by its closed form, at most 0.04 mm apart, shape (N, 3)."""
    across, end = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 701), np.linspace(0.0, 0.5 * np.pi, 401)
    low, high = loaf.straight_mm
    share = np.concatenate([np.sin(end[::-1]), np.zeros(401), np.sin(end)])
    y = np.concatenate(
        [
            low - loaf.ends_mm[0] * np.sin(end[::-1]),
            np.linspace(low, high, 401),
            high + loaf.ends_mm[1] * np.sin(end),
        ]
    )
    around = np.sqrt(1.0 - share**2)[:, None] * np.sin(across)[None]
    upward = np.sqrt(1.0 - share**2)[:, None] * np.cos(across)[None]
    x, z = loaf.half_mm * around, loaf.wall_mm + loaf.dome_mm * upward
    return np.stack([x, np.broadcast_to(y[:, None], x.shape), z], axis=-1).reshape(-1, 3)
