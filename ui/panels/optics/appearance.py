"""How skin and picture look: coating, markers, background and surface detail."""

from __future__ import annotations

from typing import Any

import viser

from sim.optics.field.model import model_of
from ui.desk.desk import Desk
from ui.page.callbacks import put
from ui.page.choice_hint import told_with_name
from workbench.core.design.optics import Composition, MarkerPattern
from workbench.core.design.photo import PICTURE_ENDINGS, photo
from workbench.project.photos import shipped_photos
from workbench.system.uploads import own_name
from workbench.view.picture_words import picture_words

COATING, MARKERS = "design.optics.coating", "design.optics.markers"
BACKGROUND = "design.optics.background"
RENDERED = "rendered"
PICTURES = ",".join(PICTURE_ENDINGS)


class AppearanceFolders:
    """Widgets of the folders."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui = desk.server.gui
        with gui.add_folder("Coating", expand_by_default=False):
            self._coating()
        with gui.add_folder("Markers", expand_by_default=False):
            self._markers()
        with gui.add_folder("Background", expand_by_default=False):
            self._background()

    def _coating(self) -> None:
        fields = self.desk.fields
        share = (0.0, 1.0, 0.01)
        hint = "Share of light that it returns to all sides"
        fields.slider("Albedo", f"{COATING}.albedo", span=share, hint=hint)
        hint = "Glossy share straight on; 0.04 is a plastic"
        fields.slider("Gloss", f"{COATING}.specular", span=share, hint=hint)
        hint = "Of the gloss: 0.01 is a mirror, 1 is matt"
        fields.slider("Roughness", f"{COATING}.roughness", span=(0.01, 1.0, 0.01), hint=hint)
        hint = "Of the paper's reflection (Phong)"
        fields.slider("Phong diffuse", f"{COATING}.phong_diffuse", span=share, hint=hint)
        fields.slider("Phong specular", f"{COATING}.phong_specular", span=share, hint=hint)
        span = (1.0, 100.0, 1.0)
        fields.slider("Phong exponent", f"{COATING}.phong_exponent", span=span, hint=hint)

    def _markers(self) -> None:
        desk, fields, gui = self.desk, self.desk.fields, self.desk.server.gui
        fields.check("Markers", f"{MARKERS}.visible", hint="Dots printed on the skin")
        fields.choice(
            "Pattern",
            f"{MARKERS}.pattern",
            list(MarkerPattern),
            hint="How the dots lie; one from a picture is loaded below",
        )
        span = (0.5, 10.0, 0.25)
        fields.slider(
            "Marker pitch mm",
            f"{MARKERS}.spacing_mm",
            span=span,
            hint="From dot to dot on the skin at rest",
        )
        fields.slider(
            "Marker size mm",
            f"{MARKERS}.diameter_mm",
            span=(0.1, 5.0, 0.05),
            hint="Diameter of a dot",
        )
        hint = "Share of light that the ink returns, over the bare skin's"
        fields.slider("Ink", f"{MARKERS}.reflectance", span=(0.0, 2.0, 0.02), hint=hint)
        hint = "Width of the picture on the skin"
        fields.slider("Picture mm", f"{MARKERS}.picture_mm", span=(1.0, 100.0, 0.5), hint=hint)
        hint = "Its dark dots become markers, wrapped over the skin from above"
        self.pattern = gui.add_upload_button("Load marker picture", mime_type=PICTURES,
                                             icon=viser.Icon.PHOTO_UP, hint=hint)  # fmt: skip
        self.pattern.on_upload(desk.guarded(self._load_pattern))
        fields.anchor("Load marker picture", f"{MARKERS}.picture")

    def _background(self) -> None:
        desk, fields, gui = self.desk, self.desk.fields, self.desk.server.gui
        hint = "A photograph of the sensor at rest, to which the contact is added"
        self.background = gui.add_dropdown("Background", (RENDERED,), hint=hint)
        self.background.on_update(desk.guarded(self._choose))
        files = {picture_words(name): name for name in shipped_photos()}
        told_with_name(self.background, hint, files)
        fields.anchor("Background", BACKGROUND)
        hint = "Of as many pixels as the camera has"
        self.photograph = gui.add_upload_button("Load photograph", mime_type=PICTURES,
                                                icon=viser.Icon.PHOTO_UP, hint=hint)  # fmt: skip
        self.photograph.on_upload(desk.guarded(self._load_photograph))
        hint = "All anew takes longer: dents then cast shadows on all of the skin"
        path = "design.optics.composition"
        fields.choice("Composition", path, list(Composition), hint=hint)
        hint = "Textures of the object that are finer than the contact's grid"
        fields.check("Surface detail", "design.optics.detail", hint=hint)

    def _load_pattern(self, event: Any) -> None:
        file, desk = self.pattern.value, self.desk
        at = f"{MARKERS}.picture"
        picture = photo(own_name(file.name), file.content, at=at.split(".", 1)[1])
        desk.session.change(at, picture)
        desk.session.amend(f"{MARKERS}.pattern", MarkerPattern.PICTURE)
        desk.session.amend(f"{MARKERS}.visible", True)
        desk.replaced()
        desk.log(f"markers follow {picture.name}")

    def _load_photograph(self, event: Any) -> None:
        file = self.photograph.value
        picture = photo(own_name(file.name), file.content, at="optics.background")
        self.desk.edit(BACKGROUND, picture)
        self.refresh()

    def _choose(self, event: Any) -> None:
        if event.client is None:
            return
        chosen, now = self.background.value, self.desk.session.design.optics.background
        if now is None or chosen != picture_words(now.name):
            shipped = {picture_words(name): photo for name, photo in shipped_photos().items()}
            self.desk.edit(BACKGROUND, shipped.get(chosen))
        self.refresh()

    def refresh(self) -> None:
        """Show what the design reads, and its pictures by name."""
        optics, reveal = self.desk.session.design.optics, self.desk.fields.reveal
        paper = model_of(optics.light_model).paper
        for name in ("albedo", "specular", "roughness"):
            reveal(f"{COATING}.{name}", not paper)
        for name in ("phong_diffuse", "phong_specular", "phong_exponent"):
            reveal(f"{COATING}.{name}", paper)
        pictured = optics.markers.pattern is MarkerPattern.PICTURE
        reveal(f"{MARKERS}.picture_mm", pictured)
        reveal(f"{MARKERS}.spacing_mm", not pictured)
        now = RENDERED if optics.background is None else picture_words(optics.background.name)
        names = (RENDERED, *map(picture_words, shipped_photos()))
        names = names if now in names else (*names, now)
        if tuple(self.background.options) != names:
            self.background.options = names
        put(self.background, now)
