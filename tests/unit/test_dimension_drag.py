"""Dragging a dimension: its end stays under the mouse, one step of undo, its slider's limits."""

from __future__ import annotations

import asyncio
import contextlib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ui.desk.session import Session
from ui.page.field_words import Field
from ui.page.fields import Fields
from ui.panels.shape.drawn_sizes import DrawnSizes
from ui.scene.dimension_lines import arrow
from workbench.edit.dimensions import dimensions, dragged
from workbench.edit.item_fields import read_field
from workbench.project.project import Project

EYE = np.array([90.0, 66.0, 60.0])
TAB = 3
LENGTH = "design.shape.cylinder_mm"


class Node(SimpleNamespace):
    """Takes what a node of the scene is given."""

    def on_drag(self, act: Any) -> Any:
        self.act = act
        return act

    def remove(self) -> None:
        self.removed = True


class Api:
    """Hands out nodes and keeps them by name."""

    def __init__(self) -> None:
        self.nodes: dict[str, Node] = {}

    def __getattr__(self, name: str) -> Any:
        def add(node: str, *given: Any, **looks: Any) -> Node:
            self.nodes[node] = Node(text=given[0] if name == "add_label" else "")
            return self.nodes[node]

        return add


class Bench:
    """A desk of one session around the switch *Dimensions*; a clock that is set."""

    def __init__(self, folder: Path) -> None:
        self.now_s = 0.0
        self.session = Session(Project(folder), clock=lambda: self.now_s)
        self.edited: list[float] = []
        self.editor_left = False
        self.api = Api()
        fields: Any = Fields.__new__(Fields)
        fields._fields, fields.refresh = {}, lambda: None
        for line in dimensions(self.session.design):
            slider = SimpleNamespace(label="Size mm", min=2.0, max=80.0, step=0.5)
            fields._fields[f"design.{line.field}"] = Field(
                path=line.field,
                label="",
                handle=slider,
                to_field=float,
                to_widget=float,
                complaint=None,
            )
        self.turns: list[Any] = []
        gui = SimpleNamespace(
            add_checkbox=lambda *words, **hint: SimpleNamespace(value=True, on_update=lambda f: f),
            add_command=lambda *words, **key: SimpleNamespace(on_trigger=lambda f: f),
        )
        desk: Any = SimpleNamespace(
            server=SimpleNamespace(gui=gui, atomic=contextlib.nullcontext),
            guarded=lambda act: act,
            scene=SimpleNamespace(
                api=self.api,
                body=SimpleNamespace(bounds_mm=(np.zeros(3), np.full(3, 40.0))),
            ),
            editor=SimpleNamespace(edits=lambda tab: not self.editor_left),
            session=self.session,
            fields=fields,
            read=self._read,
            edit=self._edit,
            on_turn=self.turns,
        )
        self.sizes = DrawnSizes(desk)
        self.sizes.refresh()

    def _read(self, path: str) -> Any:
        shape = {"cylinder_mm": 27.0} | dict(self.session.design.shape)
        name = path.rpartition(".")[2]
        return shape[name] if name in shape else read_field(self.session.state, path)

    def _edit(self, path: str, value: float) -> None:
        self.session.change(path, value)
        self.edited.append(value)
        self.sizes.refresh()

    def mouse(self, phase: str, up_mm: float) -> None:
        """Drag the end of the straight length to a height over where it stands at first."""
        line = next(d for d in self.first if d.field == "shape.cylinder_mm")
        place = np.add(line.stop_mm, (0.0, 0.0, up_mm))
        # Anywhere along the ray of the mouse, as the plane of a drag has it.
        seen = EYE + 0.7 * (place - EYE)
        event = SimpleNamespace(
            client=SimpleNamespace(camera=SimpleNamespace(position=EYE)),
            client_id=TAB,
            phase=phase,
            start_position=np.array(line.stop_mm),
            end_position=seen,
        )
        asyncio.run(self.api.nodes["/dimensions/shape_cylinder_mm/held"].act(event))
        for turn in self.turns:
            turn()

    @property
    def first(self) -> Any:
        if not hasattr(self, "_first"):
            self._first = dimensions(self.session.design)
        return self._first


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    bench = Bench(tmp_path)
    assert len(bench.first) == 4
    return bench


def test_the_end_follows_the_mouse_and_a_drag_is_one_step(bench: Bench) -> None:
    """Up by 3 and by 5.2 mm, with rests of seconds: 30, then 32 of steps of 0.5; one undo: 27."""
    start = bench._read(LENGTH)
    bench.mouse("start", 0.0)
    for up_mm, now_s in ((3.0, 2.0), (5.2, 9.0)):
        bench.now_s = now_s
        bench.mouse("update", up_mm)
    bench.mouse("end", 5.2)
    assert bench.edited[-1] == pytest.approx(start + 5.0)
    assert start + 3.0 in bench.edited
    assert bench.session.undo() and bench._read(LENGTH) == start
    assert not bench.session.undo()


def test_two_drags_are_two_steps(bench: Bench) -> None:
    """However soon the second follows."""
    start = bench._read(LENGTH)
    for up_mm in (3.0, 6.0):
        bench.mouse("start", up_mm - 3.0)
        bench.mouse("update", up_mm)
        bench.mouse("end", up_mm)
    assert bench.session.undo() and bench._read(LENGTH) != start
    assert bench.session.undo() and bench._read(LENGTH) == start


def test_a_drag_ends_where_the_slider_does(bench: Bench) -> None:
    """200 mm up: the slider's 80; its label says so."""
    bench.mouse("start", 0.0)
    bench.mouse("update", 200.0)
    assert bench.edited[-1] == 80.0
    assert bench.api.nodes["/dimensions/shape_cylinder_mm/label"].text == "Size 80 mm"


def test_who_no_longer_edits_holds_nothing(bench: Bench) -> None:
    """A drag whose end never came: what its tab sends later moves nothing."""
    bench.mouse("start", 0.0)
    bench.editor_left = True
    for turn in bench.turns:
        turn()
    count = len(bench.edited)
    bench.mouse("update", 4.0)
    assert len(bench.edited) == count


def test_a_family_whose_sliders_are_not_there_yet_has_no_lines(bench: Bench) -> None:
    """A comparison ends as another family is taken: its sizes wait for their sliders."""
    bench.sizes.show("compared", True)
    bench.sizes.desk.fields._fields.clear()
    bench.sizes.show("compared", False)
    assert bench.api.nodes["/dimensions/shape_cylinder_mm/line"].removed


@pytest.mark.parametrize("news", ["covered", "compared"])
def test_what_else_is_looked_at_takes_the_lines_away(bench: Bench, news: str) -> None:
    """Parts, and other designs beside the sensor; they come back with it."""
    node = bench.api.nodes["/dimensions/shape_cylinder_mm/line"]
    bench.sizes.show(news, True)
    assert node.removed
    bench.sizes.show(news, False)
    assert not hasattr(bench.api.nodes["/dimensions/shape_cylinder_mm/line"], "removed")


def test_a_place_under_the_mouse_is_found_along_the_line(bench: Bench) -> None:
    """Closed form: the ray through a point of the line meets it there; along the line, nowhere."""
    for line in bench.first:
        place = np.array(line.stop_mm) + 4.25 * line.direction
        assert dragged(line, EYE, (EYE + place) / 2) == pytest.approx(4.25)
        behind = np.array(line.stop_mm) - 30.0 * line.direction
        assert dragged(line, behind, np.array(line.start_mm)) == 0.0


def test_an_arrow_ends_where_it_points_and_is_closed() -> None:
    """Its tip, its length, and every edge in two triangles, once in either direction."""
    points, faces = arrow(np.array([1.0, 2.0, 3.0]), np.array([0.0, 0.6, -0.8]), 2.0)
    along = (points - [1.0, 2.0, 3.0]) @ [0.0, 0.6, -0.8]
    assert along.max() == pytest.approx(0.0, abs=1e-6) and along.min() == pytest.approx(-2.0)
    edges = [(int(f[k]), int(f[k - 1])) for f in faces for k in range(3)]
    assert len(set(edges)) == len(edges) and {(b, a) for a, b in edges} == set(edges)
