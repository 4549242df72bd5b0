"""Says what will be refused while the designer's hand is still on the slider.

At each change a lane is asked what of lights, cameras, target and depth does not fit the body
(`workbench.planning.foresight`), before anything is meshed or baked. What it finds stands on top of
all tabs, with one click that brings lights and cameras inside; it goes when it no longer holds.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ui.desk.desk import Desk
from ui.page.colours import RED
from ui.page.plain import plain
from workbench.core.base.errors import DesignError
from workbench.live.requests import FORESIGHT, Request
from workbench.planning.fitting import fitted
from workbench.planning.foresight import ForesightCall, foresight_call


class Foresight:
    """What does not fit, on one desk."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self._asked: ForesightCall | None = None
        desk.jobs.on_preview[FORESIGHT] = self._show
        desk.header.fit.on_click(desk.guarded(self._fit))

    def follow(self) -> None:
        """Ask for the state as it stands, unless it was asked last."""
        session = self.desk.session
        call = foresight_call(session.design, session.case)
        if call != self._asked:
            self._asked = call
            self.desk.conductor.ask(FORESIGHT, session.design, session.case, call)

    def failed(self) -> None:
        """The body cannot be built, which is told at its sliders: nothing is known of the rest."""
        self._asked = None
        self._put(())

    def _show(self, found: Sequence[DesignError], request: Request) -> None:
        # An older answer along a drag would flicker.
        if request.preview == self._asked:
            self._put(found)

    def _put(self, found: Sequence[DesignError]) -> None:
        header, in_words = self.desk.header, self.desk.fields.in_words
        lines = [f"{in_words(e.message, e.at)}; {in_words(e.hint, e.at)}" for e in found]
        text = "<br>".join(plain(f"{line[:1].upper()}{line[1:]}.") for line in lines)
        header.misfit.content = f"<span style='color:{RED}'>**Does not fit:** {text}</span>"
        header.misfit.visible = bool(lines)
        header.fit.visible = any(error.at.startswith("optics") for error in found)

    def _fit(self, event: Any) -> None:
        desk, body = self.desk, self.desk.scene.body
        if body.solid is None:
            return
        design, changed = fitted(desk.session.design, body.solid)
        if design == desk.session.design:
            desk.reports.notify("Nothing was moved", f"{changed or 'All of it is inside'}.")
            return
        desk.session.change_optics(design.optics)
        desk.replaced()
        desk.log(changed)
        desk.reports.notify("Moved inside", f"{changed}. Ctrl+Z takes it back.")
