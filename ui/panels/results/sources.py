"""Where forces come from: the contact solver, finite elements, a network, or how far two differ."""

from __future__ import annotations

from typing import Any

from ui.desk.desk import Desk
from ui.page.callbacks import put
from ui.page.offer import offer
from ui.panels.results.source_words import NONE, doubt_text, sources_text
from ui.panels.simulate.network import NetworkPart
from workbench.core.press.fem import DRAFT_MM, QUALITY_MM
from workbench.core.result.force_field import ForceField, Source
from workbench.core.result.results import Skin
from workbench.core.result.sensing import Contact
from workbench.planning.advised import advised
from workbench.view.force_sources import PAIRS, Forces, Shown, choices

SOLVE = "Solve by finite elements"
STAGES = {"forces": Source.FEM, "learned": Source.LEARNED}
"""Stages whose results are sources beside the contact solver."""


class SourcesFolder:
    """Widgets below the numbers of the contact solver."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.contact: Contact | None = None
        self.skin: Skin | None = None
        self.others: dict[Source, ForceField] = {}
        self._frame = 0
        self._texts: dict[tuple[int, tuple[Source, ...], str], str] = {}
        """What was said of a frame, with which sources stale and which advice: its peaks take tens
        of milliseconds, and playing asks for the same frames again and again."""
        gui, fields = desk.server.gui, desk.fields
        with gui.add_folder("Sources of forces", expand_by_default=False):
            hint = "What skin and arrows show; a difference is that of the quantity on show"
            self.choice = gui.add_dropdown("Forces from", (Shown.MPM.value,), hint=hint)
            self.doubt = gui.add_markdown("", visible=False)
            self.table = gui.add_markdown(NONE)
            self.network = NetworkPart(desk)
            hint = f"{QUALITY_MM:g} mm is to be trusted, {DRAFT_MM:g} mm is a draft, within 5 %"
            fields.number("FEM mesh mm", "case.fem.hex_mm", step=0.05, hint=hint)
            hint = "Radius around the target that takes part: 12 mm for fields, 9 mm for totals"
            fields.number("FEM radius mm", "case.fem.radius_mm", step=1.0, hint=hint)
            self.solve = gui.add_button(SOLVE, hint="Runs in the background; Cancel works")
            desk.reports.beside("forces")
        self.choice.on_update(desk.guarded(self._choose))
        self.solve.on_click(desk.guarded(self._solve))

    @property
    def found(self) -> dict[Source, Forces]:
        """All sources of the press on show, the contact solver first."""
        if self.contact is None:
            return {}
        return {Source.MPM: self.contact, **{s: self.others[s] for s in sorted(self.others)}}

    def _solve(self, event: Any) -> None:
        self.desk.run("forces", ("press", "forces"))

    def _choose(self, event: Any) -> None:
        if event.client is not None:
            self._put_on_skin()

    def take_contact(self, contact: Contact | None, skin: Skin | None = None) -> None:
        """Another press on a skin: what other sources found of the one before is not of this."""
        self.contact, self.skin = contact, skin
        self.others.clear()
        self._texts.clear()
        self._offer()
        if contact is not None and self.desk.session.calls().keys() & STAGES.keys():
            # Their results may be stored, and were shown before the press came.
            self.desk.shown_results.forget(*STAGES)
            self.desk.shown_results.show_stored()

    def take(self, stage: str, found: ForceField) -> None:
        """The result of another source, on the skin of the design."""
        if self.contact is None or len(found.reaction_N) != len(self.contact.reaction_N):
            return
        self.others[STAGES[stage]] = found
        self._texts.clear()
        self._offer(preferred=self.choice.value)
        self._put_on_skin()
        self.tell(self._frame)

    def _offer(self, preferred: str = "") -> None:
        names = [shown.value for shown in choices(self.found)] or [Shown.MPM.value]
        offer(self.choice, names, preferred=preferred)
        if not self.others:
            put(self.choice, Shown.MPM.value)
            self.table.content = NONE
        self._tell_doubt()

    def _tell_doubt(self) -> None:
        """Say above all numbers why those of the network are not to be trusted."""
        learned = self.others.get(Source.LEARNED)
        notice = "" if learned is None else learned.notice
        text = doubt_text(notice, self._advice()) if notice else ""
        if self.doubt.content != text:
            self.doubt.content = text
        if self.doubt.visible != bool(text):
            self.doubt.visible = bool(text)

    def _advice(self) -> str:
        """What was measured of presses like that of learned forces; "" of an earlier press."""
        learned, session = self.others.get(Source.LEARNED), self.desk.session
        if learned is None or not self.desk.current("learned"):
            return ""
        return advised(session.case, session.calls(), notice=learned.notice).text

    def _put_on_skin(self) -> None:
        pressed = self.desk.scene.pressed
        if self.contact is None or pressed.contact is not self.contact:
            return
        found = self.found
        source, against = PAIRS[Shown(self.choice.value)]
        pressed.show_source(found[source], None if against is None else found[against])

    def tell(self, frame: int) -> None:
        """Show the numbers of frame `frame`, counted from 0, of all sources."""
        self._frame = frame
        found, skin = self.found, self.skin
        if skin is None or not self.others:
            return
        if any(frame >= len(forces.reaction_N) for forces in found.values()):
            return
        stale = [s for stage, s in STAGES.items() if s in found and not self.desk.current(stage)]
        advice = "" if self.doubt.visible else self._advice()
        asked = frame, tuple(stale), advice
        if asked not in self._texts:
            self._texts[asked] = sources_text(found, frame, skin, stale=stale, advice=advice)
        if self.table.content != self._texts[asked]:
            self.table.content = self._texts[asked]
