"""The session: refused edits change nothing, undo is exact, a restart finds the work."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from geometry.surface.primitives import rounded_box
from ui.desk.session import Session
from workbench.core.base.errors import DesignError
from workbench.core.press.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.project.design_toml import design_to_toml
from workbench.project.project import Project


class Clock:
    """Time that a test moves by hand."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def session(tmp_path: Path, clock: Clock) -> Session:
    return Session(Project(tmp_path), clock)


def test_refused_edit_leaves_the_last_good_state(session: Session) -> None:
    """A wall thicker than the finger raises; design and keys are as before."""
    before = session.state
    with pytest.raises(DesignError):
        session.change("design.layers.elastomer_mm", 14.5)
    assert session.state is before


def test_a_drag_is_one_step_of_undo(session: Session, clock: Clock) -> None:
    """Twenty quick edits of one field undo together, another field separately."""
    start = session.state
    for step in range(20):
        clock.now += 0.05
        session.change("design.layers.elastomer_mm", 2.0 + 0.05 * (step + 1))
    dragged = session.state
    clock.now += 0.05
    session.change("design.optics.ring.count", 6)
    assert session.undo()
    assert session.state == dragged
    assert session.undo()
    assert session.state == start
    assert not session.undo()
    assert session.redo()
    assert session.state == dragged


def test_an_amendment_is_undone_with_the_edit_it_follows(session: Session, clock: Clock) -> None:
    """A target that followed the shape goes back together with the shape, and redo stays."""
    start = session.state
    session.change("design.shape.outer_radius_mm", 10.0)
    session.amend("case.press.target_mm", (0.0, 7.0, 33.0))
    assert session.undo()
    assert session.state == start
    session.amend("case.press.target_mm", (0.0, 9.0, 35.0))
    assert session.redo()
    assert session.design.shape["outer_radius_mm"] == 10.0


def test_a_drag_that_is_amended_on_its_way_is_one_step(session: Session, clock: Clock) -> None:
    """Six ticks, the target following each, undo together."""
    start = session.state
    for step in range(6):
        clock.now += 0.2
        session.change("design.shape.outer_radius_mm", 10.0 + 0.5 * step)
        session.amend("case.press.target_mm", (0.0, 7.0, 33.0 + 0.5 * step))
    assert session.undo()
    assert session.state == start
    assert not session.undo()


def test_an_edit_after_an_amendment_is_a_step_of_its_own(session: Session, clock: Clock) -> None:
    """The target is set by hand .1 s after it followed the shape: undo gives the followed one."""
    session.change("design.shape.outer_radius_mm", 10.0)
    session.amend("case.press.target_mm", (0.0, 7.0, 33.0))
    followed = session.state
    clock.now += 0.1
    session.change("case.press.target_mm", (0.0, 6.0, 33.0))
    assert session.undo()
    assert session.state == followed


def test_random_edits_undo_to_the_start_byte_for_byte(session: Session, clock: Clock) -> None:
    """50 random edits and 50 undos give the starting TOML."""
    start = design_to_toml(session.design)
    random_source = random.Random(1)
    for _ in range(50):
        clock.now += 10.0
        path, value = random_source.choice(
            [
                ("design.shape.outer_radius_mm", random_source.uniform(10, 20)),
                ("design.optics.ring.radius_mm", random_source.uniform(2, 9)),
                ("design.optics.camera.fov_x_deg", random_source.uniform(60, 120)),
                ("case.press.depth_mm", random_source.uniform(0, 2)),
            ]
        )
        session.change(path, value)
    while session.undo():
        pass
    assert design_to_toml(session.design) == start


def test_camera_move_makes_only_what_looks_stale(session: Session) -> None:
    """Of all keys only those of `shoot` and `maps` change."""
    before = {name: call.key for name, call in session.calls().items()}
    session.change("design.optics.camera.fov_x_deg", 90.0)
    after = {name: call.key for name, call in session.calls().items()}
    assert [name for name in before if before[name] != after[name]] == ["shoot", "maps"]


def test_restart_finds_design_and_press(tmp_path: Path, session: Session) -> None:
    """A new session of the same project continues with equal keys."""
    session.change("design.shape.cylinder_mm", 20.0)
    session.change("case.press.depth_mm", 0.7)
    session.replace_indenter(Indenter(kind=IndenterKind.CUBE, size_mm=5.0))
    session.autosave()
    again = Session(Project(tmp_path))
    again.open(None)
    assert again.state == session.state
    assert {n: c.key for n, c in again.calls().items()} == {
        n: c.key for n, c in session.calls().items()
    }


def test_broken_autosave_gives_a_notice_and_the_example(tmp_path: Path, session: Session) -> None:
    """A half-edited autosave does not keep the workbench from starting."""
    session.autosave()
    path = session.project.design_path("autosave")
    path.write_text("schema = 99")
    again = Session(Project(tmp_path))
    again.open(None)
    assert again.design.name == "geltip"
    assert "schema 99" in again.notice


@pytest.mark.parametrize("share", [0.0, 0.5, 0.99])
def test_a_damaged_object_costs_the_press_only(
    tmp_path: Path, session: Session, share: float
) -> None:
    """With half of its mesh file the design is as it was, the press the default one, and told."""
    points, faces = rounded_box(2.0, 0.5)
    mesh = IndenterMesh(points_mm=points, faces=faces)
    session.change("design.shape.cylinder_mm", 20.0)
    session.replace_indenter(Indenter(kind=IndenterKind.MESH, mesh=mesh))
    session.autosave()
    (kept,) = (tmp_path / "indenters").iterdir()
    content = kept.read_bytes()
    kept.write_bytes(content[: int(share * len(content))])
    again = Session(Project(tmp_path))
    again.open(None)
    assert again.design == session.design
    assert again.case.indenter == Indenter()
    assert "the press of the last session is the default one" in again.notice
    assert again.calls()


def test_a_damaged_press_costs_the_press_only(tmp_path: Path, session: Session) -> None:
    """A depth of -1 mm in the autosave: the design stays, the notice names the value."""
    session.change("design.shape.cylinder_mm", 20.0)
    session.change("case.press.depth_mm", 0.75)
    session.autosave()
    path = session.project.design_path("autosave")
    path.write_text(path.read_text().replace("depth_mm = 0.75", "depth_mm = -1.0"))
    again = Session(Project(tmp_path))
    again.open(None)
    assert again.design == session.design
    assert "-1 mm" in again.notice
