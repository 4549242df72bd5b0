"""The paper's 14 indenters, as released too, and two more: distances, volumes, rounding, meshes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from geometry.surface.surface import is_watertight, mesh_volume
from sim.contact.motion.approach import plan_approach
from sim.contact.objects.collider import make_collider
from sim.contact.objects.object_measures import exact_distance, lowest_mm
from sim.contact.studies.specimens import flat_block
from workbench.core.base.errors import DesignError
from workbench.core.objects.kind import kind_of
from workbench.core.objects.kinds import cross, hexagon, rhombus, triangle
from workbench.core.objects.plane import inset, polygon
from workbench.core.press.indenter import SEEN, UNSEEN, Indenter, IndenterKind, widest_edge_mm
from workbench.core.press.press import Press
from workbench.edit.indenter_choice import choose_indenter
from workbench.live.indenter_display import display_mesh

KINDS = [kind for kind in IndenterKind if not kind_of(kind).of_triangles]
NEW = [kind for kind in IndenterKind if kind_of(kind).distance is not None]
BLOCK, _ = flat_block(width_mm=16.0, height_mm=4.0, grid_mm=1.0)


def places(count: int = 3000, reach_mm: float = 4.5) -> np.ndarray:
    return np.random.default_rng(7).uniform(-reach_mm, reach_mm, (count, 3))


def flower_share() -> float:
    """Five times a kite from the middle to two notches and the sector of the petal's arc."""
    radius, sector = 0.19, np.pi / 5
    centre = 0.5 - radius
    notch = centre * np.cos(sector) + np.sqrt(radius**2 - (centre * np.sin(sector)) ** 2)
    half = np.arctan2(notch * np.sin(sector), notch * np.cos(sector) - centre)
    return float(5 * (centre * notch * np.sin(sector) + half * radius**2))


AREA_SHARES = {
    IndenterKind.HEXAGON: 3 * 3**0.5 / 8,
    IndenterKind.TRIANGLE: 3**0.5 / 4,
    IndenterKind.RHOMBUS: 0.3,
    IndenterKind.CROSS: 0.51,
    IndenterKind.PACMAN: 5 / 6 * np.pi / 4,
    IndenterKind.RING: np.pi / 4 * (1 - 0.25),
    IndenterKind.DOUBLE_CYLINDER: np.pi / 2 * 0.45**2,
    IndenterKind.FLOWER: flower_share(),
}
"""Sharp cross-sections over the square of the size: closed forms."""


def triangle_mm2() -> float:
    """An equilateral core, three strips along its sides, and a disc of the corners."""
    radius, core = 0.5, 2.4641
    side = 3**0.5 * core
    return 3**0.5 / 4 * side**2 + 3 * side * radius + np.pi * radius**2


RELEASED_MM3 = {
    "cube": 160.0,
    "cylinder": np.pi * 3.5**2 * 10,
    "cylinder_side": 6 * (4 * 8 + np.pi * 2**2 / 2),
    "diamond": 200.0,
    "double_cylinder_side": 6 * (6 * 8.5 + np.pi * 1.5**2),
    "ellipsoid": np.pi * 8 * 10,
    "ellipsoid_circle": (np.pi * 16 / 2 + np.pi * 8 / 2) * 10,
    "flower": (16 + 4 * 0.75 * np.pi * 4) * 10,
    "hexagon": (6 * 3.5 + 6 * (3.5528 - 1.75)) * 10,
    "pacman": np.pi * 9 * 29 / 36 * 10,
    # The ball without the cap inside the neck, and the neck from where it leaves the ball.
    "sphere": np.pi * (36 - 0.463 + 2.25 * 4.402),
    # The round end is 0.45 mm deep in the mean over the square.
    "sphere_r27": 1440 - 64.76,
    "triangle": triangle_mm2() * 10,
    "x": (64 - 4 * 4) * 10,
}
"""Volumes of sharp released heads in their own sizes: closed forms."""


def sharp_volume_mm3(indenter: Indenter) -> float:
    """Volume of a kind that is sampled, without rounding or texture [mm3]: a closed form."""
    size_mm = indenter.size_mm
    own_mm = indenter.record.own_mm
    if own_mm is not None:
        return RELEASED_MM3[indenter.kind.removeprefix("released_")] * (size_mm / own_mm) ** 3
    if indenter.kind is IndenterKind.ELLIPSOID:
        return np.pi / 6.0 * size_mm**3 * 0.35
    if indenter.kind is IndenterKind.TORUS:
        tube = 0.15 * size_mm
        return 2.0 * np.pi**2 * (0.5 * size_mm - tube) * tube**2
    if indenter.kind is IndenterKind.DIAMOND:
        return size_mm**3 / 6.0
    return AREA_SHARES[indenter.kind] * size_mm**3


def test_table_holds_the_papers_fourteen_in_order() -> None:
    """Ten seen, four unseen, none twice; every kind can be chosen by its name."""
    names = " ".join(kind.value for kind in (*SEEN, *UNSEEN))
    assert names == (
        "cross triangle pacman hexagon ellipsoid double_cylinder cylinder_end cylinder_side "
        "cube sphere diamond flower ring rhombus"
    )
    assert (len(SEEN), len(UNSEEN)) == (10, 4)
    assert all(choose_indenter(kind.value).kind is kind for kind in KINDS)
    assert choose_indenter("X").kind is IndenterKind.CROSS


@pytest.mark.parametrize("kind", NEW)
def test_exact_distance_has_slope_one(kind: IndenterKind) -> None:
    """Central differences of 1e-5 mm: 1, but for 1 place in 100 beside the medial axis."""
    function, where = exact_distance(Indenter(kind=kind)), places()
    steps = 1e-5 * np.eye(3)
    rise = [(function(where + step) - function(where - step)) / 2e-5 for step in steps]
    slope = np.linalg.norm(rise, axis=0)
    assert slope.max() < 1.0 + 1e-4
    assert np.mean(np.abs(slope - 1.0) > 1e-3) < 0.01


@pytest.mark.parametrize("kind", NEW)
def test_sampled_distance_is_the_exact_one(kind: IndenterKind) -> None:
    """Within half a millimetre of the surface: 2 um in the median, a fifth of a sample at worst."""
    indenter, where = Indenter(kind=kind), places()
    exact = exact_distance(indenter)(where)
    near = np.abs(exact) < 0.5
    error = np.abs(make_collider(indenter, grid_mm=0.5).distance(where)[0] - exact)[near]
    assert np.median(error) < 2e-3
    # At creases of the distance the spline is off by its samples' spacing of 0.2 mm, times 0.2.
    assert error.max() < 0.045


@pytest.mark.parametrize("kind", NEW)
def test_far_away_the_distance_is_a_positive_lower_bound(kind: IndenterKind) -> None:
    """20 mm about a 6 mm object: never more than the exact distance, never below zero."""
    indenter, where = Indenter(kind=kind), places(reach_mm=20.0)
    exact, found = (
        exact_distance(indenter)(where),
        make_collider(indenter, grid_mm=0.5).distance(where)[0],
    )
    outside = exact > 1.5
    assert (found[outside] > 0.0).all()
    assert (found[outside] < exact[outside] + 0.02).all()


@pytest.mark.parametrize("kind", NEW)
def test_volume_is_the_closed_form(kind: IndenterKind) -> None:
    """Sharp shapes of 6 mm; contoured at 0.1 mm, which cuts their edges: 1.5 %."""
    indenter = Indenter(kind=kind, edge_radius_mm=0.0)
    points, faces = display_mesh(indenter)
    assert mesh_volume(points, faces) == pytest.approx(sharp_volume_mm3(indenter), rel=0.015)


@pytest.mark.parametrize("module", [cross, hexagon, rhombus, triangle])
def test_polygons_have_the_area_of_the_closed_form(module: Any) -> None:
    """Shoelace of the corners: 0.51, 3 sqrt 3 / 8, 0.3 and sqrt 3 / 4 of the square of the size."""
    x, y = module.corners_mm(6.0).T
    shoelace_mm2 = 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    kind = IndenterKind(module.__name__.rpartition(".")[2])
    assert shoelace_mm2 == pytest.approx(36.0 * AREA_SHARES[kind], rel=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_display_mesh_is_the_zero_of_the_contact_distance(kind: IndenterKind) -> None:
    """Closed, outward, and within 0.05 mm of the surface that a 0.5 mm grid feels."""
    indenter = Indenter(kind=kind)
    points, faces = display_mesh(indenter)
    assert is_watertight(faces)
    assert mesh_volume(points, faces) > 0.0
    assert np.abs(make_collider(indenter, grid_mm=0.5).distance(points)[0]).max() < 0.05


@pytest.mark.parametrize("kind", NEW)
def test_largest_width_is_the_size(kind: IndenterKind) -> None:
    """No place of a sharp 6 mm object lies farther than 6 mm from another, in plan."""
    points, _ = display_mesh(Indenter(kind=kind, edge_radius_mm=0.0))
    angle = np.linspace(0.0, np.pi, 60, endpoint=False)
    widths = np.ptp(points[:, :2] @ np.stack([np.cos(angle), np.sin(angle)]), axis=0)
    # A triangle's largest width is its side, a cross's the diagonal over both bars' ends, which
    # is sqrt(1 + 0.3^2) of a bar; contouring cuts sharp tips.
    bound = {IndenterKind.CROSS: 6.0 * 1.09**0.5}.get(kind, 6.0)
    if kind_of(kind).own_mm is not None:
        # Released heads are measured along X and Y, as they are drawn.
        widths = np.ptp(points[:, :2], axis=0)
    assert widths.max() < bound + 1e-6
    assert widths.max() > 0.9 * bound


@pytest.mark.parametrize("kind", NEW)
def test_first_touch_of_a_flat_skin_is_the_lowest_place(kind: IndenterKind) -> None:
    """The origin stands as high as the body reaches down; samples ring by 4 um beside edges."""
    indenter = Indenter(kind=kind)
    collider = make_collider(indenter, grid_mm=0.5)
    touch = plan_approach(BLOCK.outer, collider, Press(target_mm=(0.13, -0.07, 4.0))).touch_mm
    assert touch == pytest.approx(lowest_mm(indenter), abs=6e-3)
    assert collider.half_height_mm == lowest_mm(indenter)


def test_rounded_edge_has_its_radius() -> None:
    """Places on the bisector of a hexagon's upright edge at 0.45 mm: cut back by r (2/sqrt 3 - 1).

    And on the rim of a face, 45 degrees to it, by r (sqrt 2 - 1).
    """
    function = exact_distance(Indenter(kind=IndenterKind.HEXAGON, edge_radius_mm=0.45))
    corner = function(np.array([[3.0, 0.0, 0.0]]))
    assert corner[0] == pytest.approx(0.45 * (2 / 3**0.5 - 1))
    flat = 3.0 * 3**0.5 / 2
    assert function(np.array([[0.0, flat, -3.0]]))[0] == pytest.approx(0.45 * (2**0.5 - 1))


def test_inset_moves_sides_by_the_distance() -> None:
    """Corners of an L moved in by 0.2: every one is at depth 0.2, the re-entrant one too."""
    corners = np.array([[0.0, 0.0], [4, 0], [4, 2], [2, 2], [2, 4], [0, 4]])
    moved = inset(corners, 0.2)
    depth = -polygon(moved, corners)
    np.testing.assert_allclose(np.delete(depth, 3), 0.2, atol=1e-12)
    # Beside a re-entrant corner the distance is to that corner.
    np.testing.assert_allclose(moved[3], [1.8, 1.8])


@pytest.mark.parametrize("kind", NEW)
def test_edge_radius_has_a_limit_by_kind(kind: IndenterKind) -> None:
    """At the limit something is left; beyond it, the field is named. Edgeless kinds ignore it."""
    if kind in (IndenterKind.ELLIPSOID, IndenterKind.TORUS):
        assert Indenter(kind=kind, edge_radius_mm=9.0).edge_radius_mm == 9.0
        return
    widest = widest_edge_mm(kind, 6.0)
    low = lowest_mm(Indenter(kind=kind, edge_radius_mm=widest))
    assert low > 1.0
    function = exact_distance(Indenter(kind=kind, edge_radius_mm=widest))
    assert (function(places()) < 0.0).any()
    with pytest.raises(DesignError, match="edge radius") as caught:
        Indenter(kind=kind, edge_radius_mm=1.01 * widest)
    assert caught.value.at == "indenter.edge_radius_mm"
