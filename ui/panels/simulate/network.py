"""Forces by a trained network: asked for, or by themselves where the network knows the press.

After a press and its image have come, a press that the weights know is predicted in the background,
and gives way to the next one; any other press only when the designer asks.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.offer import offer
from workbench.live.requests import PREDICTION
from workbench.pipeline.chosen_weights import FOLDER, offered
from workbench.pipeline.shipped import RETRAIN
from workbench.pipeline.stages.learned import foreknown

PREDICT = "Predict by the network"
JOB = "learned"
MOST_FRAMES = 30
"""Longer presses are predicted only when asked for: they take as many seconds."""
CHOICES = {
    "weights": (
        "Force network",
        f"Weights that ship, or those in the folder {FOLDER} of the project",
    ),
    "displacement": (
        "Displacement network",
        "Predicts the displacement of finite elements; or the contact solver's own is taken",
    ),
}
"""Label and hint of each field of the settings."""
UNTRAINED = (
    "No trained network comes with this version. Train one with "
    f"`{RETRAIN.format(target='force')}` and put it into the folder `{FOLDER}` of the project."
)


class NetworkPart:
    """Widgets between the table of sources and those of finite elements."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui = desk.server.gui
        self.about = gui.add_markdown("", visible=False)
        hint = "Seconds; what the network does not know of this press is said"
        self.button = gui.add_button(PREDICT, icon=viser.Icon.BRAIN, hint=hint)
        desk.reports.beside(JOB)
        self.button.on_click(desk.guarded(self._predict))
        self.choices: dict[str, Any] = {}
        self._offered: dict[str, dict[str, str]] = {}
        for field, (label, hint) in CHOICES.items():
            handle = gui.add_dropdown(label, ("",), hint=hint, visible=False)
            handle.on_update(desk.guarded(self._chooser(field)))
            self.choices[field] = handle
        self.refresh()

    def refresh(self) -> None:
        """Offer the networks that there are, and say so where there is none."""
        session = self.desk.session
        settings, folder = session.case.learned, session.project.folder
        there = "learned" in session.calls()
        for field, handle in self.choices.items():
            found = self._offered[field] = offered(folder, settings, field)
            setting = getattr(settings, field)
            now = next(name for name, value in found.items() if value == setting)
            offer(handle, list(found), preferred=now)
            _show(handle, len(found) > 1 and (there or field == "weights"))
        _show(self.button, there)
        _show(self.about, not there)
        if self.about.content != UNTRAINED:
            self.about.content = UNTRAINED

    def follow(self) -> None:
        """Predict a press that has come with its image, if the network chosen knows it."""
        desk, session = self.desk, self.desk.session
        call = session.calls().get(JOB)
        if call is None or desk.live or not (desk.current("press") and desk.current("shoot")):
            return
        known = session.case.press.frame_count <= MOST_FRAMES and not foreknown(call.inputs)
        if known and not session.store.has(call.stage, call.key):
            desk.jobs.submit(PREDICTION, session.design, session.case, (JOB,))

    def give_way(self) -> None:
        """Stop predicting: something that was asked for needs the worker."""
        self.desk.conductor.stop(PREDICTION)

    def _predict(self, event: Any) -> None:
        self.desk.run(JOB, ("press", JOB))

    def _chooser(self, field: str) -> Callable[[Any], None]:
        def choose(event: Any) -> None:
            if event.client is None:
                return
            setting = self._offered[field].get(self.choices[field].value)
            if setting is not None:
                self.desk.edit(f"case.learned.{field}", setting)
                self.follow()

        return choose


def _show(handle: Any, wanted: bool) -> None:
    if handle.visible != wanted:
        handle.visible = wanted
