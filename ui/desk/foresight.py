"""Says what will be refused while the designer's hand is still on the slider.

Once that rests a lane is asked what of lights, cameras, target and depth does not fit the body
(`workbench.planning.foresight`), before anything is meshed or baked. What it finds stands on top of
all tabs, with one click that brings lights and cameras inside; it goes when it no longer holds.

It takes half a second of a core and of the lane that also answers what the hand waits for: body,
touch and preview come first.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from ui.desk.desk import Desk
from ui.page.colours import RED
from ui.page.plain import plain
from workbench.core.base.errors import DesignError
from workbench.live.requests import FORESIGHT, IMAGE_PREVIEW, SHAPE, TOUCH, Request
from workbench.planning.fitting import fitted
from workbench.planning.foresight import ForesightCall, foresight_call

REST_S = 0.3
"""How long nothing must change before it is asked [s]."""
FIRST = (SHAPE, TOUCH, IMAGE_PREVIEW)
"""Jobs that the hand waits for: it is asked when none of them works."""


class Foresight:
    """What does not fit, on one desk."""

    def __init__(self, desk: Desk, clock: Callable[[], float] = time.monotonic) -> None:
        self.desk = desk
        self._clock = clock
        self._asked: ForesightCall | None = None
        self._ask_at_s: float | None = None
        """When the state as it stands is asked about, at the earliest; None while it was."""
        desk.on_turn.append(self.turn)
        desk.jobs.on_preview[FORESIGHT] = self._show
        desk.header.fit.on_click(desk.guarded(self._fit))

    def follow(self) -> None:
        """The state has changed, or may have: ask about it once it rests."""
        session = self.desk.session
        if foresight_call(session.design, session.case) != self._asked:
            self._ask_at_s = self._clock() + REST_S

    def turn(self) -> None:
        """Ask about the state as it stands, if that is due and nothing else is waited for."""
        if self._ask_at_s is None or self._clock() < self._ask_at_s:
            return
        session, conductor = self.desk.session, self.desk.conductor
        if any(conductor.works_on(job) for job in FIRST):
            return
        self._ask_at_s = None
        call = foresight_call(session.design, session.case)
        if call != self._asked:
            self._asked = call
            conductor.ask(FORESIGHT, session.design, session.case, call)

    def failed(self) -> None:
        """The body cannot be built, which is told at its sliders: nothing is known of the rest."""
        self._asked = None
        self._put(())

    def _show(self, found: Sequence[DesignError], request: Request) -> None:
        session = self.desk.session
        if request.preview == foresight_call(session.design, session.case):
            self._put(found)
        elif request.preview == self._asked:
            # The state has moved on: an older answer would flicker. It may come back to this one.
            self._asked = None

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
