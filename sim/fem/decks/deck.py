"""A press as an input deck of CalculiX or Abaqus, so that another program can check our forces.

One step per frame; the object is moved by prescription, its turns node by node: exact at the end of
every step, along chords between. Contact is surface to surface with a linear overclosure of our
penalty; ours sets in over 2 um, and its friction sticks in proportion to the pressure, theirs with
one stiffness. Left out, and refused: skins that rest on gel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.contact.motion.approach import Approach
from sim.fem.contact_law import Law
from sim.fem.decks.mesh import DeckMesh, Element, deck_mesh, element_lines, face_numbers, node_lines
from sim.fem.decks.rigid_object import Shell
from sim.fem.decks.text import carried_lines
from sim.fem.submodel import Submodel
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Elastomer

STICK_SHARE = 0.1
"""Stick stiffness of the deck's friction over the penalty: ours has it at a pressure of E / 6."""
OBJECT_MPa = 210.0
"""Modulus of the object's wedges, of which every node is moved: it does not enter anything."""
MOST_INCREMENTS = 1000
FIRST_INCREMENT = 0.25
LEAST_INCREMENT = 1e-5
"""Shares of a step."""


@dataclass(frozen=True, kw_only=True)
class DeckCase:
    """A press that is ready to be written."""

    submodel: Submodel
    approach: Approach
    material: Elastomer
    law: Law
    shell: Shell
    element: Element = Element.C3D8I


def write_deck(case: DeckCase, carried: str = "") -> str:
    """The text of the deck.

    Args:
        case: What is pressed.
        carried: Text that stands in comments and is found again by `deck_text.carried_text`.

    Raises:
        DesignError: If the skin rests on gel, for which decks have no element.
    """
    body = case.submodel.body
    if len(body.springs.nodes):
        raise DesignError(
            f"{len(body.springs.nodes)} faces of the skin rest on gel, which a deck cannot hold",
            hint="compare without the gel: material.backing_MPa = 0",
            at="material.backing_MPa",
        )
    mesh = deck_mesh(body.points_mm, body.elements.cells, case.element)
    lines = [*_header(case, mesh), *carried_lines(carried)]
    lines += [*_bodies(case, mesh), *_contact(case, mesh), *_held(case, mesh)]
    before = _Moves.at(case, mesh, 0)
    for frame in range(1, case.approach.frame_count + 1):
        moves = _Moves.at(case, mesh, frame)
        lines += _step(case, frame, moves.lines(before))
        before = moves
    return "\n".join(lines) + "\n"


def skin_cells(submodel: Submodel) -> np.ndarray:
    """Elements that meet skin that may be touched, from 0, shape (M',)."""
    body = submodel.body
    touched = np.isin(body.elements.cells, body.faces.nodes).any(axis=1)
    return np.flatnonzero(touched)


def _header(case: DeckCase, mesh: DeckMesh) -> list[str]:
    material, approach = case.material, case.approach
    vectors = {"target": approach.target_mm, "normal": approach.normal, "U": approach.tangent_u}
    places = "; ".join(f"{name} ({x:.6g}, {y:.6g}, {z:.6g})" for name, (x, y, z) in vectors.items())
    text = f"""Press of a tactile membrane. Units: mm, N, MPa. Sensor frame; {places}.
One step per frame, {approach.frame_count} in all; the object starts at first touch.
Elastomer: E {material.young_MPa:g} MPa, nu {material.poisson:g}, law {material.law.value}; friction
{material.friction:g}; penalty {case.law.penalty_MPa_mm:g} MPa/mm on the undeformed area.
Part: radius {case.submodel.part.radius_mm:g} mm about the target (inf: the whole membrane),
{len(mesh.cells)} elements {case.element.value}, {len(mesh.points_mm)} nodes.
Sets: NPART all of it; NOUT vertices of the outer skin; NHELD bonded to the support or cut from the
rest of the membrane, fixed; NDRIVEN moved by an actuator; EMAT1, EMAT2, ... elements of one
elastomer; ESKIN those whose stress is printed, from which contact forces are found; SSKIN the skin
that may be touched; NOBJ, EOBJ, SOBJ the rigid object. The reaction of the object is minus the
total force printed for NOBJ.
Written for CalculiX 2.20. For Abaqus leave out the stick stiffness, the second number after
*FRICTION, write TOTALS=YES for TOTALS=ONLY, and give results as comma-separated values:
step,node,ux,uy,uz,fx,fy,fz for all of NOUT, f the contact force on the skin, CNORMF + CSHEARF."""
    return [f"** {line}" for line in text.splitlines()]


def _bodies(case: DeckCase, mesh: DeckMesh) -> list[str]:
    elements, shell = case.submodel.body.elements, case.shell
    count = len(mesh.points_mm)
    lines = ["*NODE, NSET=NPART", *node_lines(mesh.points_mm, 1)]
    origin_mm, rotation = case.approach.pose(0.0)
    placed_mm = shell.points_mm @ rotation.T + origin_mm
    lines += ["*NODE, NSET=NOBJ", *node_lines(placed_mm, count + 1)]
    moduli = np.stack([elements.shear_MPa, elements.bulk_MPa], axis=1)
    kinds, kind = np.unique(moduli, axis=0, return_inverse=True)
    for number, (shear_MPa, bulk_MPa) in enumerate(kinds.tolist(), start=1):
        rows = np.flatnonzero(kind.ravel() == number - 1).tolist()
        lines += [f"*ELEMENT, TYPE={case.element.value}, ELSET=EMAT{number}"]
        lines += element_lines(mesh.cells, rows, first=1, shift=1)
        lines += [f"*MATERIAL, NAME=MAT{number}"]
        lines += _law_lines(shear_MPa, bulk_MPa, linear=elements.linear)
        lines += [f"*SOLID SECTION, ELSET=EMAT{number}, MATERIAL=MAT{number}"]
    lines += ["*ELEMENT, TYPE=C3D6, ELSET=EOBJ"]
    first, rows = len(mesh.cells) + 1, range(len(shell.wedges))
    lines += element_lines(shell.wedges, rows, first=first, shift=count + 1)
    lines += ["*MATERIAL, NAME=MOBJ", "*ELASTIC", f"{OBJECT_MPa:g}, 0.3"]
    return [*lines, "*SOLID SECTION, ELSET=EOBJ, MATERIAL=MOBJ"]


def _law_lines(shear_MPa: float, bulk_MPa: float, *, linear: bool) -> list[str]:
    if linear:
        young_MPa = 9.0 * bulk_MPa * shear_MPa / (3.0 * bulk_MPa + shear_MPa)
        poisson = (3.0 * bulk_MPa - 2.0 * shear_MPa) / (6.0 * bulk_MPa + 2.0 * shear_MPa)
        return ["*ELASTIC", f"{young_MPa:.10g}, {poisson:.10g}"]
    return ["*HYPERELASTIC, NEO HOOKE", f"{0.5 * shear_MPa:.10g}, {2.0 / bulk_MPa:.10g}"]


def _contact(case: DeckCase, mesh: DeckMesh) -> list[str]:
    body, law = case.submodel.body, case.law
    elements, numbers = face_numbers(body.elements.cells, body.faces.nodes)
    pairs = zip(elements.tolist(), numbers.tolist(), strict=True)
    lines = ["*SURFACE, NAME=SSKIN", *(f"{element + 1}, S{number}" for element, number in pairs)]
    first = len(mesh.cells) + 1
    lines += ["*SURFACE, NAME=SOBJ", *(f"{first + t}, S1" for t in range(len(case.shell.wedges)))]
    lines += ["*SURFACE INTERACTION, NAME=TOUCH"]
    lines += ["*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{law.penalty_MPa_mm:.10g}"]
    if law.friction > 0.0:
        lines += ["*FRICTION", f"{law.friction:.10g}, {STICK_SHARE * law.penalty_MPa_mm:.10g}"]
    return [*lines, "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE", "SSKIN, SOBJ"]


def _held(case: DeckCase, mesh: DeckMesh) -> list[str]:
    submodel = case.submodel
    driven = mesh.members(submodel.marks.drive >= 0)
    held = mesh.members(submodel.body.held) & ~driven
    skin = np.flatnonzero(submodel.marks.outer >= 0)
    lines = ["*NSET, NSET=NOUT", *(str(node + 1) for node in skin.tolist())]
    lines += ["*ELSET, ELSET=ESKIN", *(str(row + 1) for row in skin_cells(submodel).tolist())]
    lines += ["*NSET, NSET=NHELD", *(str(node + 1) for node in np.flatnonzero(held).tolist())]
    if driven.any():
        found = np.flatnonzero(driven).tolist()
        lines += ["*NSET, NSET=NDRIVEN", *(str(node + 1) for node in found)]
    return [*lines, "*BOUNDARY", "NHELD, 1, 3"]


def _step(case: DeckCase, frame: int, moves: list[str]) -> list[str]:
    geometry = "" if case.submodel.body.elements.linear else ", NLGEOM"
    return [
        f"** frame {frame}",
        f"*STEP{geometry}, INC={MOST_INCREMENTS}",
        "*STATIC",
        f"{FIRST_INCREMENT:g}, 1., {LEAST_INCREMENT:g}, 1.",
        "*BOUNDARY",
        *moves,
        f"*NODE PRINT, NSET=NOBJ, TOTALS=ONLY, FREQUENCY={MOST_INCREMENTS}",
        "RF",
        f"*NODE PRINT, NSET=NPART, FREQUENCY={MOST_INCREMENTS}",
        "U",
        f"*EL PRINT, ELSET=ESKIN, FREQUENCY={MOST_INCREMENTS}",
        "S",
        "*END STEP",
    ]


@dataclass(frozen=True, kw_only=True)
class _Moves:
    """Total displacement of all that is prescribed, at the end of a frame."""

    object_mm: np.ndarray
    """Of the object's nodes, shape (P, 3)."""
    driven_mm: np.ndarray
    """Of the driven nodes, shape (D, 3)."""
    driven: np.ndarray
    """Their numbers, shape (D,)."""
    first: int
    """Number of the object's first node."""

    @classmethod
    def at(cls, case: DeckCase, mesh: DeckMesh, frame: int) -> _Moves:
        points_mm = case.shell.points_mm
        begun_mm, begun = case.approach.pose(0.0)
        origin_mm, rotation = case.approach.pose(float(frame))
        submodel = case.submodel
        moved_mm = np.zeros_like(submodel.body.points_mm)
        for number, actuation in enumerate(case.approach.press.actuations):
            members = submodel.marks.drive == number
            moved_mm[members] = actuation.displacement_mm(
                submodel.body.points_mm[members], float(frame)
            )
        driven = np.flatnonzero(mesh.members(submodel.marks.drive >= 0))
        return cls(
            object_mm=points_mm @ (rotation - begun).T + (origin_mm - begun_mm),
            driven_mm=mesh.at_all(moved_mm)[driven],
            driven=driven + 1,
            first=len(mesh.points_mm) + 1,
        )

    def lines(self, before: _Moves) -> list[str]:
        """Lines of *BOUNDARY; what has not turned since it was placed moves as one set."""
        found = []
        if np.ptp(self.object_mm, axis=0).max() < 1e-12 and (
            np.ptp(before.object_mm, axis=0).max() < 1e-12
        ):
            for axis, way_mm in enumerate(self.object_mm[0].tolist(), start=1):
                found.append(f"NOBJ, {axis}, {axis}, {way_mm:.10g}")
        else:
            found += _node_moves(np.arange(len(self.object_mm)) + self.first, self.object_mm)
        return found + _node_moves(self.driven, self.driven_mm)


def _node_moves(numbers: np.ndarray, ways_mm: np.ndarray) -> list[str]:
    return [
        f"{number}, {axis}, {axis}, {way_mm:.10g}"
        for number, row in zip(numbers.tolist(), ways_mm.tolist(), strict=True)
        for axis, way_mm in enumerate(row, start=1)
    ]
