"""The tab of the maps: where on the skin this design sees, and how well."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser

from ui.desk.desk import Desk
from ui.page.imaging import scale_bar, swatch, table
from ui.page.plain import plain
from workbench.core.base.errors import DesignError
from workbench.core.result.maps import DesignerMaps, SkinMap
from workbench.core.result.results import Skin
from workbench.system.names import NONE
from workbench.view.colour_scale import NOTHING_GREY, YES
from workbench.view.map_display import (
    MapLook,
    heights_words,
    is_flag,
    map_look,
    ordered,
    score_rows,
    value_at,
    value_words,
    yes_no,
)

NO_MAPS = "Where on the skin this design sees, and how well. Not measured yet."
STALE = "**stale**: the design has changed, measure again"
JOB = "maps"
SMALL = "font-size:12px;margin:2px 12px"
"""Style of a line below a scale."""


class MapsPanel:
    """Widgets of the tab; it follows the state like a panel."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui, guarded = desk.server.gui, desk.guarded
        self.found: DesignerMaps | None = None
        self.skin: Skin | None = None
        """The skin that the maps are on."""
        self.asked = False
        """Whether the next maps are shown on the skin as soon as they are there."""
        hint = "From the light and the cameras, without a press; some seconds after the light"
        button = gui.add_button("Measure maps", icon=viser.Icon.MAP_2, hint=hint)
        button.on_click(guarded(lambda event: self._measure()))
        desk.reports.beside(JOB)
        self.about = gui.add_markdown(NO_MAPS)
        self.choice = gui.add_dropdown(
            "Map", (NONE,), visible=False, hint="What is measured; its meaning stands below"
        )
        self.choice.on_update(guarded(lambda event: self._draw()))
        hint = "Click on the skin to read its value; off, a click aims the press again"
        self.wanted = gui.add_checkbox("Show on the skin", False, visible=False, hint=hint)
        self.wanted.on_update(guarded(lambda event: self._draw()))
        self.legend = gui.add_html("")
        self.meaning = gui.add_markdown("")
        self.value = gui.add_markdown("")
        self.scores = gui.add_html("")
        desk.probe = self._probe

    def _measure(self) -> None:
        desk = self.desk
        if "maps" not in desk.session.calls():
            error = DesignError(
                "photons traced anew for every frame leave no light to map",
                hint="choose the light model hybrid or table",
                at="optics.light_model",
            )
            desk.reports.report(error, job=JOB)
            return
        if self.found is not None and desk.current("maps"):
            # They are there already, and nothing would come that shows them.
            desk.put_parts_away()
            self.wanted.value = True
            return
        self.asked = True
        desk.run(JOB, ("maps",))

    def _chosen(self) -> SkinMap | None:
        if self.found is None:
            return None
        return next((m for m in self.found.maps if m.label == self.choice.value), None)

    def _draw(self) -> None:
        """Show the chosen map, in the panel and on the skin if it is wanted there."""
        scene, found = self.desk.scene, self._chosen()
        self.value.content = ""
        if found is None or self.skin is None:
            self._cover(False)
            return
        look = map_look(found)
        with self.desk.server.atomic():
            self.legend.content = map_legend(found, look, self.skin.points_mm)
            self.meaning.content = f"*{plain(found.meaning)}*"
            if self.wanted.value:
                self.desk.tell("mapped", "map")
                scene.show_map(self.skin, look.colours)
        self._cover(bool(self.wanted.value))

    def _cover(self, shown: bool) -> None:
        """A map is of the skin at rest: the frames of a press give way, and come back."""
        if not shown:
            self.desk.scene.clear_map()
        self.desk.cover("map", shown)

    def _hide(self) -> None:
        if self.wanted.value:
            self.wanted.value = False

    def _probe(self, origin: np.ndarray, direction: np.ndarray) -> bool:
        """Tell the value of the map on show where a click's ray meets it."""
        found, scene = self._chosen(), self.desk.scene
        if found is None or self.skin is None or not scene.map.on:
            return False
        hit = value_at(found, self.skin.points_mm, self.skin.faces, origin, direction)
        if hit is None:
            return False
        place, words = hit[0], value_words(found, hit[1])
        x, y, z = place
        scene.map.tell(place, words)
        self.value.content = f"at {x:.1f}, {y:.1f}, {z:.1f} mm: **{words}**"
        return True

    def refresh(self) -> None:
        """Mark maps that are no longer the design's."""
        text = NO_MAPS if self.found is None else ""
        if self.found is not None and not self.desk.current("maps"):
            text = STALE
        elif self.found is not None:
            text = f"{len(self.found.maps)} maps"
        if self.about.content != text:
            self.about.content = text

    def show(self, stage: str, result: Any) -> None:
        """Follow results; a press or an image that is asked for takes the map away."""
        if stage == "maps":
            self._take(result)
        elif stage in ("build", "sensor"):
            self._forget()
        elif stage in ("press", "live", "partial") or (stage == "mapped" and result != "map"):
            self._hide()
        elif stage == "run" and str(result) != JOB:
            self.asked = False
            self._hide()

    def _take(self, maps: DesignerMaps) -> None:
        mesh = self.desk.session.result("mesh")
        if mesh is None:
            return
        self.found, self.skin = maps, mesh.seen
        names = tuple(found.label for found in ordered(maps))
        if tuple(self.choice.options) != names:
            now = self.choice.value
            self.choice.options = names
            self.choice.value = now if now in names else names[0]
        self.choice.visible = self.wanted.visible = True
        self.scores.content = table(("map", "score", "value", "good"), score_rows(maps))
        if self.asked:
            self.asked = False
            self.desk.put_parts_away()
            self.wanted.value = True
        self._draw()
        self.refresh()

    def _forget(self) -> None:
        """The maps were those of another body."""
        if self.found is None:
            return
        self._hide()
        self.found = self.skin = None
        self._cover(False)
        self.choice.visible = self.wanted.visible = False
        self.legend.content = self.meaning.content = self.value.content = ""
        self.scores.content = ""
        self.refresh()


def map_legend(found: SkinMap, look: MapLook, points_mm: np.ndarray) -> str:
    """The colours of a map of vertices (V, 3) and what they mean, as HTML."""
    if is_flag(found):
        yes, no = yes_no(found)
        where = f"<div style='{SMALL}'>{heights_words(found, points_mm)}</div>"
        return swatch(YES, yes) + swatch(NOTHING_GREY, no) + where
    bar = scale_bar(look.low, look.high, found.unit, middle=look.middle)
    words = f"<div style='{SMALL}'>{look.words}</div>"
    return bar + words + swatch(NOTHING_GREY, "no value: blind or unlit")
