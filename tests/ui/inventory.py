"""Every control of the running workbench: its page, folders, label and hint, as the page gets them.

Read from viser's messages, so that controls in closed folders and hidden ones are there too.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ui.page.keys import in_words
from workbench.proof.benchmarks.tab import Tab

KINDS = (
    "Slider MultiSlider Number Text Checkbox Dropdown ButtonGroup Button UploadButton "
    "Vector2 Vector3 Rgb Rgba"
).split()
MORE = """
[[optics.lamps]]
kind = "area"
[[optics.cameras]]
[optics.camera.sensor]
noise = true
[optics.markers]
visible = true
"""
"""What brings further controls out: a lamp, a second camera, noise, markers."""
HEADER = "above the tabs"
LAST = "Help: View"
"""What is laid out last."""


@dataclass(frozen=True, kw_only=True)
class Control:
    """One thing to click, drag or type into."""

    page: str
    """Label of its tab."""
    folders: tuple[str, ...]
    """Labels of the folders around it, the outermost first."""
    closed: tuple[str, ...]
    """Those of them that a person has to open."""
    kind: str
    label: str
    hint: str
    visible: bool
    """Whether it and all around it are on show."""
    options: tuple[str, ...]
    """Of a row of buttons or a drop-down."""


def controls(tab: Tab) -> list[Control]:
    """All of a server, page by page and from top to bottom."""
    children: dict[str, list[str]] = {}
    for uuid, props in list(tab.widgets.items()):
        children.setdefault(props.get("container", ""), []).append(uuid)
    return [
        control
        for container, page, visible in _pages(tab)
        for control in _within(tab, children, container, (page, (), (), visible))
    ]


def _pages(tab: Tab) -> Iterator[tuple[str, str, bool]]:
    """Container, name and visibility of each page."""
    yield "root", HEADER, True
    for props in list(tab.widgets.values()):
        labels, containers = props.get("_tab_labels"), props.get("_tab_container_ids")
        for label, container in zip(labels or (), containers or (), strict=True):
            yield container, label, bool(props.get("visible", True))


def _within(
    tab: Tab,
    children: dict[str, list[str]],
    container: str,
    where: tuple[str, tuple[str, ...], tuple[str, ...], bool],
) -> Iterator[Control]:
    page, folders, closed, around = where
    for uuid in sorted(children.get(container, ()), key=lambda u: tab.widgets[u].get("order", 0.0)):
        props = tab.widgets[uuid]
        kind = props["kind"].removeprefix("Gui").removesuffix("Message")
        visible = around and bool(props.get("visible", True))
        label = props.get("label") or ""
        if kind == "Folder":
            named = (*folders, label) if label else folders
            shut = (*closed, label) if label and not props["expand_by_default"] else closed
            yield from _within(tab, children, uuid, (page, named, shut, visible))
        elif kind in KINDS:
            yield Control(
                page=page,
                folders=folders,
                closed=closed,
                kind=kind,
                label=label,
                hint=props.get("hint") or "",
                visible=visible,
                options=tuple(str(option) for option in props.get("options") or ()),
            )


def names(tab: Tab) -> set[str]:
    """All that a person reads on tabs, folders, controls and buttons, and every key."""
    found = {"Ctrl + K"}
    for control in controls(tab):
        found |= set(control.options)
    for props in list(tab.widgets.values()):
        found |= {props.get("label") or "", *(props.get("_tab_labels") or ())}
    for props in list(tab.commands.values()):
        found |= {props["label"], in_words(props["hotkey"], props["modifier"])}
    return found - {""}


def laid_out(tab: Tab) -> Tab:
    """The tab, once all panels are there: the server answers before they are."""
    tab.wait(
        lambda: any(message["type"] == "ReplayDoneMessage" for _, message in list(tab.seen)),
        30.0,
        "all that stands has come",
    )
    tab.uuid(LAST, 60.0)
    return tab
