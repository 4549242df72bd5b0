"""Decks of other programs: what is written is the body that we solve."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
import pytest

from geometry.surface.surface import face_areas
from sim.contact.objects.collider import make_collider
from sim.fem.decks.deck import DeckCase, write_deck
from sim.fem.decks.mesh import EDGES, FACE_CORNERS, Element
from sim.fem.decks.rigid_object import NEAR_MM, near_box_mm
from sim.fem.decks.text import DeckText, carried_text, read_deck
from sim.fem.studies.blocks import flat_membrane
from workbench.core.base.errors import DesignError, SolveError, StoreError
from workbench.core.design.design import Elastomer, SensorDesign
from workbench.core.design.inclusion import Inclusion
from workbench.core.press.actuation import Actuation
from workbench.core.press.fem import FemSettings
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import Label
from workbench.project.state import State
from workbench.report.fem_case import make_deck_case

PRESS = Press(target_mm=(0.0, 0.0, 2.0), depth_mm=0.4, frames=2)


@functools.cache
def pad_case(
    *,
    element: Element = Element.C3D8I,
    press: Press = PRESS,
    material: Elastomer | None = None,
    indenter: Indenter | None = None,
    gap_mm: float = 0.0,
) -> DeckCase:
    """A ball of 6 mm on a pad of 8 x 8 x 2 mm."""
    state = State(
        design=SensorDesign(material=material or Elastomer()),
        case=PressCase(
            indenter=indenter or Indenter(),
            press=press,
            fem=FemSettings(hex_mm=1.0, radius_mm=5.0),
        ),
    )
    mesh = flat_membrane(gap_mm=gap_mm)
    inner = dataclasses.replace(mesh.inner, labels=mesh.inner.labels | np.uint8(Label.INNER))
    return make_deck_case(dataclasses.replace(mesh, inner=inner), state, element)


def corners_of(deck: DeckText, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Corners (Q, 4, 3) of a surface's faces and middles (Q, 3) of their elements [mm]."""
    places = {int(row[0]): row[1:] for row in np.vstack(list(deck.nodes.values()))}
    cells = {int(row[0]): row[1:9] for found in deck.elements.values() for row in found}
    pairs = deck.surfaces[name]
    corners = [
        [places[cells[element][corner]] for corner in FACE_CORNERS[side - 1]]
        for element, side in pairs.tolist()
    ]
    middles = [
        np.mean([places[node] for node in cells[element]], axis=0) for element in pairs[:, 0]
    ]
    return np.array(corners), np.array(middles)


@pytest.mark.parametrize("element", Element)
def test_a_deck_holds_the_nodes_elements_and_sets_of_the_part(element: Element) -> None:
    """All that is written comes back; the first eight nodes of an element are ours."""
    case = pad_case(element=element)
    deck, submodel = read_deck(write_deck(case)), case.submodel
    points_mm = submodel.body.points_mm
    np.testing.assert_array_equal(deck.nodes["NPART"][: len(points_mm), 1:], points_mm)
    assert deck.kinds == {"EMAT1": element.value, "EOBJ": "C3D6"}
    np.testing.assert_array_equal(deck.elements["EMAT1"][:, 1:9], submodel.body.elements.cells + 1)
    np.testing.assert_array_equal(deck.sets["NOUT"], np.flatnonzero(submodel.marks.outer >= 0) + 1)
    own = deck.sets["NHELD"][deck.sets["NHELD"] <= len(points_mm)]
    np.testing.assert_array_equal(own, np.flatnonzero(submodel.body.held) + 1)
    assert deck.steps == case.approach.frame_count == 2


def test_mid_edge_nodes_stand_between_their_ends() -> None:
    """Nodes 9 to 20 of each element, in the order that the programs expect."""
    deck = read_deck(write_deck(pad_case(element=Element.C3D20R)))
    places = deck.nodes["NPART"][:, 1:]
    cells = deck.elements["EMAT1"][:, 1:] - 1
    ends = places[cells[:, np.array(EDGES)]]
    np.testing.assert_allclose(places[cells[:, 8:]], ends.mean(axis=2), atol=1e-9)


def test_no_line_of_numbers_has_more_than_16_entries() -> None:
    """CalculiX drops what follows the sixteenth."""
    lines = write_deck(pad_case(element=Element.C3D20R)).splitlines()
    entries = [len([w for w in line.split(",") if w.strip()]) for line in lines if line[0] != "*"]
    assert max(entries) == 16


def test_every_face_of_the_skin_points_out_of_its_element() -> None:
    """The faces are those at the top of the pad, each the outer side of its element."""
    case = pad_case()
    corners, middles = corners_of(read_deck(write_deck(case)), "SSKIN")
    assert len(corners) == len(case.submodel.body.faces.nodes) > 0
    assert (corners[..., 2] == 2.0).all()
    assert (corners.mean(axis=1)[:, 2] > middles[:, 2]).all()


@pytest.mark.parametrize("kind", [IndenterKind.SPHERE, IndenterKind.CUBE, IndenterKind.TORUS])
def test_the_object_is_a_shell_whose_faces_look_outward(kind: IndenterKind) -> None:
    """Outer faces lie on the zero of the distance, wedges behind them have a positive volume."""
    indenter = Indenter(kind=kind)
    case = pad_case(indenter=indenter)
    collider = make_collider(indenter, grid_mm=0.25)
    shell = case.shell
    outer, inner = (shell.points_mm[part] for part in (shell.wedges[:, :3], shell.wedges[:, 3:]))
    away_mm, _ = collider.distance(outer.reshape(-1, 3))
    # A sampled distance is no exact distance at an edge: a hundredth of a step is left.
    assert np.abs(away_mm).max() < 1e-3
    middle = 0.5 * (outer.mean(axis=1) + inner.mean(axis=1))
    _, slope = collider.distance(outer.mean(axis=1))
    assert (np.einsum("ti,ti->t", outer.mean(axis=1) - middle, slope) > 0.0).all()
    turn = np.cross(outer[:, 1] - outer[:, 0], outer[:, 2] - outer[:, 0])
    assert (np.einsum("ti,ti->t", turn, inner.mean(axis=1) - outer.mean(axis=1)) > 0.0).all()
    assert face_areas(shell.points_mm, shell.wedges[:, :3]).min() > 0.0


def test_the_object_goes_where_our_solver_takes_it() -> None:
    """After the twist each node is at its place in the last pose."""
    press = dataclasses.replace(PRESS, twist_deg=20.0, shear_mm=(0.3, -0.2))
    case = pad_case(press=press)
    text = write_deck(case)
    last = text.split("*STEP")[-1].split("*BOUNDARY\n")[1].split("*NODE PRINT")[0]
    moves = np.array([line.split(",") for line in last.splitlines()], dtype=float)
    start = read_deck(text).nodes["NOBJ"]
    assert moves[::3, 0].tolist() == start[:, 0].tolist()
    origin_mm, rotation = case.approach.pose(float(case.approach.frame_count))
    ends = case.shell.points_mm @ rotation.T + origin_mm
    np.testing.assert_allclose(start[:, 1:] + moves[:, 3].reshape(-1, 3), ends, atol=1e-8)


def test_a_straight_press_moves_the_object_as_one_set() -> None:
    """0.4 mm along -Z in two steps, as total displacement."""
    steps = write_deck(pad_case()).split("*STEP")[1:]
    ways = [step.split("NOBJ, 3, 3, ")[1].split("\n")[0] for step in steps]
    np.testing.assert_allclose([float(way) for way in ways], [-0.2, -0.4], atol=1e-9)


def test_each_elastomer_has_a_material_of_its_own() -> None:
    """The default: C10 .025, D1 4.1379; a coat of 0.5 MPa, nu .45: C10 .0862, D1 1.2."""
    material = Elastomer(inclusions=(Inclusion(young_MPa=0.5, depth_mm=1.0),))
    text = write_deck(pad_case(material=material))
    found = [part.split("\n")[1].split(", ") for part in text.split("NEO HOOKE")[1:]]
    constants = np.array(found, dtype=float)
    np.testing.assert_allclose(constants, [[0.025, 4.1379], [0.08621, 1.2]], rtol=1e-4)
    deck = read_deck(text)
    height = deck.nodes["NPART"][:, 3]
    assert height[deck.elements["EMAT1"][:, 1:] - 1].max() == 1.0
    assert height[deck.elements["EMAT2"][:, 1:] - 1].min() == 1.0


def test_a_skin_on_gel_is_refused() -> None:
    """Decks have no element for it, and leaving it out would be another case."""
    with pytest.raises(DesignError, match="rest on gel") as caught:
        write_deck(pad_case(gap_mm=1.0))
    assert caught.value.at == "material.backing_MPa"


def test_an_object_that_stays_off_the_skin_is_refused() -> None:
    """A trajectory would have to touch; a driven press need not."""
    case = pad_case()
    far_mm = case.submodel.body.points_mm - np.array([0.0, 0.0, 10.0])
    with pytest.raises(SolveError, match="stays more than"):
        near_box_mm(far_mm, case.approach)


def lifted_case() -> DeckCase:
    """The pad, whose inner face is lifted by 3 mm in two frames."""
    lift = Actuation(region="inner", move_mm=(0.0, 0.0, 3.0), keys=((0.0, 0.0), (2.0, 1.0)))
    return pad_case(press=dataclasses.replace(PRESS, actuations=(lift,)))


def test_driven_skin_may_meet_more_of_the_object() -> None:
    """Skin 4 mm below the ball, which a drive could lift by 3 mm, may meet all of it."""
    case = lifted_case()
    low_mm = case.submodel.body.points_mm - np.array([0.0, 0.0, 4.0])
    low, high = near_box_mm(low_mm, case.approach)
    assert low[2] == -(3.0 + NEAR_MM)
    assert high[2] > -3.0


def test_driven_nodes_are_moved_by_prescription() -> None:
    """1.5 mm after the first frame, 3 mm after the second, and none of them is held."""
    text = write_deck(lifted_case())
    deck = read_deck(text)
    driven = deck.sets["NDRIVEN"]
    assert not set(driven) & set(deck.sets["NHELD"])
    height = deck.nodes["NPART"][driven - 1, 3]
    assert len(driven) == 81 and not height.any()
    for step, way_mm in zip(text.split("*STEP")[1:], (1.5, 3.0), strict=True):
        assert f"\n{driven[0]}, 3, 3, {way_mm:g}\n" in step


def test_what_a_deck_carries_comes_back() -> None:
    """Any text, whatever stands at the ends of the pieces."""
    text = "a | b **| c " * 40
    assert carried_text(write_deck(pad_case(), text)) == text
    with pytest.raises(StoreError, match="does not say which design"):
        carried_text(write_deck(pad_case()))


def test_a_damaged_deck_is_refused() -> None:
    """A node that lost a coordinate."""
    text = write_deck(pad_case())
    line = text.split("*NODE, NSET=NPART\n")[1].split("\n")[0]
    with pytest.raises(StoreError, match=r"damaged after \*NODE"):
        read_deck(text.replace(line, line.rpartition(",")[0], 1))
