"""Compare: keep variants with their numbers and images, and set two beside each other."""

from __future__ import annotations

import html
from typing import Any

import numpy as np

from ui.desk import Desk
from ui.imaging import placeholder
from workbench.core.errors import DesignError, WorkbenchError
from workbench.core.mapping import to_table
from workbench.image_views import visible_change
from workbench.project import design_table
from workbench.variants import Variant, list_variants, load_variant, save_variant

NONE = "-"


class ComparePanel:
    """Widgets of the sixth tab."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui = desk.server.gui
        self.name = gui.add_text("Variant", next_name(list_variants(desk.session.project)))
        save = gui.add_button("Save variant", hint="Keeps the design, the press and its numbers")
        save.on_click(desk.guarded(self._save))
        self.a = gui.add_dropdown("A", (NONE,))
        self.b = gui.add_dropdown("B", (NONE,))
        for handle in (self.a, self.b):
            handle.on_update(desk.guarded(lambda event: self._compare()))
        self.load = gui.add_button_group("Load", ("A", "B"))
        self.load.on_click(desk.guarded(self._load))
        self.image_a = gui.add_image(placeholder(), label="A", format="jpeg", visible=False)
        self.image_b = gui.add_image(placeholder(), label="B", format="jpeg", visible=False)
        self.change = gui.add_image(placeholder(), label="B - A", format="jpeg", visible=False)
        self.table = gui.add_html("")
        self._offer()

    def _save(self, event: Any) -> None:
        session = self.desk.session
        shot, contact = session.result("shoot"), session.result("press")
        if shot is None or contact is None:
            raise DesignError(
                "this design has not been pressed yet", hint="press Run press, then save", at="name"
            )
        name = self.name.value.strip()
        save_variant(session.project, name, session.state, session.calls())
        self.desk.log(f"variant {name} saved")
        self.desk.reports.notify("Saved", f"{name}: design, press and numbers", color="green")
        self._offer()
        empty = [handle for handle in (self.a, self.b) if handle.value == NONE]
        if empty:
            empty[0].value = name
        self.name.value = next_name(list_variants(session.project))

    def _offer(self) -> None:
        names = (NONE, *list_variants(self.desk.session.project))
        for handle in (self.a, self.b):
            now = handle.value
            handle.options = names
            handle.value = now if now in names else NONE

    def _variant(self, handle: Any) -> Variant | None:
        if handle.value == NONE:
            return None
        return load_variant(self.desk.session.project, handle.value)

    def _load(self, event: Any) -> None:
        variant = self._variant(self.a if self.load.value == "A" else self.b)
        if variant is not None:
            self.desk.session.replace_state(variant.state)
            self.desk.replaced()

    def _compare(self) -> None:
        a, b = self._variant(self.a), self._variant(self.b)
        both = a is not None and b is not None
        for handle in (self.image_a, self.image_b, self.change):
            handle.visible = both
        if a is None or b is None:
            self.table.content = ""
            return
        self.table.content = comparison(a, b)
        images = [self._image(variant) for variant in (a, b)]
        self.image_a.image, self.image_b.image = images
        same = images[0].shape == images[1].shape
        self.change.visible = same
        if same:
            self.change.image = visible_change(images[1], images[0])[0]

    def _image(self, variant: Variant) -> np.ndarray:
        store = self.desk.session.store
        try:
            return np.asarray(store.load("shoot", variant.shoot_key).frames.rgb[-1])
        except WorkbenchError as error:
            self.desk.reports.report(error)
            return placeholder()

    def refresh(self) -> None:
        """Variants do not follow the state."""

    def show(self, stage: str, result: Any) -> None:
        """Variants do not follow results."""


def next_name(taken: list[str]) -> str:
    """The first free name of variant A, B, ... Z, else one with a number."""
    letters = (f"variant {letter}" for letter in "ABCDEFGHIJKLMNOPQRSTUVWXYZ")
    return next((name for name in letters if name not in taken), f"variant {len(taken) + 1}")


def comparison(a: Variant, b: Variant) -> str:
    """Parameters in which two variants differ, then their numbers, side by side as HTML."""
    left, right = _parameters(a), _parameters(b)
    rows = [
        (name, left.get(name, NONE), right.get(name, NONE))
        for name in {**left, **right}
        if left.get(name) != right.get(name) and name != "name"
    ]
    rows += [
        (name, f"{a.metrics[name]:.4g}", f"{b.metrics[name]:.4g}")
        for name in a.metrics
        if name in b.metrics
    ]
    cells = "".join(
        "<tr>"
        + "".join(f"<td style='padding:2px 8px'>{html.escape(c)}</td>" for c in row)
        + "</tr>"
        for row in (("", a.name, b.name), *rows)
    )
    return f"<table style='font-size:12px;margin:8px'>{cells}</table>"


def _parameters(variant: Variant) -> dict[str, str]:
    state = variant.state
    return {**_flat(design_table(state.design)), **_flat(to_table(state.case.press), "press.")}


def _flat(table: dict[str, Any], prefix: str = "") -> dict[str, str]:
    flat: dict[str, str] = {}
    for name, value in table.items():
        if isinstance(value, dict):
            flat |= _flat(value, f"{prefix}{name}.")
        else:
            flat[f"{prefix}{name}"] = str(value)
    return flat
