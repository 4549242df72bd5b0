"""What widgets show after a refusal: the design's values, and messages in words of the page."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from ui.page.fields import Fields
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera
from workbench.core.design.design import SensorDesign
from workbench.core.design.lighting import Lamp
from workbench.core.design.optics import Optics
from workbench.edit.item_fields import read_field
from workbench.edit.light_edit import colour_words, read_colours


class Widget:
    """A widget of a page without a page."""

    def __init__(self, label: str, value: Any) -> None:
        self.label, self.value = label, value
        self.content, self.visible = "", False
        self.handler: Any = None
        # Where viser keeps the thread that runs callbacks.
        self._impl = SimpleNamespace(gui_api=SimpleNamespace(_thread_executor=None))

    def on_update(self, handler: Any) -> None:
        self.handler = handler

    def entered(self, value: Any) -> None:
        """A person enters a value."""
        self.value = value
        self.handler(SimpleNamespace(client=1))


class Page:
    """The calls of a page that sliders use."""

    def add_slider(
        self, label: str, low: float, high: float, step: float, value: float, *, hint: Any
    ) -> Widget:
        return Widget(label, value)

    def add_text(self, label: str, value: str, *, hint: Any) -> Widget:
        return Widget(label, value)

    def add_markdown(self, text: str, *, visible: bool) -> Widget:
        return Widget("", None)


class Bench:
    """Three fields of a design that takes nothing above 4."""

    def __init__(self) -> None:
        self.state = {
            "design.layers.elastomer_mm": 2.0,
            "design.layers.support_mm": 1.0,
            "design.shape.width_mm": 3.0,
        }
        server = SimpleNamespace(gui=Page())
        self.fields = Fields(server, self.state.__getitem__, self.edit)
        span = (0.5, 6.0, 0.1)
        self.wall, self.support, self.width = (
            self.fields.slider(label, path, span=span)
            for label, path in zip(("Wall", "Support", "Width"), self.state, strict=True)
        )

    def edit(self, path: str, value: float) -> None:
        if value > 4.0:
            self.fields.refuse(path)
            self.fields.complain(DesignError("too thick", at="layers.elastomer_mm"))
        else:
            self.state[path] = value
            self.fields.settle(path)


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_refused_values_go_when_another_edit_succeeds(bench: Bench) -> None:
    """Wall 6 and support 5 are refused; width 2 is taken: the boxes say 2, 1 and 2."""
    bench.wall.entered(6.0)
    bench.support.entered(5.0)
    assert (bench.wall.value, bench.support.value) == (6.0, 5.0)
    bench.width.entered(2.0)
    assert (bench.wall.value, bench.support.value, bench.width.value) == (2.0, 1.0, 2.0)
    complaint = bench.fields._fields["design.layers.elastomer_mm"].complaint
    assert not complaint.visible


def test_an_entry_at_the_end_of_a_slider_says_so(bench: Bench) -> None:
    """0.5 is the lower end: the ends stand under the slider; 1 takes them away."""
    complaint = bench.fields._fields["design.shape.width_mm"].complaint
    bench.width.entered(0.5)
    assert complaint.visible
    assert "from 0.5 to 6" in complaint.content
    bench.width.entered(1.0)
    assert not complaint.visible


def test_messages_use_labels_of_the_part_they_are_about(bench: Bench) -> None:
    """Bare names beside the field are its neighbours' labels; the same word elsewhere is not."""
    text = "lower support_mm or layers.elastomer_mm; width_mm stays"
    words = bench.fields.in_words(text, "layers.elastomer_mm")
    assert words == "lower “Support” or “Wall”; width_mm stays"


LAMPS = "design.optics.lamps"


class Lights:
    """Two lamps of a design, of which one is edited, and a line of colours."""

    def __init__(self) -> None:
        self.state: dict[str, Any] = {
            f"{LAMPS}[1].power": 1.0,
            f"{LAMPS}[2].power": 3.0,
            "design.optics.ring.colours": ("#ff0000",),
        }
        self.fields = Fields(
            SimpleNamespace(gui=Page()), self.state.__getitem__, self.state.__setitem__
        )
        self.fields.anchor("Lamps", LAMPS)
        self.power = self.fields.slider("Power", f"{LAMPS}[1].power", span=(0.0, 5.0, 0.1))
        self.colours = self.fields.text(
            "Colours",
            "design.optics.ring.colours",
            read=lambda text: read_colours(text, at="optics.ring.colours"),
            write=colour_words,
        )


@pytest.fixture
def lights() -> Lights:
    return Lights()


def test_widgets_can_edit_another_lamp(lights: Lights) -> None:
    """Rebound to lamp 2 they show 3, and what is entered is lamp 2's."""
    lights.fields.rebind(f"{LAMPS}[1]", f"{LAMPS}[2]")
    assert lights.power.value == 3.0
    lights.power.entered(4.0)
    assert lights.state[f"{LAMPS}[2].power"] == 4.0
    assert lights.state[f"{LAMPS}[1].power"] == 1.0


def test_a_lamp_that_is_not_on_show_has_its_message_at_the_list(lights: Lights) -> None:
    """Of lamp 1 under its widget, of lamp 2 under the list; of another part nowhere."""
    error = DesignError("in the wall", at="optics.lamps[1].power")
    assert lights.fields.complain(error) == f"{LAMPS}[1].power"
    assert lights.fields.complain(DesignError("in it", at="optics.lamps[2].power")) == LAMPS
    assert lights.fields.complain(DesignError("dark", at="optics.camera")) == ""


def test_a_text_is_read_once_it_is_whole(lights: Lights) -> None:
    """Letters alone change nothing; when read, red and 525nm; nonsense is told beneath."""
    path = "design.optics.ring.colours"
    for text in ("r", "red, 5", "red, 525nm"):
        lights.colours.entered(text)
        lights.fields.read_typed()
        assert lights.state[path] == ("#ff0000",)
    lights.fields.read_typed(now=True)
    assert lights.state[path] == ("#ff0000", "525nm")
    lights.colours.entered(" , ")
    lights.fields.read_typed(now=True)
    complaint = lights.fields._fields[path].complaint
    assert complaint.visible
    assert "no colour is given" in complaint.content
    lights.fields.settle()
    assert lights.colours.value == "red, 525nm"


@pytest.mark.parametrize(("items", "name"), [("lamps", "power"), ("cameras", "fov_x_deg")])
def test_a_refused_value_goes_with_its_lamp_or_camera(items: str, name: str) -> None:
    """Item 1 holds a refused value and is removed: its widget stays, nothing is raised."""
    optics = Optics(lamps=(Lamp(power=2.0),), cameras=(Camera(fov_x_deg=50.0),))
    state = {"design": SensorDesign(optics=optics)}
    path = f"design.optics.{items}[1].{name}"
    server = SimpleNamespace(gui=Page())
    fields = Fields(server, lambda field: read_field(state, field), lambda path, value: None)
    widget = fields.slider("Number", path, span=(0.0, 90.0, 0.5))
    widget.value = 80.0
    fields.refuse(path)
    fields.settle()
    assert widget.value == {"lamps": 2.0, "cameras": 50.0}[items]
    fields.refuse(path)
    state["design"] = state["design"].replace(f"optics.{items}", ())
    assert fields.complain(DesignError("in the wall", at=f"optics.{items}[1].{name}")) == path
    fields.settle()
    fields.refresh()
    assert not fields._fields[path].complaint.visible
