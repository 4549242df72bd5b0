"""Make: what the workshop needs to know, then parts, checks, recipe and files."""

from __future__ import annotations

from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.plain import plain
from ui.panels.make.checks import ChecksList, verdict
from ui.panels.make.downloads import Downloads
from ui.panels.make.parts import PartsTree
from ui.panels.make.recipe import recipe_html
from ui.panels.make.sensor_pack import SensorPack
from ui.panels.page import Page
from workbench.core.result.fabrication import FabricationCheck, FabricationPart
from workbench.edit.forms import silicones

STAGES = ("mould", "housing", "recipe", "package")
NOTHING = "No parts yet: press *Make parts*."


class MakePanel:
    """Widgets of the fifth tab."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui = desk.server.gui
        with gui.add_folder("Mould", expand_by_default=False):
            self._mould()
        with gui.add_folder("Casting and printer", expand_by_default=False):
            self._casting()
        with gui.add_folder("Housing", expand_by_default=False):
            self._housing()
        hint = "Mould, housing, recipe and files; half a minute or so"
        button = gui.add_button("Make parts", icon=viser.Icon.PRINTER, hint=hint)
        button.on_click(desk.guarded(self._make))
        hint = (
            "All parts, assemblies, build sheet and parts list; makes them first where they are not"
        )
        everything = gui.add_button("Download all (zip)", icon=viser.Icon.DOWNLOAD, hint=hint)
        everything.on_click(desk.guarded(lambda event: self.downloads.all(event, self._make)))
        desk.reports.beside("parts")
        self.status = gui.add_markdown(NOTHING)
        self.tree = PartsTree(desk)
        desk.put_parts_away.connect(self.tree.put_away)
        self.notes_folder = gui.add_folder("Notes", expand_by_default=False, visible=False)
        with self.notes_folder:
            self.notes = gui.add_markdown("")
        self.recipe_folder = gui.add_folder("Recipe", expand_by_default=False, visible=False)
        with self.recipe_folder:
            self.recipe = gui.add_html("")
        self.downloads = Downloads(desk)
        self.checks = ChecksList(desk, self.tree)
        self.pack = SensorPack(desk)
        self.asked = False
        self.offered: tuple[str, ...] = ()

    def _mould(self) -> None:
        fields, mould = self.desk.fields, "design.mould"
        named = {"least undercut decides": 0, "2": 2, "3": 3, "4": 4}
        fields.options(
            "Outer parts",
            f"{mould}.outer_parts",
            named,
            hint="Into how many the outer mould is split",
        )
        fields.slider(
            "Mould wall mm", f"{mould}.wall_mm", span=(3.0, 15.0, 0.5), hint="Around the cavity"
        )
        hint = "Linear, of the silicone while curing; the cavity is larger by it"
        fields.slider("Shrinkage %", f"{mould}.shrink_percent", span=(0.0, 3.0, 0.05), hint=hint)
        hint = "Taper of the core toward its tip"
        fields.slider("Draft deg", f"{mould}.draft_deg", span=(0.0, 5.0, 0.25), hint=hint)
        hint = "Gap between mating printed faces"
        fields.slider("Clearance mm", f"{mould}.clearance_mm", span=(0.0, 0.6, 0.05), hint=hint)
        hint = "Mouth of the pouring funnel"
        fields.slider("Gate mm", f"{mould}.gate_diameter_mm", span=(2.0, 20.0, 0.5), hint=hint)
        fields.slider(
            "Vents",
            f"{mould}.vent_count",
            span=(1, 8, 1),
            whole=True,
            hint="Channels for the air that the silicone drives out",
        )

    def _casting(self) -> None:
        fields = self.desk.fields
        fields.options(
            "Silicone",
            "design.casting.silicone",
            {n: n for n in silicones()},
            hint="For the casting recipe; the modulus is chosen on Shape",
        )
        hint = "Left in cup, gate and vents"
        fields.slider("Waste %", "design.casting.waste_percent", span=(0.0, 100.0, 5.0), hint=hint)
        hint = "Room of the printer along X, Y and Z"
        fields.point("Printer bed mm", "design.mould.bed_mm", step=5.0, hint=hint)
        hint = "Smallest feature that prints: nozzle, or twice the pixel"
        fields.slider("Feature mm", "design.mould.feature_mm", span=(0.05, 1.0, 0.05), hint=hint)

    def _housing(self) -> None:
        fields, housing = self.desk.fields, "design.housing"
        for label, name in (
            ("Camera width mm", "camera_width_mm"),
            ("Camera height mm", "camera_height_mm"),
            ("Camera depth mm", "camera_depth_mm"),
        ):
            hint = "Of the camera module, for its pocket"
            fields.slider(label, f"{housing}.{name}", span=(3.0, 30.0, 0.5), hint=hint)
        fields.slider(
            "LED width mm",
            f"{housing}.led_width_mm",
            span=(0.5, 6.0, 0.1),
            hint="Of the LED's body, for its pocket",
        )
        fields.slider(
            "LED height mm",
            f"{housing}.led_height_mm",
            span=(0.5, 6.0, 0.1),
            hint="Of the LED's body, for its pocket",
        )
        fields.slider(
            "Housing wall mm",
            f"{housing}.wall_mm",
            span=(1.0, 6.0, 0.25),
            hint="Of base, ring and camera mount",
        )
        fields.slider(
            "Fit gap mm",
            f"{housing}.clearance_mm",
            span=(0.0, 0.6, 0.05),
            hint="Between parts that slide into each other",
        )

    def _make(self, event: Any) -> None:
        self.asked = True
        self.desk.run("parts", STAGES)
        self._offer()

    def _offer(self) -> None:
        """Show what is stored for the design as it stands; hide what belongs to another."""
        session = self.desk.session
        fresh, calls = session.fresh(), session.calls()
        ready = tuple(calls[stage].key for stage in STAGES if fresh[stage])
        if ready != self.offered:
            self.offered = ready
            found = {stage: session.result(stage) for stage in STAGES[:3]}
            sets = [found[stage] for stage in ("mould", "housing") if found[stage] is not None]
            parts: tuple[FabricationPart, ...] = tuple(p for made in sets for p in made.parts)
            judged = [made for made in found.values() if made is not None]
            checks: tuple[FabricationCheck, ...] = tuple(c for made in judged for c in made.checks)
            notices = [made.notice for made in judged if made.notice]
            self.status.content = summary(parts, checks) if parts else NOTHING
            self.notes_folder.visible = bool(notices)
            remarks = [remark for notice in notices for remark in notice.split("; ")]
            self.notes.content = "\n\n".join(plain(remark) for remark in remarks)
            mould = found["mould"]
            self.tree.offer(parts, mould.motions if mould is not None else ())
            self.checks.offer(checks)
            recipe = found["recipe"]
            self.recipe_folder.visible = recipe is not None
            self.recipe.content = recipe_html(recipe) if recipe is not None else ""
            self.downloads.offer(parts if fresh["package"] else ())
        if self.asked and fresh["mould"] and fresh["housing"]:
            # Stored parts stay in the drawer until somebody asks for them.
            self.asked = False
            self.tree.bring_out()

    def refresh(self) -> None:
        """Follow the state."""
        self._offer()

    def show(self, stage: str, result: Any) -> None:
        """Follow results."""
        if stage in ("build", *STAGES):
            self._offer()


def summary(parts: tuple[FabricationPart, ...], checks: tuple[FabricationCheck, ...]) -> str:
    """How many parts there are, whether all are closed, and how the checks came out."""
    closed = sum(part.watertight for part in parts)
    return f"**{len(parts)}** parts, {closed} of them closed · checks: {verdict(checks)}"


PAGE = Page(place=5, label="Make", build=MakePanel)
