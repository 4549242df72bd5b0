"""Our bodies beside the released ones: what fits is found, what does not fit fails."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from geometry.surface.spread import spread
from sim.contact.objects.object_measures import exact_distance
from workbench.edit.indenter_choice import choose_indenter
from workbench.proof.validation.published import indenters, membranes
from workbench.proof.validation.published.alignment import laid_on, right_turns
from workbench.proof.validation.published.apart import distances_mm, ellipsoid
from workbench.proof.validation.published.released import CUTS, FILE, Skin, indenter, membrane

LIMITS = {family: membranes.LOOSER.get(family, (0.25, 0.8)) for family in membranes.PRESETS}
SOME_TURN = Rotation.from_rotvec([0.5, -1.9, 0.8]).as_matrix()


def turned(skin: Skin) -> Skin:
    """Somewhere else, without its cuts."""
    return Skin(points_mm=skin.points_mm @ SOME_TURN.T + [3.0, -8.0, 21.0], faces=skin.faces)


def test_the_file_holds_every_body_and_says_whose_they_are() -> None:
    """Six membranes and fourteen indenters in less than 400 kB, with the notice beside them."""
    with np.load(FILE) as kept:
        names = {name.rpartition("/")[0] for name in kept.files}
    said = {f"membranes/{family}" for family in CUTS} | {f"indenters/{n}" for n in indenters.NAMES}
    assert names == said
    assert len(indenters.NAMES) == 14
    assert FILE.stat().st_size < 400_000
    assert "MIT License" in (FILE.parent / "NOTICE.md").read_text()


def test_there_are_24_right_turns() -> None:
    """Proper, and no two the same."""
    turns = right_turns()
    assert all(np.linalg.det(turn) == pytest.approx(1.0) for turn in turns)
    assert len({tuple(turn.ravel()) for turn in turns}) == 24


@pytest.mark.parametrize("family", ["thumb", "tentacle", "paw", "digitac"])
def test_a_body_that_stands_elsewhere_is_found(family: str) -> None:
    """The released skin turned by two rad and moved by 23 mm: laid back within micrometres."""
    released = membrane(family)
    assert distances_mm(laid_on(turned(released), released), released).max() < 1e-2


def test_nothing_is_scaled_and_nothing_mirrored() -> None:
    """A wedge of sides 3, 5 and 8 is found; 1.2 times as large or in a mirror it is not."""
    points = np.array([[0.0, 0, 0], [3, 0, 0], [0, 5, 0], [0, 0, 8]])
    wedge = Skin(points_mm=points, faces=np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))
    mirrored = Skin(points_mm=points * [-1.0, 1.0, 1.0], faces=wedge.faces[:, ::-1])
    found = [membranes.measured_mm(turned(skin), wedge).mean() for skin in (wedge, mirrored)]
    larger = Skin(points_mm=1.2 * points, faces=wedge.faces)
    assert found[0] < 1e-3
    assert found[1] > 0.05
    assert membranes.measured_mm(turned(larger), wedge).mean() > 0.1


def test_faces_in_a_cut_are_left_out() -> None:
    """The pad's block with and without its underside scores the same; a lid is not left out."""
    block = membranes.released_skin("pad")
    low, high = block.points_mm.min(axis=0), block.points_mm.max(axis=0)
    corners = np.array([[x, y] for x in (low[0], high[0]) for y in (low[1], high[1])])
    square = np.array([[0, 2, 3], [0, 3, 1]])

    def closed(height_mm: float) -> Skin:
        more = np.column_stack([corners, np.full(4, height_mm)])
        faces = np.vstack([block.faces, square + len(block.points_mm)])
        return Skin(points_mm=np.vstack([block.points_mm, more]), faces=faces)

    assert distances_mm(closed(low[2]), block).max() < 1e-9
    assert distances_mm(closed(high[2] + 3.0), block).mean() > 0.25


def test_the_finger_is_the_released_one() -> None:
    """A tessellated cylinder and hemisphere beside another: hundredths of a millimetre."""
    found = membranes.measured_mm(membranes.preset_skin("geltip"), membrane("finger"))
    assert found.mean() < 0.02
    assert np.percentile(found, 95) < 0.05


@pytest.mark.parametrize("family", list(membranes.PRESETS))
def test_wrong_bodies_fail(family: str) -> None:
    """The ellipsoid of the box, the skin a tenth too large and another family's miss both limits.

    A body that is only too long where it is straight is not found so: it slides along itself.
    """
    released = membranes.released_skin(family)
    mean_mm, outer_mm = LIMITS[family]
    larger = Skin(points_mm=1.1 * released.points_mm, faces=released.faces)
    other = membranes.released_skin("trunk" if family == "paw" else "paw")
    for wrong in (ellipsoid(released), larger, other):
        found = membranes.measured_mm(wrong, released)
        assert found.mean() > mean_mm
        assert np.percentile(found, 95) > outer_mm


@pytest.mark.parametrize(("file", "name"), list(indenters.NAMES.items()))
def test_heads_are_the_released_ones(file: str, name: str) -> None:
    """Sharp, the file's places are on the surface but for chords of its arcs; as pressed, 0.05 mm.

    A chord of the coarsest file, over 10 degrees at 3.5 mm, leaves the arc by 0.013 mm.
    """
    head = indenter(file)
    places = spread(head.points_mm, head.faces, 3000).points_mm[:, [1, 2, 0]] - [0.0, 0.0, 20.0]
    sharp = np.abs(exact_distance(choose_indenter(name, edge_radius_mm=0.0))(places))
    assert sharp.max() < 0.02
    assert np.abs(exact_distance(choose_indenter(name))(places)).mean() < 0.05


@pytest.mark.parametrize(
    ("file", "wrong"),
    [
        ("Cube", "cube"),
        ("X", "released_flower"),
        ("Diamond", "released_ellipsoid"),
        ("Cylinder", "released_pacman"),
    ],
)
def test_wrong_heads_fail(file: str, wrong: str) -> None:
    """The scalable cube, and heads that look alike: several times the limit."""
    assert indenters.head_mm(wrong, file) > 4.0 * indenters.MEAN_MM


def test_rows_are_the_contract() -> None:
    """Names, cases and limits that others read."""
    rows = indenters.rows()
    assert [row.case for row in rows] == list(indenters.NAMES)
    assert {(row.name, row.unit, row.limit) for row in rows} == {("indenter_shape", "mm", 0.05)}
    assert all(row.ok and row.null is not None and row.null > 5.0 * row.limit for row in rows)
    assert list(LIMITS) == ["finger", "trunk", "paw", "thumb", "tentacle", "pad", "digitac"]
    assert LIMITS["thumb"] == (0.4, 1.2)
