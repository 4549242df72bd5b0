"""FEM beside CalculiX: the same press, solved by an independent program from our own deck.

A ball of 6 mm presses the default finger at 45 degrees, on a part of 7 mm. Their quadratic elements
C3D20R on the draft mesh do not lock; our linear ones come as near to the truth on the default mesh
only, so that is what is compared. The same draft mesh with C3D8I beside ours is stated, not judged:
it tells the error of the mesh. Rows are measured only where `ccx` is installed: some five minutes.
"""

from __future__ import annotations

import dataclasses
import functools
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from sim.fem.decks.mesh import Element
from workbench.core.base.errors import DeviceError, SolveError
from workbench.core.base.monitor import silent
from workbench.core.design.design import Elastomer, Meshing, SensorDesign
from workbench.core.press.fem import DRAFT_MM, HALVINGS, QUALITY_MM, FemSettings
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import ForceField
from workbench.core.result.results import MembraneMesh
from workbench.project.state import State
from workbench.proof.row import Row, compared, failed, stated
from workbench.proof.specimens import finger_solid
from workbench.proof.validation.contact.presses import tip_target
from workbench.report.fem_case import make_deck_case

PROGRAM = "ccx"
LIMIT = 0.03
LONGEST_S = 900.0
NAME = "ball R 3 mm on the finger at 45 degrees, 1 mm deep, part of 7 mm"
FRICTIONS = (0.0, 0.3)


def rows() -> list[Row]:
    """All rows; one that failed where the program is not installed."""
    if not installed():
        why = "CalculiX is not installed: on Debian, apt-get install calculix-ccx"
        return [failed("calculix", "the whole room", unit="N", why=why)]
    draft = f"ratio of our draft to C3D8I on the same mesh, friction 0; {NAME}"
    return [
        *(_default_row(friction) for friction in FRICTIONS),
        stated(
            "calculix_same_mesh",
            draft,
            lambda: (
                _normal_N(ours(DRAFT_MM, halvings=0)) / _normal_N(theirs(DRAFT_MM, Element.C3D8I))
            ),
            unit="1",
        ),
    ]


def installed() -> bool:
    """Whether the program is there."""
    return shutil.which(PROGRAM) is not None


def _default_row(friction: float) -> Row:
    return compared(
        "calculix",
        f"0.45 mm against C3D20R at 0.9 mm, friction {friction:g}; {NAME}",
        lambda: _normal_N(ours(QUALITY_MM, friction)),
        lambda: _normal_N(theirs(DRAFT_MM, Element.C3D20R, friction)),
        unit="N",
        limit=LIMIT,
    )


def finger_state(hex_mm: float, friction: float) -> State:
    """The press of this room."""
    return State(
        design=SensorDesign(material=Elastomer(friction=friction)),
        case=PressCase(
            indenter=Indenter(size_mm=6.0),
            press=Press(target_mm=tip_target(45.0, 0.0), frames=2),
            fem=FemSettings(hex_mm=hex_mm, radius_mm=7.0),
        ),
    )


@functools.cache
def _mesh(hex_mm: float) -> MembraneMesh:
    from workbench.pipeline.stages.mesh import MeshInputs, mesh

    given = MeshInputs(solid=finger_solid(), meshing=Meshing(hex_mm=hex_mm), paired=True)
    return mesh(given, monitor=silent)


@functools.cache
def ours(hex_mm: float, friction: float = 0.0, *, halvings: int = HALVINGS) -> ForceField:
    """Our result on a mesh; without halvings on that which the deck has."""
    from sim.fem.press import solve_press

    state = finger_state(hex_mm, friction)
    case = dataclasses.replace(
        state.case, fem=dataclasses.replace(state.case.fem, halvings=halvings, error=False)
    )
    return solve_press(_mesh(hex_mm), state.design.material, case)


@functools.cache
def theirs(hex_mm: float, element: Element, friction: float = 0.0) -> ForceField:
    """CalculiX's result on a mesh.

    Raises:
        SolveError: If it does not converge or takes too long.
        DeviceError: If it cannot be started.
    """
    return run_calculix(_mesh(hex_mm), finger_state(hex_mm, friction), element)


def run_calculix(mesh: MembraneMesh, state: State, element: Element) -> ForceField:
    """Solve a case by CalculiX, in a folder that is removed afterwards.

    Raises:
        SolveError: If it does not converge or takes too long.
        DeviceError: If it cannot be started.
    """
    from sim.fem.decks.dat import read_dat
    from sim.fem.decks.deck import write_deck
    from sim.fem.decks.results import force_field

    ready = make_deck_case(mesh, state, element)
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "case.inp").write_text(write_deck(ready), encoding="utf-8")
        try:
            subprocess.run(
                [PROGRAM, "-i", "case"],
                cwd=folder,
                env={**os.environ, "OMP_NUM_THREADS": "1"},
                capture_output=True,
                timeout=LONGEST_S,
                check=False,
            )
        except subprocess.TimeoutExpired as late:
            raise SolveError(f"CalculiX took longer than {LONGEST_S:g} s") from late
        except OSError as error:
            raise DeviceError(f"CalculiX does not start: {error}") from error
        dat = Path(folder) / "case.dat"
        # A run that fails at once leaves no file; its absence reads as no results.
        text = dat.read_text(encoding="utf-8") if dat.exists() else ""
        result = read_dat(text, ready)
    return force_field(result, ready, len(mesh.outer.points_mm), state.case.fem.hex_mm)


def _normal_N(found: ForceField) -> float:
    return float(found.normal_N[-1])
