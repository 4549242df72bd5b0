"""Contacts of the photographs, one after the other: seen, corrected, held out or left out."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.callbacks import put
from ui.page.colours import AMBER
from ui.page.imaging import placeholder
from ui.page.offer import offer
from ui.page.plain import plain
from ui.patches.image_click import image_clicks
from workbench.calibration.seen.photo_set import IDLE, Circle
from workbench.core.base.errors import Cancelled
from workbench.live.requests import Finished
from workbench.photographs.calls import CONTACTS, FindContacts, Found
from workbench.photographs.kept_photos import KeptPhoto, KeptPhotos, Use
from workbench.photographs.pictures import contact_picture
from workbench.report.image_files import difference
from workbench.system.names import NONE

COLUMN, ROW, RADIUS = "Contact column px", "Contact row px", "Contact radius px"
DIFFERENCE, PHOTO = "Difference", "Photograph"
SETTLE_S = 0.6
"""Quiet time after a correction, after which the exposure's drift is told anew [s]."""


class ContactsFolder:
    """Widgets of the folder."""

    def __init__(self, desk: Desk, kept: KeptPhotos, on_change: Callable[[], None]) -> None:
        self.desk, self.kept = desk, kept
        self.on_change = on_change
        self._corrected: tuple[str, float] | None = None
        """Photograph whose circle was moved, and when [s]."""
        gui = desk.server.gui
        self.folder = gui.add_folder("Contacts", visible=False)
        with self.folder:
            self._fill(gui)
        desk.jobs.on_preview[CONTACTS] = lambda found, request: self._take(found)
        desk.on_turn.append(self._turn)

    def _fill(self, gui: Any) -> None:
        guarded = self.desk.guarded
        hint = "Whose contact is shown"
        self.choice = gui.add_dropdown("Photo", (NONE,), hint=hint)
        self.choice.on_update(guarded(lambda event: self._draw()))
        steps = gui.add_button_group("Go to", ("Previous", "Next"), hint="One photograph on")
        steps.on_click(guarded(lambda event: self._step(1 if steps.value == "Next" else -1)))
        hint = "The difference from the idle photo, twice as strong, shows the contact best"
        self.view = gui.add_button_group("Look at", (DIFFERENCE, PHOTO), hint=hint)
        self.view.on_click(guarded(lambda event: self._draw()))
        gui.add_html(image_clicks(True, column=COLUMN, row=ROW))
        self.image = gui.add_image(placeholder(), format="jpeg")
        self.said = gui.add_markdown("")
        hint = "Middle of the contact from the left; a click on the picture puts it there"
        self.column = gui.add_slider(COLUMN, 0, 1, 1, 0, hint=hint)
        hint = "Middle of the contact from the top; a click on the picture puts it there"
        self.row = gui.add_slider(ROW, 0, 1, 1, 0, hint=hint)
        hint = "Of the circle in which the ball touches"
        self.radius = gui.add_slider(RADIUS, 1.0, 2.0, 0.5, 1.0, hint=hint)
        for slider, name in (
            (self.column, "column_px"),
            (self.row, "row_px"),
            (self.radius, "radius_px"),
        ):
            slider.on_update(guarded(lambda event, name=name: self._move(event, name)))
        hint = "Held out: predicted only, to test the calibration on"
        self.use = gui.add_dropdown("Used to", tuple(use.value for use in Use), hint=hint)
        self.use.on_update(guarded(self._set_use))
        hint = "Forgets what was typed of this contact and looks for it in the photograph"
        again = gui.add_button("Find contact again", icon=viser.Icon.SEARCH, hint=hint)
        again.on_click(guarded(self._again))

    @property
    def chosen(self) -> KeptPhoto | None:
        """The photograph on show."""
        found = (each for each in self.kept.photos if each.photo == self.choice.value)
        return next(found, None)

    def find(self) -> None:
        """Look for all contacts that are not known, and for the drift of those that are."""
        photos = self.kept.photos
        if self.kept.has_idle and photos:
            self._ask(photos)

    def _ask(self, photos: tuple[KeptPhoto, ...]) -> None:
        wanted = tuple((each.photo, each.circle) for each in photos)
        call = FindContacts(folder=self.kept.folder, wanted=wanted)
        self.said.content = "looking for contacts ..."
        self.desk.jobs.ask(CONTACTS, call, self.desk.session.state, self._ended)

    def _take(self, found: tuple[Found, ...]) -> None:
        """Keep what was found, but for what was corrected meanwhile."""
        known = {each.photo: each for each in self.kept.photos}
        changed = []
        for each in found:
            now = known.get(each.photo)
            if now is None or (now.by_hand and now.circle != each.circle):
                continue
            changed.append(
                dataclasses.replace(now, circle=each.circle, reason=each.reason, drift=each.drift)
            )
        self.kept.put(*changed)
        self.refresh()
        missed = [each.photo for each in found if each.circle is None]
        if missed:
            self.choice.value = missed[0]
        self.on_change()

    def _ended(self, finished: Finished) -> None:
        self._draw()
        if finished.error is not None and not isinstance(finished.error, Cancelled):
            self.desk.reports.report(finished.error)

    def _step(self, by: int) -> None:
        names = [each.photo for each in self.kept.photos]
        if names:
            now = names.index(self.choice.value) if self.choice.value in names else 0
            self.choice.value = names[(now + by) % len(names)]

    def _move(self, event: Any, name: str) -> None:
        """Take a number of the circle that was typed, dragged or clicked."""
        each = self.chosen
        if event.client is None or each is None:
            return
        typed = Circle(
            column_px=float(self.column.value),
            row_px=float(self.row.value),
            radius_px=float(self.radius.value),
        )
        # What was not touched keeps its fraction of a pixel.
        circle = typed
        if each.circle is not None:
            circle = dataclasses.replace(each.circle, **{name: getattr(typed, name)})
        self.kept.put(dataclasses.replace(each, circle=circle, by_hand=True, reason=""))
        self._corrected = (each.photo, time.monotonic())
        self._draw()
        self.on_change()

    def _turn(self) -> None:
        """Tell the drift of a photograph anew, once its contact rests."""
        if self._corrected is None or time.monotonic() - self._corrected[1] < SETTLE_S:
            return
        if self.desk.conductor.works_on(CONTACTS):
            return
        name, self._corrected = self._corrected[0], None
        photos = tuple(each for each in self.kept.photos if each.photo == name)
        if photos:
            self._ask(photos)

    def _set_use(self, event: Any) -> None:
        each = self.chosen
        if event.client is not None and each is not None:
            self.kept.put(dataclasses.replace(each, use=Use(self.use.value)))
            self.on_change()

    def _again(self, event: Any) -> None:
        each = self.chosen
        if each is not None:
            unknown = dataclasses.replace(each, circle=None, by_hand=False, reason="")
            self.kept.put(unknown)
            self._ask((unknown,))

    def refresh(self) -> None:
        """Offer the photographs of the set."""
        offer(self.choice, tuple(each.photo for each in self.kept.photos) or (NONE,))
        self._draw()

    def _draw(self) -> None:
        """Show the photograph that is chosen, its circle and what is known of it."""
        each = self.chosen
        if each is None or not self.kept.has_idle:
            return
        image = self.kept.image(each.photo)
        shown = image if self.view.value == PHOTO else difference(image, self.kept.image(IDLE))
        self.image.image = contact_picture(shown, each.circle)
        height, width = image.shape[:2]
        for slider, most in (
            (self.column, width - 1),
            (self.row, height - 1),
            (self.radius, 0.5 * min(height, width)),
        ):
            if slider.max != most:
                slider.value = min(slider.value, most)
                slider.max = most
        if each.circle is not None:
            put(self.column, round(each.circle.column_px))
            put(self.row, round(each.circle.row_px))
            put(self.radius, max(1.0, round(2.0 * each.circle.radius_px) / 2.0))
        put(self.use, each.use.value)
        self.said.content = said(each)


def said(each: KeptPhoto) -> str:
    """What is known of a photograph's contact and exposure."""
    if each.circle is None:
        reason = plain(each.reason) or "not looked for yet"
        remedy = "Click on its middle, or set this photograph to be left out."
        return f"<span style='color:{AMBER}'>No contact: {reason}. {remedy}</span>"
    how = "set by hand" if each.by_hand else "found"
    gain = ", ".join(f"{round(100.0 * (value - 1.0)):+d} %" for value in each.drift.gain)
    offset = ", ".join(f"{round(value):+d}" for value in each.drift.offset)
    pose = ""
    if each.place_mm is not None:
        pose = f" Pressed at {', '.join(f'{value:g}' for value in each.place_mm)} mm."
    return (
        f"Contact {how}: {each.circle.radius_px:.1f} px, ball {each.ball_mm:g} mm.{pose}<br>"
        f"Exposure since the idle photo, red, green, blue: {gain}; {offset} grey levels. "
        "It is taken back before the fit."
    )
