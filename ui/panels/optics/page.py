"""Optics: light model, lights, cameras, and how skin and image look; renders on a button."""

from __future__ import annotations

from typing import Any

import viser

from sim.optics.field.model import model_of, models
from ui.desk.desk import Desk
from ui.panels.optics.appearance import AppearanceFolders
from ui.panels.optics.bought import Bought
from ui.panels.optics.cameras import CameraFolders
from ui.panels.optics.handles import RING, Handle
from ui.panels.optics.lamps import LampsFolder
from ui.panels.optics.led_table import LedTable
from ui.panels.page import Page
from workbench.core.catalogue.led_part import led_parts
from workbench.core.design.lighting import LedMount
from workbench.edit.catalogue import led_name, with_leds
from workbench.edit.light_edit import colour_words, read_colours

BAKING = "design.optics.baking"


class OpticsPanel:
    """Widgets of the third tab."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui = desk.server.gui
        # Above the folders, which would bury it.
        button = gui.add_button("Render image", icon=viser.Icon.BULB, hint="Light, then image (B)")
        button.on_click(desk.guarded(self._render))
        desk.reports.beside("image")
        command = gui.add_command("Render image", hotkey="B")
        command.on_trigger(desk.guarded(self._render))
        with gui.add_folder("Light model"):
            self._light_model()
        with gui.add_folder("LED ring"):
            self._ring()
        self.leds = LedTable(desk)
        self.lamps = LampsFolder(desk)
        self.cameras = CameraFolders(desk)
        self.appearance = AppearanceFolders(desk)
        self.refresh()

    def _light_model(self) -> None:
        fields = self.desk.fields
        fields.choice(
            "Model",
            "design.optics.light_model",
            list(models()),
            hint="How light reaches skin and camera; what each knows stands below",
        )
        self.about = self.desk.server.gui.add_markdown("")
        hint = "Of the whole bake, or of each frame; four times as many halve the noise"
        fields.number("Photons", f"{BAKING}.photons", step=1_000_000, whole=True, hint=hint)
        hint = "Places on the skin at which light is gathered, about"
        fields.number("Light nodes", f"{BAKING}.nodes", step=1000, whole=True, hint=hint)
        fields.number("Light seed", f"{BAKING}.seed", step=1, whole=True, hint="Of the photons")

    def _ring(self) -> None:
        fields = self.desk.fields
        up = (False, False, True)
        self.bought = Bought(
            self.desk,
            "LED type",
            {name: part.title for name, part in led_parts().items()},
            name=lambda: led_name(self.desk.session.design.optics.ring),
            take=lambda design, name: with_leds(design, (name,)),
        )
        self.handle = Handle(self.desk, "Ring handle", path=lambda: RING, axes=up)
        hint = "0 for a sensor that has only further lights"
        fields.slider("LEDs", f"{RING}.count", span=(0, 24, 1), whole=True, hint=hint)
        fields.slider(
            "Ring radius mm",
            f"{RING}.radius_mm",
            span=(1.0, 30.0, 0.25),
            hint="From the axis to the middle of each LED",
        )
        fields.slider(
            "LED height mm", f"{RING}.height_mm", span=(0.0, 40.0, 0.25), hint="Above the base"
        )
        fields.slider(
            "First LED deg",
            f"{RING}.phase_deg",
            span=(0.0, 360.0, 5.0),
            hint="Azimuth of the first LED, from X to Y",
        )
        hint = "Outward from straight up"
        fields.slider("LED tilt deg", f"{RING}.tilt_deg", span=(-90.0, 90.0, 5.0), hint=hint)
        fields.choice(
            "Mount",
            f"{RING}.mount",
            list(LedMount),
            hint="What surrounds the LEDs; those in the support light it from its edge",
        )
        hint = "Of each sector: red, #ff0000, 525nm, 525nm/35nm or 5600K, with commas between"
        fields.text(
            "LED colours",
            f"{RING}.colours",
            read=lambda text: read_colours(text, at="optics.ring.colours"),
            write=colour_words,
            hint=hint,
        )
        hint = "Of each LED; the exposure follows, so only ratios to lamps matter"
        fields.slider("LED power", f"{RING}.power", span=(0.0, 5.0, 0.05), hint=hint)
        hint = "Diameter of the disc that shines; for traced light and glare"
        fields.slider("LED size mm", f"{RING}.size_mm", span=(0.1, 5.0, 0.05), hint=hint)
        hint = "Full angle that an LED shines into; 180 is the half space"
        fields.slider("LED cone deg", f"{RING}.cone_deg", span=(1.0, 180.0, 1.0), hint=hint)

    def _render(self, event: Any) -> None:
        self.desk.run("image", ("shoot",))

    def refresh(self) -> None:
        """Show what the chosen light model reads, and the lists as they stand."""
        model = model_of(self.desk.session.design.optics.light_model)
        fields, text = self.desk.fields, f"<small>{model.hint}</small>"
        if self.about.content != text:
            self.about.content = text
        fields.reveal(f"{BAKING}.photons", model.traced)
        fields.reveal(f"{BAKING}.seed", model.traced)
        fields.reveal(f"{BAKING}.nodes", model.tabulated)
        self.handle.follow()
        self.bought.refresh()
        self.leds.refresh()
        self.lamps.refresh()
        self.cameras.refresh()
        self.appearance.refresh()

    def show(self, stage: str, result: Any) -> None:
        """Nothing here follows results."""


PAGE = Page(place=3, label="Optics", build=OpticsPanel)
