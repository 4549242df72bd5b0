"""Where forces come from: the contact solver, finite elements, or how far the two are apart."""

from __future__ import annotations

from typing import Any

from ui.callbacks import put
from ui.desk import Desk
from ui.panels.offer import offer
from workbench.core.fem import DRAFT_MM, QUALITY_MM
from workbench.core.force_field import ForceField, Source
from workbench.core.sensing import Contact
from workbench.force_sources import WORDS, Shown, disagreement, totals
from workbench.phases import number

SOLVE = "Solve by finite elements"
NONE = (
    "Finite elements are the ground truth: the same press, on hexahedra of their own. A press of "
    "ten frames takes a minute or two as a draft, and ten times that at the quality mesh."
)
COARSE = (
    "**A mesh of {:g} mm is a draft**: finite elements read 10 % too much force at "
    f"{DRAFT_MM:g} mm; {QUALITY_MM:g} mm is to be trusted"
)
STALE = "**stale**: of an earlier design or press; solve again"


class SourcesFolder:
    """Widgets below the numbers of the contact solver."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.contact: Contact | None = None
        self.found: ForceField | None = None
        self._frame = 0
        gui, fields = desk.server.gui, desk.fields
        with gui.add_folder("Sources of forces", expand_by_default=False):
            hint = "What skin and arrows show; a difference is that of the quantity on show"
            self.choice = gui.add_dropdown("Forces from", (Shown.MPM.value,), hint=hint)
            self.table = gui.add_markdown(NONE)
            hint = (
                f"{QUALITY_MM:g} mm is to be trusted, {DRAFT_MM:g} mm is a draft, ~10 % too stiff"
            )
            fields.number("FEM mesh mm", "case.fem.hex_mm", step=0.05, hint=hint)
            hint = "Radius around the target that takes part: 12 mm for fields, 9 mm for totals"
            fields.number("FEM radius mm", "case.fem.radius_mm", step=1.0, hint=hint)
            self.solve = gui.add_button(SOLVE, hint="Runs in the background; Cancel works")
            desk.reports.beside("forces")
        self.choice.on_update(desk.guarded(self._choose))
        self.solve.on_click(desk.guarded(self._solve))

    def _solve(self, event: Any) -> None:
        self.desk.run("forces", ("press", "forces"))

    def _choose(self, event: Any) -> None:
        if event.client is not None:
            self._put_on_skin()

    def take_contact(self, contact: Contact | None) -> None:
        """Another press: what finite elements found of the one before is not of this one."""
        self.contact, self.found = contact, None
        self._offer()
        stored = self.desk.session.calls().get("forces")
        if contact is not None and stored is not None:
            # Its result may be stored, and was shown before the press came.
            self.desk.showing.forget("forces")
            self.desk.showing.show_stored()

    def take(self, found: ForceField) -> None:
        """The result of finite elements, on the skin of the design."""
        if self.contact is None or len(found.reaction_N) != len(self.contact.reaction_N):
            return
        self.found = found
        self._offer(preferred=self.choice.value)
        self._put_on_skin()
        self.tell(self._frame)

    def _offer(self, preferred: str = "") -> None:
        names = [Shown.MPM.value]
        if self.found is not None:
            names += [Shown.FEM.value, Shown.FEM_DIFFERENCE.value]
        offer(self.choice, names, preferred=preferred)
        if self.found is None:
            put(self.choice, Shown.MPM.value)
            self.table.content = NONE

    def _put_on_skin(self) -> None:
        pressed = self.desk.scene.pressed
        if self.contact is None or pressed.contact is not self.contact:
            return
        chosen = Shown(self.choice.value)
        if chosen is Shown.FEM and self.found is not None:
            pressed.show_source(self.found)
        elif chosen is Shown.FEM_DIFFERENCE and self.found is not None:
            pressed.show_source(self.found, self.contact)
        else:
            pressed.show_source(self.contact)

    def tell(self, frame: int) -> None:
        """Show the numbers of frame `frame`, counted from 0, of all sources."""
        self._frame = frame
        if self.found is None or self.contact is None or frame >= len(self.found.reaction_N):
            return
        rows = [
            totals(Source.MPM, self.contact, frame),
            totals(Source.FEM, self.found, frame),
        ]
        lines = [
            f"| {WORDS[row.source].value} | {number(row.normal_N, '.3f')} | "
            f"{number(row.tangential_N, '.3f')} | {number(1e3 * row.peak_N, '.1f')} |"
            for row in rows
        ]
        apart = disagreement(self.contact, self.found, frame)
        text = "\n".join(
            (
                "| source | normal N | tangential N | peak mN |",
                "|---|---|---|---|",
                *lines,
            )
        )
        text += (
            f"\n\nThe contact solver's normal force is "
            f"{number(100 * apart.normal_share, '+.1f')} % from that of finite elements, its "
            f"displacement {number(1e3 * apart.displacement_mm, '.0f')} µm (rms) of "
            f"{number(1e3 * apart.farthest_mm, '.0f')}.\n\n{self.found.solver}, residual "
            f"{number(self.found.residual.max(), '.0e')}"
        )
        if self.found.spacing_mm > QUALITY_MM:
            text += f". {COARSE.format(self.found.spacing_mm)}"
        if not self.desk.current("forces"):
            text = f"{STALE}\n\n{text}"
        if self.table.content != text:
            self.table.content = text
