"""Make: the mould, its checks, the exploded view and the downloads."""

from __future__ import annotations

import io
import zipfile
from typing import Any

import viser

from ui.desk import Desk
from workbench.core.errors import WorkbenchError
from workbench.core.fabrication import MouldSet
from workbench.core.results import Bundle
from workbench.core.units import volume_ml

OVERLAP_LIMIT_MM3 = 1e-3
WALL_LIMIT_MM = 0.8
"""Two lines of a 0.4 mm nozzle [mm]."""


class MakePanel:
    """Widgets of the fourth tab."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui, fields = desk.server.gui, desk.fields
        with gui.add_folder("Mould"):
            fields.slider("Mould wall mm", "design.mould.wall_mm", span=(3.0, 15.0, 0.5))
            fields.slider("Shrinkage %", "design.mould.shrink_percent", span=(0.0, 3.0, 0.05))
            fields.slider("Clearance mm", "design.mould.clearance_mm", span=(0.0, 0.6, 0.05))
            fields.slider("Vents", "design.mould.vent_count", span=(1, 8, 1), whole=True)
        button = gui.add_button("Make mould", icon=viser.Icon.PRINTER)
        button.on_click(desk.guarded(self._make))
        self.asked = False
        self.offered = ""
        self.checks = gui.add_markdown("No mould yet.")
        self.view = gui.add_checkbox("Show mould", False, visible=False)
        self.view.on_update(desk.guarded(self._view))
        desk.put_mould_away = self._put_away
        self.spread = gui.add_slider("Explode", 0.0, 1.0, 0.05, 1.0, visible=False)
        self.spread.on_update(desk.guarded(lambda event: self._spread()))
        self.part = gui.add_dropdown("Part", ("-",), visible=False)
        self.part_button = gui.add_button(
            "Download part STL", icon=viser.Icon.DOWNLOAD, visible=False
        )
        self.part_button.on_click(desk.guarded(self._send_part))
        self.zip_button = gui.add_button("Download all (zip)", visible=False)
        self.zip_button.on_click(desk.guarded(self._send_all))

    def _make(self, event: Any) -> None:
        self.asked = True
        self.desk.run("mould", ("mould", "package"))
        if self.desk.session.fresh()["mould"]:
            self.show("mould", self._moulds())

    def _put_away(self) -> None:
        if self.view.value:
            self.view.value = False

    def _moulds(self) -> MouldSet | None:
        return self.desk.session.result("mould")

    def _bundle(self) -> Bundle:
        bundle = self.desk.session.result("package")
        if bundle is None:
            raise WorkbenchError(
                "the mould of this shape has not been made", hint="press Make mould first"
            )
        return bundle

    def _view(self, event: Any) -> None:
        moulds = self._moulds()
        if moulds is not None and self.view.value:
            self.desk.scene.show_mould(moulds, self.spread.value)
            self.desk.scene.show_sensor(False)
            self.desk.scene.step_back(moulds)
        else:
            self.desk.scene.clear_mould()
            self.desk.scene.show_sensor(True)
            self.desk.scene.step_forward()

    def _spread(self) -> None:
        self.desk.scene.spread_mould(self.spread.value)

    def _send_part(self, event: Any) -> None:
        name = f"{self.part.value}.stl"
        content = self._bundle().files[f"moulds/{name}"].tobytes()
        event.client.send_file_download(name, content, save_immediately=True)

    def _send_all(self, event: Any) -> None:
        buffer = io.BytesIO()
        with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, content in self._bundle().files.items():
                archive.writestr(name, content.tobytes())
        name = f"{self.desk.session.design.name}-mould.zip"
        event.client.send_file_download(name, buffer.getvalue(), save_immediately=True)

    def refresh(self) -> None:
        """Hide what belongs to another design's mould."""
        self._offer(self._moulds())

    def _offer(self, moulds: MouldSet | None) -> None:
        key = self.desk.session.calls()["mould"].key if moulds is not None else ""
        if key == self.offered:
            return
        self.offered = key
        made = moulds is not None
        for handle in (self.view, self.spread, self.part, self.part_button, self.zip_button):
            handle.visible = made
        if moulds is None:
            self.checks.content = "No mould yet."
            self.view.value = False
            return
        self.part.options = tuple(part.name for part in moulds.parts)
        self.checks.content = "\n\n".join(mould_checks(moulds))

    def show(self, stage: str, result: Any) -> None:
        """Show a new mould, or forget it when the body changed."""
        if stage == "mould":
            self._offer(result)
            # A stored mould stays in the drawer until somebody asks for it.
            if self.asked:
                self.asked = False
                self.view.value = True
        elif stage == "build":
            self._offer(self._moulds())


def mould_checks(moulds: MouldSet) -> list[str]:
    """One line per check: mark, number, limit."""
    closed = all(part.watertight for part in moulds.parts)
    wall, overlap = moulds.thinnest_wall_mm, moulds.overlap_mm3
    rows = [
        (closed, f"{len(moulds.parts)} parts, each one closed body"),
        (overlap <= OVERLAP_LIMIT_MM3, f"overlap {overlap:.1e} mm³ (at most {OVERLAP_LIMIT_MM3})"),
        (wall >= WALL_LIMIT_MM, f"thinnest wall {wall:.2f} mm (at least {WALL_LIMIT_MM})"),
    ]
    lines = [_mark(good) + text for good, text in rows]
    cast_ml = volume_ml(moulds.cast_volume_mm3)
    lines.append(f"silicone {cast_ml:.1f} ml · split at {moulds.split_azimuth_deg:.0f}°")
    return lines


def _mark(good: bool) -> str:
    colour, sign = ("#30a46c", "✓") if good else ("#e5484d", "✗")
    return f"<span style='color:{colour}'>**{sign}**</span> "
