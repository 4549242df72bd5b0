"""Optics: camera, LED ring, light model, markers; renders on a button."""

from __future__ import annotations

from typing import Any

import viser

from ui.desk import Desk
from workbench.core.camera import LensModel
from workbench.core.lighting import LedMount, LightModel


class OpticsPanel:
    """Widgets of the third tab."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui, fields = desk.server.gui, desk.fields
        ring, camera = "design.optics.ring", "design.optics.camera"
        with gui.add_folder("LED ring"):
            fields.slider("LEDs", f"{ring}.count", span=(1, 24, 1), whole=True)
            fields.slider("Ring radius mm", f"{ring}.radius_mm", span=(1.0, 30.0, 0.25))
            fields.slider("LED height mm", f"{ring}.height_mm", span=(0.0, 40.0, 0.25))
            fields.slider("First LED deg", f"{ring}.phase_deg", span=(0.0, 360.0, 5.0))
            fields.slider("LED tilt deg", f"{ring}.tilt_deg", span=(-90.0, 90.0, 5.0))
            fields.choice("Mount", f"{ring}.mount", list(LedMount))
        with gui.add_folder("Camera"):
            fields.slider("View deg", f"{camera}.fov_x_deg", span=(30.0, 170.0, 1.0))
            fields.choice("Lens", f"{camera}.lens", list(LensModel))
            hint = "Optical centre, sensor frame: z counts from the base"
            fields.point("Camera mm", f"{camera}.position_mm", step=0.5, hint=hint)
        with gui.add_folder("Light and markers"):
            hint = "direct: 1/r2, shadows, glossy coating; the others as in the SimTac paper"
            fields.choice("Light model", "design.optics.light_model", list(LightModel), hint=hint)
            fields.check("Markers", "design.optics.markers.visible")
            span = (1.0, 10.0, 0.25)
            fields.slider("Marker pitch mm", "design.optics.markers.spacing_mm", span=span)
        button = gui.add_button("Render image", icon=viser.Icon.BULB, hint="Bake, then shoot (B)")
        button.on_click(desk.guarded(self._render))
        desk.reports.beside("image")
        command = gui.add_command("Render image", hotkey="B")
        command.on_trigger(desk.guarded(self._render))

    def _render(self, event: Any) -> None:
        self.desk.run("image", ("shoot",))

    def refresh(self) -> None:
        """All widgets are bound fields."""

    def show(self, stage: str, result: Any) -> None:
        """Nothing here follows results."""
