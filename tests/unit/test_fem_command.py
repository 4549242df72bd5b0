"""`workbench fem` from its arguments to its files."""

from __future__ import annotations

import dataclasses
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.fem.decks.mesh import Element
from sim.fem.decks.results import force_field, read_table
from sim.fem.decks.text import carried_text, read_deck
from sim.fem.press import solve_press
from sim.fem.studies.blocks import flat_membrane
from tests.unit.test_fem_deck import pad_case
from tests.unit.test_fem_results import table_of
from workbench.cli.command_line import main
from workbench.core.base.errors import StoreError
from workbench.core.design.design import Elastomer, SensorDesign
from workbench.core.press.fem import DRAFT_MM, FemSettings
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.project.state import State
from workbench.proof.validation.fem import calculix
from workbench.report.fem_case import carried, read_carried
from workbench.report.fem_tables import beside

SHORT = ["--draft", "--radius-mm", "5", "--depth-mm", "0.2", "--frames", "2"]


def finger_state() -> State:
    press = Press(target_mm=(0.0, 10.0, 37.0), depth_mm=0.3, frames=2)
    settings = FemSettings(hex_mm=DRAFT_MM, radius_mm=5.0)
    return State(design=load_design("finger"), case=PressCase(press=press, fem=settings))


def test_a_case_is_carried_as_it_is(tmp_path: Path) -> None:
    """Design, press, settings and element come back equal, so that ours is found in the store."""
    project, state = Project(tmp_path), finger_state()
    text = carried(state, Element.C3D20R, project)
    assert read_carried(text, project, source="case.inp") == (state, Element.C3D20R)


@pytest.mark.parametrize("change", [('"schema": 1', '"schema": 2'), ("C3D8I", "C3D4"), ("{", "")])
def test_a_case_of_another_version_is_refused(tmp_path: Path, change: tuple[str, str]) -> None:
    """Another schema, an unknown element, no table at all."""
    project = Project(tmp_path)
    text = carried(finger_state(), Element.C3D8I, project).replace(*change, 1)
    with pytest.raises(StoreError, match="another version, or edited"):
        read_carried(text, project, source="case.inp")


def test_options_of_the_contact_solver_are_refused(tmp_path: Path, capsys: Any) -> None:
    """A grid changes nothing here, which nobody expects of what they typed."""
    words = ["fem", "solve", "finger", "--grid-mm", "0.5", "--out", str(tmp_path / "out")]
    assert main([*words, "--project", str(tmp_path)]) == 2
    assert "--grid-mm is not for finite elements" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_deck_needs_the_name_of_a_deck(tmp_path: Path, capsys: Any) -> None:
    """Solvers find `case` by the ending."""
    words = ["fem", "export", "finger", "--out", str(tmp_path / "case.txt")]
    assert main([*words, "--project", str(tmp_path)]) == 2
    assert "not the name of a deck" in capsys.readouterr().err


def test_totals_stand_beside_each_other() -> None:
    """Twice the forces and 0.25 mm more along X: ratio 2, root mean square .25 mm."""
    case = pad_case()
    found = force_field(read_table(table_of(case), case), case, 81, 1.0)
    shift = np.array([0.25, 0.0, 0.0], np.float32)
    other = dataclasses.replace(
        found,
        reaction_N=2.0 * found.reaction_N,
        displacement_mm=found.displacement_mm + shift,
    )
    rows = beside(other, found)["frames"]
    assert [row["ratio"] for row in rows] == [2.0, 2.0]
    assert rows[0]["displacement_rms_mm"] == pytest.approx(0.25, rel=1e-5)
    assert rows[1]["their_normal_N"] == pytest.approx(found.reaction_N[1] @ found.normal)


@pytest.mark.slow
def test_a_finger_is_solved_exported_and_compared(tmp_path: Path, capsys: Any) -> None:
    """Our own forces, given back as another program's table, agree with ours."""
    project, deck, out = str(tmp_path / "p"), tmp_path / "case.inp", tmp_path / "out"
    words = ["--project", project]
    assert main(["fem", "solve", "finger", *SHORT, "--out", str(out), "--json", *words]) == 0
    told = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert [row["converged"] for row in told["frames"]] == [1, 1]
    np.testing.assert_allclose([row["depth_mm"] for row in told["frames"]], [0.1, 0.2])
    assert (out / "forces.csv").read_text().startswith("frame,depth_mm,normal_N,")
    assert main(["fem", "export", "finger", *SHORT, "--out", str(deck), *words]) == 0
    with np.load(out / "forces.npz") as found:
        table = their_table(deck, found, Project(project))
    (tmp_path / "theirs.csv").write_text(table)
    capsys.readouterr()
    words = ["fem", "import", str(deck), str(tmp_path / "theirs.csv"), "--json", *words]
    assert main(words) == 0
    rows = json.loads(capsys.readouterr().out.splitlines()[-1])["frames"]
    # Nodal forces are kept in single precision.
    assert [row["ratio"] for row in rows] == pytest.approx([1.0, 1.0], rel=1e-5)
    assert rows[1]["their_normal_N"] == pytest.approx(told["frames"][1]["normal_N"], rel=1e-5)
    deck.write_text(re.sub(r"\n1, [^,]+", "\n1, 9.0", deck.read_text(), count=1))
    assert main(words) == 3
    assert "other nodes than this version" in capsys.readouterr().err


@pytest.mark.slow
def test_a_large_object_is_written_where_it_meets_the_skin(tmp_path: Path) -> None:
    """A screwdriver 215 mm long, in a process that has not opened a device yet."""
    deck = tmp_path / "case.inp"
    words = ["fem", "export", "finger", *SHORT, "--indenter", "screwdriver", "--out", str(deck)]
    done = subprocess.run(
        [sys.executable, "-m", "workbench.cli", *words, "--project", str(tmp_path / "p")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    object_mm = read_deck(deck.read_text()).nodes["NOBJ"][:, 1:]
    assert 2.0 < np.ptp(object_mm, axis=0).max() < 60.0


def their_table(deck: Path, found: Any, project: Project) -> str:
    """Our fields as the table of another program."""
    from workbench.report.fem_case import deck_case

    state, element = read_carried(carried_text(deck.read_text()), project, source="case.inp")
    skin = deck_case(state, element, project)[0].submodel.marks.outer
    rows = ["step,node,ux,uy,uz,fx,fy,fz"]
    for frame in range(2):
        for node in np.flatnonzero(skin >= 0):
            fields = (
                found[name][frame, skin[node]] for name in ("displacement_mm", "contact_force_N")
            )
            values = ",".join(f"{value:.9g}" for field in fields for value in field)
            rows.append(f"{frame + 1},{node + 1},{values}")
    return "\n".join(rows)


def test_calculix_is_measured_only_where_it_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    """One failed row that says how to install it."""
    monkeypatch.setattr(calculix, "PROGRAM", "no-such-program")
    (row,) = calculix.rows()
    assert not row.ok and "calculix-ccx" in row.case


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
def test_calculix_agrees_where_nothing_locks() -> None:
    """A pad of nu .3 under a ball, without friction: C3D8I on the same mesh within 3 %."""
    press = Press(target_mm=(0.0, 0.0, 2.0), depth_mm=0.4, frames=1)
    settings = FemSettings(hex_mm=0.5, radius_mm=5.0)
    state = State(
        design=SensorDesign(material=Elastomer(poisson=0.3, friction=0.0)),
        case=PressCase(press=press, fem=settings),
    )
    mesh = flat_membrane(edge_mm=0.5, layers=4)
    theirs = calculix.run_calculix(mesh, state, Element.C3D8I)
    mine = solve_press(mesh, state.design.material, PressCase(press=press, fem=settings))
    assert mine.normal_N[0] == pytest.approx(theirs.normal_N[0], rel=0.03)
    # Forces found from printed stresses leave out the incompatible modes: some per cent.
    assert theirs.balance[0] < 0.05
