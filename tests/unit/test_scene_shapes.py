"""Clicks, regions and histograms of the live view on a cube whose answers are known."""

from __future__ import annotations

import numpy as np
import pytest

from geometry.surface.surface_place import SkinPlace
from ui.panels.make.checks import amount, line, said
from ui.panels.mesh.page import steps
from workbench.core.result.fabrication import FabricationCheck, Severity
from workbench.core.result.results import Label, LabelledSurface, Skin, VolumeMesh
from workbench.edit.forms import choices, purpose
from workbench.view.scene_shapes import (
    SLANT_COSINES,
    cell_edges,
    clear_view,
    contact_side,
    first_hit,
    mesh_edges,
    skin_parts,
)

USUAL = np.array([0.74, 0.55, 0.39])


def cube(edge_mm: float = 2.0) -> tuple[np.ndarray, np.ndarray]:
    """A cube about the origin."""
    import trimesh

    mesh = trimesh.creation.box((edge_mm, edge_mm, edge_mm))
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


def test_click_meets_the_near_side() -> None:
    """A ray along -X from x = 5 enters a cube of edge 2 at (1, 0.3, 0.2)."""
    points, faces = cube()
    hit = first_hit(points, faces, np.array([5.0, 0.3, 0.2]), np.array([-1.0, 0.0, 0.0]))
    assert hit is not None
    # Exact but for rounding of a division.
    assert hit[1] == pytest.approx([1.0, 0.3, 0.2], abs=1e-12)
    assert (points[faces[hit[0]], 0] == 1.0).all()


def test_click_beside_or_from_inside_meets_nothing() -> None:
    """A ray that passes the cube, or leaves it from within, has no entry."""
    points, faces = cube()
    along = np.array([-1.0, 0.0, 0.0])
    assert first_hit(points, faces, np.array([5.0, 1.5, 0.0]), along) is None
    assert first_hit(points, faces, np.zeros(3), along) is None


@pytest.mark.parametrize("side", [(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
def test_a_place_is_seen_from_its_own_side(side: tuple[float, float, float]) -> None:
    """The middle of a cube's side is seen from before that side, whichever it is."""
    toward = clear_view(*cube(), np.array(side), 20.0)
    assert toward @ np.array(side) > 0.5
    assert np.linalg.norm(toward) == pytest.approx(1.0)


def test_a_place_inside_is_seen_through_the_thinner_wall() -> None:
    """0.1 mm under the side at +Y of a cube of 20 mm: the eye is at +Y, not in front."""
    toward = clear_view(*cube(20.0), np.array([0.0, 9.9, 0.0]), 100.0)
    assert toward[1] > 0.5


@pytest.mark.parametrize(
    "normal", [(1.0, 0, 0), (-1.0, 0, 0), (0, -1.0, 0), (0, 0, 1.0), (0, 0.6, 0.8)]
)
def test_a_contact_is_seen_beside_its_object(normal: tuple[float, float, float]) -> None:
    """On a ball of 10 mm: the eye is above and aslant, whichever side is pressed."""
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=3, radius=10.0)
    place = SkinPlace(10.0 * np.array(normal), 0.0, 0, np.array(normal))
    way = contact_side(np.asarray(ball.vertices), np.asarray(ball.faces), place, USUAL)
    low, high = SLANT_COSINES
    # Directions are 22.5 degrees apart.
    assert low - 0.1 < way @ place.normal < high + 0.1
    assert way[2] > 0.0
    assert np.linalg.norm(way) == pytest.approx(1.0, abs=0.01)


def test_a_contact_behind_a_wall_is_seen_past_it() -> None:
    """A wall stands between the usual side and a contact on a floor: the eye goes round it."""
    import trimesh

    wall = trimesh.creation.box((1.0, 30.0, 40.0))
    wall.apply_translation((6.0, 10.0, 0.0))
    place = SkinPlace(np.zeros(3), 0.0, 0, np.array([0.0, 0.0, 1.0]))
    way = contact_side(np.asarray(wall.vertices), np.asarray(wall.faces), place, USUAL)
    met = first_hit(np.asarray(wall.vertices), np.asarray(wall.faces), np.zeros(3), way)
    assert met is None


def test_regions_are_drawn_once_each() -> None:
    """A cube with a driven top, a flat foot on z = 0: skin 8 triangles, actuator 2, foot none."""
    points, faces = cube()
    points = points + np.array([0.0, 0.0, 1.0])
    height = points[faces][:, :, 2]
    labels = np.full(len(faces), Label.OUTER, dtype=np.uint8)
    labels[(height == 2.0).all(axis=1)] |= np.uint8(Label.ACTUATOR)
    labels[(height == 0.0).all(axis=1)] = Label.BASE
    numbers = np.where(labels & Label.ACTUATOR, 3, -1).astype(np.int16)
    surface = LabelledSurface(points_mm=points, faces=faces, labels=labels, numbers=numbers)
    drawn = {name: len(triangles) for name, (_, triangles) in skin_parts(surface).items()}
    assert drawn == {"skin": 8, "actuator_3": 2}


@pytest.mark.parametrize(("corners", "edges"), [(3, 3), (4, 6), (8, 12)])
def test_cells_have_their_edges(corners: int, edges: int) -> None:
    """Triangle, tetrahedron and hexahedron have 3, 6 and 12 edges, none from a corner to itself."""
    ends = cell_edges(np.arange(3.0 * corners).reshape(corners, 3))
    assert ends.shape == (edges, 2, 3)
    assert (ends[:, 0] != ends[:, 1]).any(axis=1).all()


def test_histogram_is_in_percent() -> None:
    """Counts 1 and 3 over [0, 2] are bars of 25 and 75 %; x never falls, as the plot demands."""
    x, y = steps(np.array([0.0, 1.0, 2.0]), np.array([1, 3]))
    assert x.tolist() == [0, 0, 1, 1, 2, 2]
    assert y.tolist() == [0, 25, 25, 75, 75, 0]


def test_check_says_value_unit_and_limit() -> None:
    """A wall of 2.803 mm with 2 mm needed reads so; noise of 1e-15 degree reads 0."""
    check = FabricationCheck(
        name="minimum_wall",
        part="half_a",
        value=2.803,
        unit="mm",
        limit=2.0,
        sense="min",
        severity=Severity.GOOD,
        place_mm=(0.0, 0.0, 0.0),
        message="",
    )
    assert line(check) == "✓ minimum wall, mould half A: 2.8 mm (≥ 2)"
    values = {"value": -5e-15, "unit": "degree", "limit": -0.5}
    fields = {name: getattr(check, name) for name in check.__dataclass_fields__}
    assert amount(FabricationCheck(**{**fields, **values})) == "0 degree (≥ -0.5)"


def test_a_family_without_its_file_is_not_offered() -> None:
    """`imported` needs a file; every name that is offered says what it is for."""
    assert "imported" not in choices()
    assert {"trunk", "pad", "finger"} <= set(choices())
    assert all(purpose(name) for name in choices())


def test_edges_of_a_mesh_are_those_of_its_outside() -> None:
    """Two cubes side by side have 20 edges, all outside; a cut cube of 12 triangles has 18."""
    grid = np.stack(np.meshgrid(range(3), range(2), range(2), indexing="ij"), axis=-1)
    points = grid.reshape(-1, 3).astype(float)
    first = np.array([0, 4, 6, 2, 1, 5, 7, 3])
    mesh = VolumeMesh(
        points_mm=points,
        cells=np.stack([first, first + 4]).astype(np.int32),
        labels=np.zeros(12, np.uint8),
        quality=np.ones(2, np.float32),
        layers=1,
        volume_mm3=2.0,
    )
    edges = mesh_edges(mesh)
    assert edges.shape == (20, 2, 3)
    assert np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1) == pytest.approx(1.0)
    corners, faces = cube()
    skin = Skin(points_mm=corners, faces=faces, normals=corners)
    assert mesh_edges(skin).shape == (18, 2, 3)


def test_shares_are_told_in_percent_and_rounding_as_nought() -> None:
    """0.62 of the bed is 62 %, at most 1 is 100 %; -7e-15 mm is 0 mm; parts have their words."""
    message = "half_a: bed 0.62 of the bed, at most 1 of the bed is good; off by -7.1e-15 mm."
    check = FabricationCheck(
        name="bed",
        part="half_a",
        value=0.62,
        unit="of the bed",
        limit=1.0,
        sense="max",
        severity=Severity.GOOD,
        place_mm=(0.0, 0.0, 0.0),
        message=message,
    )
    assert amount(check) == "62 % of the bed (≤ 100 %)"
    text = "Mould half A: bed 62 % of the bed, at most 100 % of the bed is good; off by 0 mm."
    assert said(check) == text
