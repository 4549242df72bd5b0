"""The object of the contact studio: gallery, size, edges, texture, files."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.callbacks import put
from ui.page.choice_hint import told_with_name
from ui.page.gallery import Card
from ui.panels.simulate.touching import TouchingRows
from workbench.core.base.errors import Cancelled, DesignError
from workbench.core.design.design import SensorDesign
from workbench.core.press.indenter import Indenter
from workbench.core.press.soft_body import SoftBody
from workbench.core.press.texture import Pattern
from workbench.edit.indenter_edit import (
    AT,
    another,
    cad_object,
    cad_trial,
    edge_mm,
    gallery,
    gallery_heading,
    needs_cad,
    pictured,
    resized,
    rounded,
    textured,
)
from workbench.edit.shipped_thumbnails import shipped_thumbnail
from workbench.live.object_file import ObjectFile
from workbench.live.requests import Finished
from workbench.view.choice_words import named, words

JOB = "object"
LOADED = "loaded mesh"
PATTERNS = named((*(p for p in Pattern if p is not Pattern.IMAGE), Pattern.IMAGE))
"""Textures by what designers read."""
SPAN_MM, MESH_SPAN_MM = 30.0, 300.0
"""Ends of the size slider."""


class ObjectFolder:
    """Widgets of the folder; `follow` is called after a change."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.names = gallery()
        self.labels = {name: label for label, name in self.names.items()}
        self.chosen = ""
        """Label of the last choice, to name an everyday object, which is a mesh by now."""
        self.chosen_mesh: Any = None
        desk.jobs.on_preview[JOB] = lambda found, request: self._take(found)
        gui, guarded = desk.server.gui, desk.guarded
        now = desk.session.case.indenter
        with gui.add_folder("Object"):
            hint = "What is pressed in; the gallery shows all as pictures"
            self.kind = gui.add_dropdown(
                "Object shape", (*self.names, LOADED), initial_value=self._label(now), hint=hint
            )
            self.kind.on_update(guarded(self._choose))
            told_with_name(self.kind, hint, self.names)
            hint = "All objects as pictures of the face that touches"
            button = gui.add_button("Gallery of objects", icon=viser.Icon.LAYOUT_GRID, hint=hint)
            button.on_click(guarded(self._open_gallery))
            hint = "Diameter, else the largest width"
            size_mm = min(now.size_mm, MESH_SPAN_MM)
            self.size = gui.add_slider("Size mm", 0.5, MESH_SPAN_MM, 0.5, size_mm, hint=hint)
            self.size.on_update(guarded(self._by_slider(resized, self._size)))
            hint = "Rounding of edges; sharper than a grid cell cannot be resolved"
            self.edge = gui.add_slider("Edge radius mm", 0.0, 3.0, 0.05, edge_mm(now), hint=hint)
            self.edge.on_update(guarded(self._by_slider(rounded, self._edge)))
            hint = "STL or OBJ in mm, or STEP"
            self.file = gui.add_upload_button("Load object", mime_type=".stl,.obj,.step,.stp",
                                              icon=viser.Icon.UPLOAD, hint=hint)  # fmt: skip
            self.file.on_upload(desk.reports.received(self._sent, self._load_file))
            self.touching = TouchingRows(desk, self._take)
            hint = "Its own elastomer and grid; takes several times as long"
            self.soft = gui.add_checkbox("Soft object", now.soft is not None, hint=hint)
            soft = now.soft or SoftBody()
            hint = "Young's modulus of the object; the top quarter of it is held"
            self.young = gui.add_number("Object MPa", soft.young_MPa, step=0.01, hint=hint)
            for widget in (self.soft, self.young):
                widget.on_update(guarded(self._soften))
            with gui.add_folder("Texture", expand_by_default=now.texture.raised):
                self._texture_widgets(now)

    def _texture_widgets(self, now: Indenter) -> None:
        gui, guarded, texture = self.desk.server.gui, self.desk.guarded, now.texture
        hint = "What is raised on the face that touches"
        now_raised = words(texture.pattern)
        self.pattern = gui.add_dropdown(
            "Pattern", tuple(PATTERNS), initial_value=now_raised, hint=hint
        )
        told_with_name(self.pattern, hint, PATTERNS)
        self.height = gui.add_slider(
            "Height mm", 0.0, 2.0, 0.05, texture.height_mm, hint="How far the texture stands out"
        )
        hint = "Period; of letters the height of a capital, of a picture its width"
        pitch_mm = min(texture.pitch_mm, 20.0)
        self.pitch = gui.add_slider("Pitch mm", 0.2, 20.0, 0.1, pitch_mm, hint=hint)
        self.text = gui.add_text("Letters", texture.text or "A", hint="What the texture spells")
        hint = "Bright places stand out"
        self.picture = gui.add_upload_button("Load picture", mime_type="image/*",
                                             icon=viser.Icon.PHOTO_UP, hint=hint)  # fmt: skip
        for widget in (self.pattern, self.height, self.pitch, self.text):
            widget.on_update(guarded(self._weave))
        self.picture.on_upload(guarded(self._load_picture))

    def _label(self, indenter: Indenter) -> str:
        if indenter.mesh is None:
            return self.labels[indenter.kind.value]
        return self.chosen if indenter.mesh is self.chosen_mesh else LOADED

    def _choose(self, event: Any) -> None:
        if event.client is None or self.kind.value == LOADED:
            self.refresh()
            return
        self._start(self.kind.value)

    def _start(self, label: str) -> None:
        """Take the object of a label of the gallery."""
        indenter = another(self.names[label], self.desk.session.case.indenter)
        self.chosen, self.chosen_mesh = label, indenter.mesh
        self._take(indenter)

    def _open_gallery(self, event: Any) -> None:
        cards = []
        for label, name in self.names.items():
            png = shipped_thumbnail(f"object-{name}")
            cards.append(Card(name=label, png=png, group=gallery_heading(name)))
        desk = self.desk
        desk.galleries.show(event.client, "Object to press", cards, desk.guarded(self._start))

    def _size(self) -> float:
        return float(self.size.value)

    def _edge(self) -> float:
        return float(self.edge.value)

    def _by_slider(
        self, change: Callable[[Indenter, float], Indenter], value: Callable[[], float]
    ) -> Callable[[Any], None]:
        def moved(event: Any) -> None:
            if event.client is None:
                return
            now = self.desk.session.case.indenter
            named = now.mesh is not None and now.mesh is self.chosen_mesh
            indenter = change(now, value())
            if named:
                self.chosen_mesh = indenter.mesh
            self._take(indenter)

        return moved

    def _weave(self, event: Any) -> None:
        """Take the texture that the widgets describe."""
        if event.client is None:
            return
        now, pattern = self.desk.session.case.indenter, PATTERNS[self.pattern.value]
        if pattern is Pattern.IMAGE and now.texture.image is None:
            raise DesignError(
                "there is no picture yet", hint="press Load picture", at="indenter.texture.image"
            )
        self._take(
            textured(
                now,
                dataclasses.replace(
                    now.texture,
                    pattern=pattern,
                    height_mm=float(self.height.value),
                    pitch_mm=float(self.pitch.value),
                    text=self.text.value if pattern is Pattern.LETTERS else "",
                    image=now.texture.image if pattern is Pattern.IMAGE else None,
                ),
            )
        )

    def _soften(self, event: Any) -> None:
        """Take the elastomer that the widgets describe, or none."""
        if event.client is None:
            return
        now = self.desk.session.case.indenter
        soft = SoftBody(young_MPa=float(self.young.value)) if self.soft.value else None
        self._take(dataclasses.replace(now, soft=soft))

    def _load_picture(self, event: Any) -> None:
        file = self.picture.value
        self._take(pictured(self.desk.session.case.indenter, file.name, file.content))

    def _sent(self) -> ObjectFile | SensorDesign:
        """What the worker is asked for, to read the uploaded file."""
        file = self.file.value
        if needs_cad(file.name):
            return cad_trial(file.name, file.content)
        return ObjectFile(name=file.name, content=file.content)

    def _load_file(self, sent: ObjectFile | SensorDesign) -> None:
        desk = self.desk
        desk.reports.settle()
        if isinstance(sent, SensorDesign):
            desk.trial(JOB, sent, "intake", self._read)
        else:
            desk.jobs.ask(JOB, sent, desk.session.state, self._read)

    def _read(self, event: Finished) -> None:
        """Take the object that the worker has read."""
        if isinstance(event.error, Cancelled):
            return
        if event.error is not None:
            if event.error.at.startswith("body"):
                # To the reader it was a body.
                event.error.at = AT
            raise event.error
        if event.request.preview is None:
            self._take(cad_object(event.request.design, self.desk.session.store))

    def _take(self, indenter: Indenter) -> None:
        desk = self.desk
        desk.session.replace_indenter(indenter)
        desk.reports.settle()
        self.refresh()
        desk.changed()

    def refresh(self) -> None:
        """Show the object as it stands."""
        now = self.desk.session.case.indenter
        self.touching.refresh()
        put(self.kind, self._label(now))
        put(self.size, min(max(now.size_mm, 0.5), MESH_SPAN_MM))
        put(self.edge, min(edge_mm(now), 3.0))
        put(self.pattern, words(now.texture.pattern))
        put(self.height, min(now.texture.height_mm, 2.0))
        put(self.pitch, min(max(now.texture.pitch_mm, 0.2), 20.0))
        put(self.soft, now.soft is not None)
        if now.soft is not None:
            put(self.young, now.soft.young_MPa)
        if self.young.visible != (now.soft is not None):
            self.young.visible = now.soft is not None
        meshed = now.mesh is not None
        top_mm = MESH_SPAN_MM if meshed or now.size_mm > SPAN_MM else SPAN_MM
        if self.size.max != top_mm:
            self.size.max = top_mm
        lettered = now.texture.pattern is Pattern.LETTERS
        if self.text.visible != lettered:
            self.text.visible = lettered
