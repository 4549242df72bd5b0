"""The tab of the tactile image: which camera, what is shown of it, its change, and measures.

Blinking between the frame and the rest shows small changes better than two images do.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ui.desk.desk import Desk
from ui.page.blink import Blink
from ui.page.imaging import placeholder, scale_bar, table
from ui.page.offer import offer
from ui.panels.results.camera_row import CameraRow
from ui.panels.results.image_size import ImageSize
from ui.panels.results.probe import Probe
from ui.panels.results.seen_change import SeenChange
from ui.patches.image_zoom import image_zoom
from ui.patches.leading import empty_state
from workbench.core.result.sensing import Shot, TactileFrames
from workbench.view.close_up import enlarged
from workbench.view.image_views import (
    Looked,
    View,
    crossed,
    looked,
    views,
    visible_change,
    wiped,
)
from workbench.view.map_display import scores
from workbench.view.metric_rules import rule

WIPE = "Rest on the left %"
GAINS = {"as fits": None, **{f"× {gain}": gain for gain in (1, 2, 4, 8, 16, 32)}}
"""What differences are multiplied by."""
BLINK_S = 0.5
"""How long each of the two blinking images is shown [s]."""
NO_IMAGE = "No press of this sensor yet."
BEGIN = empty_state("A press shows what the camera sees of it.", "Run press (R)", key="r")
IMAGE_COMES = (
    "The tactile image appears here.",
    "Run press (R) computes it;",
    "a preview comes first.",
)
CHANGE_COMES = ("Its change against the untouched skin", "appears here.")
"""What empty places say."""


class ImageTab:
    """Widgets of the tab."""

    def __init__(self, desk: Desk, dock: Any) -> None:
        self.desk = desk
        gui = desk.server.gui
        self.cameras: tuple[tuple[np.ndarray, TactileFrames | None], ...] = ()
        """Of each camera the background and frames, (1 + K, H, W, 3) uint8, and their fields."""
        self._seen = SeenChange()
        self.number = 0
        """Frame on show."""
        self.caption = gui.add_markdown(NO_IMAGE)
        self.begin = gui.add_html(BEGIN)
        self.camera = CameraRow(desk)
        self.camera.chosen.connect(lambda: self.show(self.number))
        hint = "What the first image is; below it stands its change"
        self.view = gui.add_dropdown("Show", (View.IMAGE.value,), visible=False, hint=hint)
        self.size = ImageSize(desk, dock)
        gui.add_html(image_zoom(wipe=WIPE))
        clicks = gui.add_html("")
        self.image = gui.add_image(placeholder(*IMAGE_COMES), format="jpeg")
        self.rest = gui.add_image(placeholder(), format="jpeg", visible=False)
        self.turns = Blink(desk.server, self.image, self.rest, period_s=BLINK_S)
        self.legend = gui.add_html("")
        self._beside_rest()
        self.close_text = gui.add_markdown("", visible=False)
        self.close = gui.add_image(placeholder(), format="jpeg", visible=False)
        self.change_text = gui.add_markdown("")
        self.change = gui.add_image(placeholder(*CHANGE_COMES), format="jpeg")
        self.measures = gui.add_folder("Measures", expand_by_default=False, visible=False)
        with self.measures:
            self.numbers = gui.add_html("")
        self.probe = Probe(desk, clicks)
        self.probe.on_moved = lambda: self.show(self.number)

    def _beside_rest(self) -> None:
        """Widgets that compare with the untouched skin."""
        gui, guarded = self.desk.server.gui, self.desk.guarded
        hint = "Left of a white line the untouched skin stands, right of it the frame"
        self.wipe = gui.add_slider(WIPE, 0, 100, 1, 0, visible=False, hint=hint)
        hint = "Show the untouched skin every other half second"
        self.blink = gui.add_checkbox("Blink with rest", False, visible=False, hint=hint)
        hint = "What the difference is multiplied by; as fits: 8 at most, little of it saturates"
        self.gain = gui.add_dropdown("Strengthen change", tuple(GAINS), visible=False, hint=hint)
        for handle in (self.view, self.wipe, self.gain):
            handle.on_update(guarded(lambda event: self.show(self.number)))
        self.blink.on_update(guarded(lambda event: self._blinks()))

    @property
    def last(self) -> int | None:
        """Number of the last frame; None without images."""
        return len(self.cameras[0][0]) - 1 if self.cameras else None

    def load(self, shot: Shot) -> None:
        """Take the images of a press."""
        all_frames = (shot.frames, *shot.others)
        self.cameras = tuple((np.asarray(frames.rgb), frames) for frames in all_frames)
        self._offer()

    def load_live(self, images: np.ndarray) -> None:
        """Take the images of a live press, which has nothing else."""
        self.cameras = ((images, None),)
        self._offer()

    def forget(self) -> None:
        """There are no images; what was last on show stays."""
        self.cameras = ()
        self.begin.visible = True
        self.say(NO_IMAGE)

    def clear(self) -> None:
        """Show no image."""
        self.forget()
        self.change_text.content = self.legend.content = ""
        self.close.visible = self.close_text.visible = False
        self.image.image = placeholder(*IMAGE_COMES)
        self.change.image = placeholder(*CHANGE_COMES)
        self.camera.hide()
        for handle in (self.view, self.measures, *self._comparing):
            handle.visible = False
        self.blink.value = False

    def say(self, text: str) -> None:
        """Write above the image."""
        if self.caption.content != text:
            self.caption.content = text

    def _offer(self) -> None:
        """Offer the cameras and views that there are."""
        self._seen.take(self.cameras)
        self.camera.offer(len(self.cameras))
        offer(self.view, tuple(view.value for view in views(self.cameras[0][1])))
        self.view.visible = True
        self.begin.visible = False
        for handle in self._comparing:
            handle.visible = True

    @property
    def _comparing(self) -> tuple[Any, ...]:
        return self.wipe, self.blink, self.gain

    def chosen(self) -> tuple[np.ndarray, TactileFrames | None]:
        """Images and fields of the chosen camera."""
        return self.cameras[self.camera.number]

    def show(self, number: int) -> None:
        """Show a frame, the last one where there are not so many."""
        if not self.cameras:
            return
        images, frames = self.chosen()
        self.number = number = min(number, len(images) - 1)
        self.probe.follow(self.camera.number, number)
        what = View(self.view.value)
        found = self._looked(what, number)
        image = found.rgb
        if self.wipe.value:
            rest = self._looked(what, 0, beside=number)
            image = wiped(image, rest.rgb, self.wipe.value / 100)
        seen = self._seen.of(self.camera.number, number)
        change, gain = visible_change(
            np.asarray(images[number]), np.asarray(images[0]), self._gain(number)
        )
        unseen = f" · **{seen.unseen}**" if seen.unseen else ""
        bar = found.bar
        window = seen.window
        near = None if frames is None or window is None else enlarged(frames, number, window)
        words = f"<div style='font-size:12px;margin:2px 12px'>{found.words}</div>"
        scale = "" if bar is None else scale_bar(bar.low, bar.high, bar.unit)
        with self.desk.server.atomic():
            self.image.image = self._crossed(image)
            if self.blink.value:
                rest = self._looked(what, 0, beside=number)
                self.rest.image = self._crossed(rest.rgb)
            self.legend.content = scale + words if found.words else ""
            self.close.visible = self.close_text.visible = near is not None
            if near is not None:
                self.close_text.content = f"The contact, × {near.times:.0f}: at rest, and as it is"
                self.close.image = near.rgb
            # Once is enough.
            self.change.visible = self.change_text.visible = what is not View.DIFFERENCE
            self.change_text.content = f"Difference to the background, × {gain}{unseen}"
            self.change.image = change

    def _looked(self, what: View, number: int, *, beside: int = 0) -> Looked:
        images, frames = self.chosen()
        gain = self._gain(number)
        return looked(what, images, number, frames, beside=beside, gain=gain)

    def _gain(self, number: int) -> int:
        """What the difference of a frame is multiplied by."""
        return GAINS[self.gain.value] or self._seen.of(self.camera.number, number).gain

    def _crossed(self, image: np.ndarray) -> np.ndarray:
        """The image with a cross at the chosen pixel, of the camera's or of fewer pixels."""
        uv_px, cameras = self.probe.uv_px, self.desk.session.design.optics.all_cameras
        if uv_px is None or self.probe.camera >= len(cameras):
            return image
        return crossed(image, uv_px * (image.shape[1] / cameras[self.probe.camera].width_px))

    def _blinks(self) -> None:
        if self.blink.value:
            self.show(self.number)
            self.turns.start()
        else:
            self.turns.stop()

    def show_in_frusta(self, number: int) -> None:
        """Show in the 3D view what each camera sees."""
        for camera, (images, _) in enumerate(self.cameras):
            self.desk.scene.rig.show_image(camera, np.asarray(images[number]))

    def measure(self) -> None:
        """List the measures that are stored of the state: of the image, and the maps' scores."""
        session = self.desk.session
        shot, maps = session.result("shoot"), session.result("maps")
        values = {} if shot is None else dict(shot.metrics.values)
        if maps is not None:
            values |= scores(maps)
        rows = [(rule(name).label, f"{v:.4g} {rule(name).unit}") for name, v in values.items()]
        self.numbers.content = table(("measure", "value"), rows)
        self.measures.visible = bool(rows)
