"""Live pressing: while it is on, every change of object, place or depth is followed at once.

Fast contact follows the hand; once that rests the contact solver settles the same press, and while
nothing is asked for, the rest of the skin is made ready for fast contact. Where that does not know
such presses, the contact solver follows the hand alone. Nothing of it is stored but what fast
contact knows of the skin: *Run press* computes the whole path.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from ui.desk.desk import Desk
from ui.scene.gizmo import Gizmo
from workbench.live.live_press import LiveCall, PressPreview, live_call, live_design
from workbench.live.requests import COMPLIANCE, LIVE, TOUCH, Request
from workbench.live.touch_press import TouchCall, touch_call

SETTLE_S = 0.3
"""How long the hand must rest before the contact solver settles what it holds [s]."""
READY_S = 2.0
"""How long nothing must be asked for before the rest of the skin is made ready [s]."""
SKIN = ("condensed", "hardening")
"""What is made ready."""


class LivePressFollower:
    """The live press of one desk."""

    def __init__(self, desk: Desk, clock: Callable[[], float] = time.monotonic) -> None:
        self.desk = desk
        self.gizmo = Gizmo(desk.scene.api, self._dragged, edits=desk.editor.edits)
        self._clock = clock
        self._asked: LiveCall | None = None
        self._solving = False
        """Whether the contact solver was asked for what was asked last."""
        self._settled = False
        """Whether the contact solver has answered what was asked."""
        self._settle_at_s: float | None = None
        """When the contact solver is asked for what is on show; None while it was, or may not."""
        self._ready_at_s: float | None = None
        """When the rest of the skin is asked for; None while it was, or may not."""
        self._unknown: TouchCall | None = None
        """A press that fast contact refused."""
        self._said = self._told = ""
        """What was said of the frame on show, and that with how far the skin is ready."""
        self._stops = 0
        """How often this stopped what makes the skin ready; a person may have, too."""
        desk.gizmos.append(self.gizmo)
        desk.on_turn.append(self.turn)
        desk.jobs.on_preview[LIVE] = self._show
        desk.jobs.on_preview[TOUCH] = self._show_touch

    def switch(self, on: bool) -> None:
        """Begin or end to follow changes."""
        desk = self.desk
        desk.live = on
        self._asked = self._unknown = None
        self._rest()
        self._stops = desk.conductor.cancels(COMPLIANCE)
        self.gizmo.show(on)
        if on:
            self._say("solving")
            self.follow()
            return
        self._say("")
        desk.conductor.stop_live()
        desk.conductor.give_up(TOUCH)
        desk.scene.clear_frames()
        desk.shown_results.forget("press", "shoot")
        desk.changed()

    def follow(self) -> None:
        """Ask for the state as it stands, unless that was asked last."""
        session, conductor = self.desk.session, self.desk.conductor
        call = live_call(session.design, session.case)
        self.place_gizmo()
        if call == self._asked:
            return
        self._asked = call
        self._rest()
        touch = touch_call(session.design, session.case)
        if touch is None or self._refused(touch):
            self._solve()
            return
        if session.store.has(touch.nodes.stage, touch.nodes.key):
            conductor.stop_live()
        else:
            # The first time, nodes and their compliance take longer than a press.
            self._solve()
        conductor.ask(TOUCH, live_design(session.design), session.case, touch)

    def turn(self) -> None:
        """Settle what the hand has left, and make the skin ready while nothing is asked for."""
        desk, now_s = self.desk, self._clock()
        if not desk.live:
            return
        self._tell_readiness()
        session, conductor = desk.session, desk.conductor
        if self._settle_at_s is not None and now_s >= self._settle_at_s:
            self._settle()
        if self._ready_at_s is not None and now_s >= self._ready_at_s and not conductor.busy:
            self._ready_at_s = None
            stopped_by_hand = conductor.cancels(COMPLIANCE) > self._stops
            if not stopped_by_hand:
                design = live_design(session.design)
                desk.jobs.submit(COMPLIANCE, design, session.case, SKIN, then=lambda event: None)

    def _solve(self) -> None:
        """Let the contact solver follow the hand, and say so."""
        self._say("solving")
        self._settle()

    def _settle(self) -> None:
        """Ask the contact solver for the state as it stands."""
        session = self.desk.session
        self._settle_at_s, self._solving = None, True
        self.desk.conductor.press_live(session.design, session.case)

    def _rest(self) -> None:
        """Forget what was to follow, and stop what uses the quiet."""
        conductor = self.desk.conductor
        self._settle_at_s = self._ready_at_s = None
        self._solving = self._settled = False
        if conductor.works_on(COMPLIANCE):
            conductor.stop(COMPLIANCE)
            self._stops += 1

    def _refused(self, touch: TouchCall) -> bool:
        """Whether fast contact refused this press, or any of this skin."""
        no = self._unknown
        return no is not None and (touch == no or touch.skin == no.skin)

    def _show_touch(self, preview: PressPreview, request: Request) -> None:
        """Show what fast contact says of a press, and let the newest one settle."""
        newest = request.case == self.desk.session.case
        if (newest and self._settled) or not self._shown(preview, request):
            return
        # A press that was stopped may still be on its way out: it settles nothing.
        if newest and not self._solving:
            self._settle_at_s = self._clock() + SETTLE_S

    def _show(self, preview: PressPreview, request: Request) -> None:
        """Show a frame that settled, unless the hand has moved on."""
        if request.case == self.desk.session.case and self._shown(preview, request):
            self._settled = True
            self._ready_at_s = self._clock() + READY_S

    def _shown(self, preview: PressPreview, request: Request) -> bool:
        """Show a frame, unless the sensor is another by now."""
        desk = self.desk
        if not desk.live or request.design != live_design(desk.session.design):
            return False
        mesh = desk.session.result("mesh")
        if mesh is None:
            return False
        desk.scene.show_live(mesh.outer, preview.contact)
        self.place_gizmo()
        desk.tell("live", preview)
        force_N = float(preview.contact.normal_N[-1])
        self._say(f"**{force_N:.3f} N** along the normal · {preview.words}")
        return True

    def _say(self, words: str) -> None:
        self._said = self._told = words
        self.desk.live_said(words)

    def _tell_readiness(self) -> None:
        """Say how far the skin is made ready; there is no bar for what nobody asked for."""
        running = self.desk.jobs.running.get(COMPLIANCE)
        share = f"; skin {running.fraction:.0%} ready for quick touches" if running else ""
        words = f"{self._said}{share}"
        if words != self._told:
            self._told = words
            self.desk.live_said(words)

    def place_gizmo(self) -> None:
        """Put the handle where the object stands."""
        self.gizmo.place(self.desk.scene.object.standing[:3])

    def object_drawn(self) -> None:
        """The handle stands where the object does; out of sight it waits for the next switch."""
        if self.desk.live:
            self.place_gizmo()

    def failed(self) -> None:
        """Take back what is said of a request that did not settle."""
        self._asked = None
        self._say("not solved: see the message")

    def touch_failed(self) -> None:
        """Fast contact does not know this press: the contact solver follows the hand."""
        session = self.desk.session
        self._unknown = touch_call(session.design, session.case)
        if self.desk.live and not self._solving:
            self._solve()

    def _dragged(self, place_mm: np.ndarray, wxyz: np.ndarray) -> None:
        """Aim at the skin nearest to where the handle was dragged."""
        desk = self.desk
        place = desk.scene.body.place_near((place_mm[0], place_mm[1], place_mm[2]))
        if not self.desk.live or place is None:
            return
        x, y, z = (round(float(c), 2) for c in place.point_mm)
        desk.edit("case.press.target_mm", (x, y, z))
        desk.fields.refresh()
