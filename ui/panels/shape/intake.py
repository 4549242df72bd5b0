"""A body of the designer's own: upload, unit, an optional inner body, and labels by clicking.

A file is read on trial by the worker. Only one that can be read replaces the design, so a refused
file leaves everything as it was, with the reason under the button. Where a remesh would do, it is
offered with its deviation, and made by one click. What the reader repaired or inferred stands in
the note above the tabs.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.choice_hint import told_with_name
from ui.page.plain import plain
from workbench.core.base.errors import Cancelled, DesignError, WorkbenchError
from workbench.core.design.design import SensorDesign
from workbench.core.design.imported import (
    IMPORTED,
    BodyFile,
    ImportedBody,
    LengthUnit,
    Pick,
    body_file,
)
from workbench.live.requests import Finished
from workbench.system.uploads import MOST_BYTES, check_upload, own_name
from workbench.view.choice_words import named, words
from workbench.view.region_words import region_words

AIM = "nothing: a click aims"
REGIONS = {region_words(name): name for name in ("base", *(f"actuator_{i}" for i in range(4)))}
"""Labels of faces by what designers read."""
UNITS = named(LengthUnit)
"""Units by what designers read."""
BODY = "design.body"


class IntakeFolder:
    """Widgets inside the folder of imported bodies."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.trial: ImportedBody | None = None
        """What was last uploaded, kept until it is read: another unit may make it readable."""
        gui, fields = desk.server.gui, desk.fields
        hint = "Of an STL; a STEP file says its own"
        self.unit = gui.add_dropdown("File unit", tuple(UNITS), hint=hint)
        told_with_name(self.unit, hint, UNITS)
        self.unit.on_update(desk.guarded(self._choose_unit))
        fields.anchor("File unit", f"{BODY}.unit")
        hint = "The sensing side as a closed body, at most 40 MB; replaces the design"
        self.outer = gui.add_upload_button(
            "Load outer body", mime_type=".stl,.step,.stp", icon=viser.Icon.UPLOAD, hint=hint
        )
        self.outer.on_upload(desk.reports.received(self._sent_outer, self._load_outer))
        fields.anchor("Load outer body", f"{BODY}.outer")
        self.said = gui.add_markdown("")
        hint = "Remesh the file that was refused, with the deviation that is stated above"
        self.mend = gui.add_button("Repair and load", visible=False, hint=hint)
        self.mend.on_click(desk.guarded(self._mend))
        fields.anchor("Repair and load", f"{BODY}.repair")
        self.more = gui.add_folder("Inner body and labels", visible=False)
        with self.more:
            self._fill_more()
        desk.pick = self._pick

    def _fill_more(self) -> None:
        desk, gui, fields = self.desk, self.desk.server.gui, self.desk.fields
        hint = "What hollows it, in the same coordinates; without it the wall is even"
        self.inner = gui.add_upload_button(
            "Load inner body", mime_type=".stl,.step,.stp", hint=hint
        )
        self.inner.on_upload(desk.reports.received(self._sent_inner, self._load_inner))
        fields.anchor("Load inner body", f"{BODY}.inner")
        self.drop = gui.add_button(
            "Remove inner body", visible=False, hint="The wall is even again"
        )
        self.drop.on_click(desk.guarded(self._drop_inner))
        hint = "A second click on a face takes the label back"
        self.label = gui.add_dropdown("Clicks label", (AIM, *REGIONS), hint=hint)
        told_with_name(self.label, hint, REGIONS)
        fields.anchor("Clicks label", f"{BODY}.picks")

    @property
    def body(self) -> ImportedBody | None:
        """The body of the design, if it has one of its own."""
        return self.desk.session.design.body

    def _sent_outer(self) -> BodyFile:
        return self._received(self.outer, at="body.outer")

    def _load_outer(self, file: BodyFile) -> None:
        unit = UNITS[self.unit.value]
        self._try(ImportedBody(outer=file, unit=unit))

    def _sent_inner(self) -> BodyFile:
        return self._received(self.inner, at="body.inner")

    def _load_inner(self, file: BodyFile) -> None:
        if self.body is not None:
            self._try(dataclasses.replace(self.body, inner=file))

    def _drop_inner(self, event: Any) -> None:
        if self.body is not None:
            self._try(dataclasses.replace(self.body, inner=None))

    def _choose_unit(self, event: Any) -> None:
        body = self.trial or self.body
        if event.client is not None and body is not None:
            self._try(dataclasses.replace(body, unit=UNITS[self.unit.value]))

    def _mend(self, event: Any) -> None:
        if self.trial is not None:
            self._try(dataclasses.replace(self.trial, repair=True))

    def _received(self, button: Any, *, at: str) -> BodyFile:
        """The uploaded file; its digest is made without the desk's lock.

        Raises:
            DesignError: If it is too large, or neither STL nor STEP.
        """
        name, content = button.value.name, button.value.content
        with self.desk.reports.lock:
            self.desk.reports.settle()
        hint = "reduce the mesh, or use workbench serve FILE"
        check_upload(name, content, limit_bytes=MOST_BYTES, hint=hint, at=at)
        try:
            return body_file(own_name(name), content)
        except DesignError as error:
            error.at = at
            raise

    def _try(self, body: ImportedBody) -> None:
        """Have the worker read the files; the design follows once they are read."""
        design, self.trial = self.desk.session.design, body
        name, old = _name(body), design.body
        if design.family == IMPORTED and old is not None:
            kept = design.name if design.name != _name(old) else name
            candidate = dataclasses.replace(design, name=kept, body=body)
        else:
            candidate = SensorDesign(name=name, family=IMPORTED, body=body)
        self.desk.reports.settle()
        self.mend.visible = False
        self.said.content = f"reading {plain(body.outer.name)} ..."
        self.desk.trial("import", candidate, "intake", self._read)

    def _read(self, event: Finished) -> None:
        self.said.content = ""
        if isinstance(event.error, Cancelled):
            self.trial = None
            return
        if event.error is not None:
            self._refuse(event.error)
            return
        self.trial = None
        session, design = self.desk.session, event.request.design
        if session.design.family == IMPORTED:
            # What was edited while the file was read stays.
            own = dataclasses.replace(session.design, name=design.name, body=design.body)
            session.replace_state(dataclasses.replace(session.state, design=own))
        else:
            session.replace_design(design)
        self.desk.replaced()

    def _refuse(self, error: WorkbenchError) -> None:
        """Say why the file is not used, and offer the remesh that would make it usable."""
        offer = error.repair if isinstance(error, DesignError) else None
        if offer is not None:
            error.hint = f"press Repair and load: {offer.words}"
            self.said.content = f"On offer: {offer.words}."
        self.mend.visible = offer is not None
        self.desk.reports.report(error, edited=f"design.{error.at}")

    def _pick(self, face: int) -> bool:
        """Label the file's face under a click, or take its label back."""
        solid, body = self.desk.scene.body.solid, self.body
        if self.label.value == AIM or body is None or solid is None or not len(solid.patches):
            return False
        patch, region = int(solid.patches[face]), REGIONS[self.label.value]
        if patch >= 0:
            kept = tuple(pick for pick in body.picks if pick.patch != patch)
            again = Pick(patch=patch, region=region) in body.picks
            new = () if again else (Pick(patch=patch, region=region),)
            self.desk.edit(f"{BODY}.picks", (*kept, *new))
            self.desk.log(f"face {patch}: {'no label' if again else region_words(region)}")
        return True

    def refresh(self) -> None:
        """Offer what the body allows."""
        body = self.body
        self.more.visible = body is not None
        self.drop.visible = body is not None and body.inner is not None
        if body is None:
            self.label.value = AIM
        elif self.unit.value != words(body.unit):
            self.unit.value = words(body.unit)
        if self.trial is None:
            self.said.content = "" if body is None else _summary(body)

    def show(self, stage: str, result: Any) -> None:
        """Nothing here follows results."""


def _name(body: ImportedBody) -> str:
    """What a design of this body is called until the designer says otherwise."""
    return Path(body.outer.name).stem[:80] or IMPORTED


def _summary(body: ImportedBody) -> str:
    inner = "even wall" if body.inner is None else f"inner {plain(body.inner.name)}"
    labels = ((pick.patch, region_words(pick.region)) for pick in body.picks)
    picks = ", ".join(f"face {patch}: {plain(label)}" for patch, label in labels)
    return " · ".join(part for part in (f"outer {plain(body.outer.name)}", inner, picks) if part)
