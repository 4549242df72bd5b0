"""Which presses a network predicts unasked, and what the panel offers with and without networks."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.made_weights import card_of, tiny_weights, write_tiny
from tests.unit.test_messages import Widget
from ui.desk.session import Session
from ui.panels.simulate.network import MOST_FRAMES, PREDICT, NetworkPart
from workbench.live.requests import PREDICTION
from workbench.pipeline import shipped
from workbench.pipeline.chosen_weights import FOLDER
from workbench.project.project import Project


class Bench:
    """The part on a desk that remembers what was asked for; all results are of the state."""

    def __init__(self, folder: Path) -> None:
        self.session = Session(Project(folder))
        self.asked: list[tuple[Any, ...]] = []
        self.stopped: list[str] = []
        self.live = False
        self.stale: set[str] = set()
        self.widgets: dict[str, Any] = {}
        self.part = NetworkPart(self._desk())

    def _desk(self) -> Any:
        gui = SimpleNamespace(
            add_markdown=lambda content, visible=True: self._made("about", "", visible),
            add_button=lambda label, **rest: self._made(label, "", True),
            add_dropdown=lambda label, options, hint, visible: self._made(label, options[0], True),
        )
        bench = self

        class Desk:
            server = SimpleNamespace(gui=gui)
            reports = SimpleNamespace(beside=lambda *jobs: None)
            session = bench.session
            conductor = SimpleNamespace(stop=bench.stopped.append)
            jobs = SimpleNamespace(submit=lambda *words: bench.asked.append(words))

            @property
            def live(self) -> bool:
                return bench.live

            def guarded(self, handler: Any) -> Any:
                return handler

            def current(self, stage: str) -> bool:
                return stage not in bench.stale

            def edit(self, path: str, value: Any) -> None:
                bench.session.change(path, value)
                bench.part.refresh()

        return Desk()

    def _made(self, name: str, value: str, visible: bool) -> Any:
        widget: Any = Widget(name, value)
        widget.visible, widget.options, widget.on_click = visible, (value,), lambda handler: None
        self.widgets[name] = widget
        return widget

    def shown(self) -> set[str]:
        """Names of the widgets on show."""
        return {name for name, widget in self.widgets.items() if widget.visible}

    def choose(self, label: str, option: str) -> None:
        """Take an entry of a drop-down as a person does."""
        self.widgets[label].value = option
        self.widgets[label].handler(SimpleNamespace(client=object()))

    def weights(self, **card: Any) -> Path:
        """A network of the project that knows its design, but for what is given."""
        known = {**card_of(self.session.design, hex_mm=1.5), **card}
        folder = self.session.project.folder / FOLDER
        return write_tiny(folder, tiny_weights((0.0, 0.0, -1e-3), card=known))


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Bench:
    monkeypatch.setattr(shipped, "FOLDER", tmp_path / "shipped")
    return Bench(tmp_path / "project")


def test_without_a_network_only_its_making_is_said(bench: Bench) -> None:
    """The command that trains one, and neither button nor choice; nothing is predicted."""
    assert bench.shown() == {"about"}
    assert "workbench train make DATA --preset small --target force" in bench.part.about.content
    bench.part.follow()
    assert bench.asked == []


def test_a_network_of_the_project_is_chosen_by_name(bench: Bench) -> None:
    """It is offered once it is there; chosen, the press can be predicted, and chosen back."""
    path = bench.weights()
    bench.part.refresh()
    assert bench.shown() == {"about", "Force network"}
    assert bench.widgets["Force network"].options == (path.name, "none shipped")
    bench.choose("Force network", path.name)
    assert bench.session.case.learned.weights == str(path)
    assert PREDICT in bench.shown() and "about" not in bench.shown()
    assert [words[0] for words in bench.asked] == [PREDICTION]
    bench.session.undo()
    bench.part.refresh()
    assert bench.widgets["Force network"].value == "none shipped"


def test_a_press_that_the_network_knows_is_predicted_unasked(bench: Bench) -> None:
    """Once press and image are those of the state; a new request makes it give way."""
    bench.session.change("case.learned.weights", str(bench.weights()))
    bench.part.follow()
    (asked,) = bench.asked
    assert asked[0] == PREDICTION and asked[3] == ("learned",)
    bench.part.give_way()
    assert bench.stopped == [PREDICTION]


@pytest.mark.parametrize("stage", ["press", "shoot"])
def test_prediction_waits_for_press_and_image(bench: Bench, stage: str) -> None:
    """The worker that renders would have to wait for it."""
    bench.session.change("case.learned.weights", str(bench.weights()))
    bench.stale.add(stage)
    bench.part.follow()
    assert bench.asked == []


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("case.press.depth_mm", 1.5),
        ("case.press.frames", MOST_FRAMES + 1),
        ("design.layers.elastomer_mm", 1.5),
        ("design.material.friction", 0.5),
    ],
)
def test_what_is_unknown_or_long_waits_for_the_button(bench: Bench, field: str, value: Any) -> None:
    """Another depth, wall or friction, and paths that take many seconds."""
    bench.session.change("case.learned.weights", str(bench.weights()))
    bench.session.change(field, value)
    bench.part.follow()
    assert bench.asked == []


def test_another_stiffness_is_known(bench: Bench) -> None:
    """Forces are scaled by it, which is exact."""
    bench.session.change("case.learned.weights", str(bench.weights()))
    bench.session.change("design.material.young_MPa", 0.3)
    bench.part.follow()
    assert len(bench.asked) == 1


def test_live_presses_are_not_predicted(bench: Bench) -> None:
    """They are not stored, and the next one comes at once."""
    bench.session.change("case.learned.weights", str(bench.weights()))
    bench.live = True
    bench.part.follow()
    assert bench.asked == []
