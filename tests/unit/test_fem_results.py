"""Results of other programs: read back exactly, or refused."""

from __future__ import annotations

import numpy as np
import pytest

from sim.fem.decks.dat import read_dat
from sim.fem.decks.deck import DeckCase, skin_cells
from sim.fem.decks.mesh import Element, deck_mesh
from sim.fem.decks.results import force_field, read_table
from sim.fem.decks.stress_forces import shape_functions, shape_slopes, stress_forces
from sim.fem.elements import GAUSS
from sim.fem.studies.blocks import block
from tests.unit.test_fem_deck import pad_case
from workbench.core.base.errors import SolveError, StoreError

PRESSURE_MPa = 0.03
STRETCH = np.array([1.1, 0.9, 0.8])
"""Of the synthetic result's homogeneous deformation."""
TOTAL_N = np.array([0.25, -0.5, 2.0])


def synthetic_dat(case: DeckCase, *, steps: int = 2, stress_MPa: float = -PRESSURE_MPa) -> str:
    """A `.dat` as CalculiX 2.20 writes it: the pad stretched evenly, with one vertical stress."""
    body = case.submodel.body
    mesh = deck_mesh(body.points_mm, body.elements.cells, case.element)
    moved_mm = mesh.points_mm * (STRETCH - 1.0)
    lines: list[str] = []
    for step in range(1, steps + 1):
        time = f"{step:.7E}"
        lines += ["", f" total force (fx,fy,fz) for set NOBJ and time  {time}", ""]
        lines += ["".join(f"{value:14.6E}" for value in TOTAL_N), ""]
        lines += [f" displacements (vx,vy,vz) for set NPART and time  {time}", ""]
        lines += [
            f"{number:10}" + "".join(f"{way:14.6E}" for way in row)
            for number, row in enumerate(moved_mm.tolist(), start=1)
        ]
        head = "stresses (elem, integ.pnt.,sxx,syy,szz,sxy,sxz,syz) for set ESKIN and time"
        lines += ["", f" {head}  {time}", ""]
        components = "".join(f"{v:14.6E}" for v in (0.0, 0.0, stress_MPa, 0.0, 0.0, 0.0))
        lines += [
            f"{cell + 1:10}{point:4}{components}"
            for cell in skin_cells(case.submodel).tolist()
            for point in range(1, 9)
        ]
    return "\n".join(lines) + "\n"


def table_of(case: DeckCase, *, steps: int = 2) -> str:
    """A table in which node n moves by 0.001 n along X and bears 0.01 N along -Z."""
    nodes = np.flatnonzero(case.submodel.marks.outer >= 0) + 1
    rows = [
        f"{step},{node},{1e-3 * node},0,0,0,0,-0.01"
        for step in range(1, steps + 1)
        for node in nodes[::-1].tolist()
    ]
    return "\n".join(["step,node,ux,uy,uz,fx,fy,fz", *rows])


@pytest.mark.parametrize("count", [8, 20])
def test_shape_functions_sum_to_one_and_carry_places(count: int) -> None:
    """A linear field of the nodes' places is met exactly; slopes sum to nothing."""
    points_mm, cells = block(*[np.array([-1.0, 1.0])] * 3)
    mesh = deck_mesh(points_mm, cells, Element.C3D20R if count == 20 else Element.C3D8)
    nodes = mesh.points_mm[mesh.cells[0]]
    values = shape_functions(GAUSS, count)
    np.testing.assert_allclose(values.sum(axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(values @ nodes, GAUSS, atol=1e-12)
    slopes = np.einsum("qai,aj->qij", shape_slopes(count), nodes)
    np.testing.assert_allclose(slopes, np.tile(np.eye(3), (8, 1, 1)), atol=1e-8)


@pytest.mark.parametrize("element", Element)
def test_an_even_stress_loads_the_faces_of_a_block(element: Element) -> None:
    """Cauchy stress p on a deformed face of 1 x 3 mm: 3 p, a quarter at each corner."""
    points_mm, cells = block(np.array([0.0, 1.0]), np.array([0.0, 3.0]), np.array([0.0, 2.0]))
    mesh = deck_mesh(points_mm, cells, element)
    stress = np.zeros((1, 8, 3, 3))
    stress[..., 2, 2] = PRESSURE_MPa
    found = mesh.gathered(stress_forces(mesh.points_mm, mesh.cells, stress))
    exact = np.where(points_mm[:, 2] > 0.0, 1.0, -1.0) * 3.0 * PRESSURE_MPa / 4.0
    np.testing.assert_allclose(found[:, 2], exact, rtol=1e-8)
    np.testing.assert_allclose(found[:, :2], 0.0, atol=1e-10)


@pytest.mark.parametrize("element", [Element.C3D8I, Element.C3D20R])
def test_a_dat_gives_forces_and_displacements_on_the_skin(element: Element) -> None:
    """An even stress presses with p times the deformed area; the object gets minus the total."""
    case = pad_case(element=element)
    submodel = case.submodel
    vertices = int(submodel.marks.outer.max()) + 1
    found = force_field(read_dat(synthetic_dat(case), case), case, vertices, 1.0)
    np.testing.assert_array_equal(found.reaction_N, np.stack([-TOTAL_N] * 2))
    members = submodel.marks.outer >= 0
    moved_mm = submodel.body.points_mm[members] * (STRETCH - 1.0)
    places = submodel.marks.outer[members]
    np.testing.assert_allclose(found.displacement_mm[1, places], moved_mm, atol=1e-6)
    # A vertex amid four whole faces of 1 mm bears p on one square millimetre times the stretch.
    middle = np.flatnonzero((np.abs(submodel.body.points_mm) <= [1.0, 1.0, 9.0]).all(axis=1))
    inside = submodel.marks.outer[middle][submodel.marks.outer[middle] >= 0]
    exact_N = -PRESSURE_MPa * STRETCH[0] * STRETCH[1]
    assert len(inside) == 9
    np.testing.assert_allclose(found.contact_force_N[1, inside, 2], exact_N, rtol=1e-5)
    assert found.solver == f"CalculiX, {len(submodel.body.elements.cells)} {element.value}"
    assert np.isnan(found.residual).all()


def test_blocks_that_were_not_asked_for_are_passed_over() -> None:
    """Contact stresses and statistics stand in the same file."""
    case = pad_case()
    text = synthetic_dat(case)
    extra = " contact stress (slave element+face,press,tang1,tang2) for all contact elements and "
    extra += "time 0.1000000E+01\n\n       341          2  1.8E-01  0.0E+00  0.0E+00\n"
    plain, more = (
        read_dat(text, case),
        read_dat(text.replace("\n displ", f"\n{extra}\n displ"), case),
    )
    np.testing.assert_array_equal(plain.contact_N, more.contact_N)


def test_a_run_that_ended_early_is_refused() -> None:
    """One of two steps: what has not converged is no answer."""
    case = pad_case()
    with pytest.raises(SolveError, match="end after 1 of 2 frames") as caught:
        read_dat(synthetic_dat(case, steps=1), case)
    assert caught.value.last_good == 0


@pytest.mark.parametrize("kept", [0.55, 0.7, 0.999, 0.99999])
def test_a_truncated_file_is_refused(kept: float) -> None:
    """Cut within the last step, wherever it is."""
    text = synthetic_dat(pad_case())
    with pytest.raises(StoreError, match=r"cut short|damaged"):
        read_dat(text[: int(kept * len(text))], pad_case())


def test_a_foreign_file_is_refused() -> None:
    """No block at all; another mesh; more steps than frames; a value that is no number."""
    case = pad_case()
    with pytest.raises(StoreError, match="no results of a deck"):
        read_dat("** a deck, not its results\n*NODE\n1, 0, 0, 0\n", case)
    with pytest.raises(StoreError, match="another deck"):
        read_dat(synthetic_dat(pad_case(element=Element.C3D20R)), case)
    with pytest.raises(StoreError, match="3 steps, the press has 2 frames"):
        read_dat(synthetic_dat(case, steps=3), case)
    with pytest.raises(StoreError, match="damaged"):
        read_dat(synthetic_dat(case, stress_MPa=float("nan")), case)


def test_a_table_gives_forces_and_displacements_on_the_skin() -> None:
    """Rows in any order; the reaction is minus the sum of the forces."""
    case = pad_case()
    skin = np.flatnonzero(case.submodel.marks.outer >= 0)
    found = force_field(read_table(table_of(case), case), case, 81, 1.0)
    np.testing.assert_allclose(found.reaction_N[1], [0.0, 0.0, 0.01 * len(skin)], rtol=1e-12)
    np.testing.assert_allclose(
        found.displacement_mm[1, case.submodel.marks.outer[skin], 0], 1e-3 * (skin + 1), rtol=1e-6
    )


def test_tables_that_lack_something_are_refused() -> None:
    """A column, a frame, a node, a number."""
    case = pad_case()
    text = table_of(case)
    with pytest.raises(StoreError, match="no column fz"):
        read_table(text.replace("fz", "f"), case)
    with pytest.raises(SolveError, match="end after 1 of 2"):
        read_table(table_of(case, steps=1), case)
    with pytest.raises(StoreError, match="other nodes than the set NOUT"):
        read_table(text.rpartition("\n")[0], case)
    with pytest.raises(StoreError, match="not finite"):
        read_table(text.replace("-0.01", "nan", 1), case)
    with pytest.raises(StoreError, match="damaged"):
        read_table(text.rpartition(",")[0], case)
