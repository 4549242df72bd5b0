"""Cameras: place, direction, lens, focus and image sensor; one of them is edited at a time."""

from __future__ import annotations

from typing import Any

from ui.desk.desk import Desk
from ui.page.callbacks import put
from ui.panels.optics.bought import Bought
from ui.panels.optics.handles import Handle
from workbench.core.catalogue.camera_part import camera_parts
from workbench.core.design.camera import COEFFICIENTS, Camera, LensModel
from workbench.edit.camera_edit import LENSES, angles_of, further_camera, with_lens, wxyz_of
from workbench.edit.catalogue import camera_name, with_camera
from workbench.edit.item_fields import without_item
from workbench.edit.light_edit import number_words, read_numbers

FIRST, FURTHER = "design.optics.camera", "design.optics.cameras"
ADD, REMOVE = "Add", "Remove"


class CameraFolders:
    """Widgets of the folders of cameras."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.number = 1
        """Of the camera that is edited, from 1: the first is the design's own."""
        self.path = FIRST
        gui = desk.server.gui
        with gui.add_folder("Camera"):
            self.choice = gui.add_dropdown(
                "Edited", ("camera 1",), visible=False, hint="The camera whose numbers stand below"
            )
            self.choice.on_update(desk.guarded(self._choose))
            self.bought = Bought(
                desk,
                "Module",
                {name: part.title for name, part in camera_parts().items()},
                name=lambda: camera_name(self.camera),
                take=lambda design, name: with_camera(design, name, number=self.number),
            )
            self.handle = Handle(desk, "Camera handle", path=lambda: self.path, turns=True)
            self._place()
            self._lens()
            hint = "Further cameras of the same sensor; Remove takes the edited one"
            self.list = gui.add_button_group("Cameras", (ADD, REMOVE), hint=hint)
            self.list.on_click(desk.guarded(self._change_list))
            desk.fields.anchor("Cameras", FURTHER)
            desk.fields.anchor("Camera", FIRST)
        with gui.add_folder("Focus and sensor", expand_by_default=False):
            self._sensor()

    @property
    def camera(self) -> Camera:
        """The camera that is edited."""
        return self.desk.read(self.path)

    def _place(self) -> None:
        fields, gui = self.desk.fields, self.desk.server.gui
        hint = "Optical centre, sensor frame: z counts from the base"
        fields.point("Camera mm", f"{FIRST}.position_mm", step=0.5, hint=hint)
        tilt, pan, roll = angles_of(self.camera.wxyz)
        hint = "Of the optical axis from straight up"
        self.tilt = gui.add_slider("Tilt deg", 0.0, 180.0, 1.0, tilt, hint=hint)
        hint = "Azimuth toward which a tilted camera looks, from X to Y"
        self.pan = gui.add_slider("Pan deg", -180.0, 180.0, 1.0, pan, hint=hint)
        hint = "About the optical axis"
        self.roll = gui.add_slider("Roll deg", -180.0, 180.0, 1.0, roll, hint=hint)
        for handle in (self.tilt, self.pan, self.roll):
            handle.on_update(self.desk.guarded(self._turn))
        fields.anchor("Direction", f"{FIRST}.wxyz")

    def _lens(self) -> None:
        fields, gui = self.desk.fields, self.desk.server.gui
        hint = "View in degree; 120 and 160 are fisheyes"
        self.preset = gui.add_button_group("Lens preset", tuple(LENSES), hint=hint)
        self.preset.on_click(self.desk.guarded(self._take_lens))
        hint = "Across the image; above 175 only fisheyes"
        fields.slider("View deg", f"{FIRST}.fov_x_deg", span=(5.0, 180.0, 1.0), hint=hint)
        fields.choice(
            "Lens",
            f"{FIRST}.lens",
            list(LensModel),
            hint="Ordinary for narrow views, fisheye for wide ones; calibrated ones by OpenCV",
        )
        fields.text(
            "Distortion",
            f"{FIRST}.distortion",
            read=lambda text: read_numbers(text, at=f"{self.path.split('.', 1)[1]}.distortion"),
            write=number_words,
            hint="Of calibrated lenses: k1, k2, p1, p2, k3; of fisheyes k1 to k4; empty is none",
        )
        fields.number(
            "Width px",
            f"{FIRST}.width_px",
            step=16,
            whole=True,
            hint="Pixels of an image row, 16 to 4096",
        )
        fields.number(
            "Height px",
            f"{FIRST}.height_px",
            step=16,
            whole=True,
            hint="Rows of an image, 16 to 4096",
        )

    def _sensor(self) -> None:
        fields, sensor = self.desk.fields, f"{FIRST}.sensor"
        hint = "Distance that is sharp"
        fields.slider("Focus mm", f"{FIRST}.focus_mm", span=(1.0, 100.0, 0.5), hint=hint)
        hint = "Diameter of the pupil; 0 has no blur, a 1.5 mm lens at f/2.2 has 0.7 mm"
        fields.slider("Aperture mm", f"{FIRST}.aperture_mm", span=(0.0, 3.0, 0.05), hint=hint)
        hint = "Display light per radiance; 0 chooses it"
        fields.number("Exposure", f"{sensor}.exposure", step=0.1, hint=hint)
        hint = "Of signal and noise"
        fields.slider("Gain dB", f"{sensor}.gain_dB", span=(0.0, 48.0, 1.0), hint=hint)
        hint = "Red, green and blue: the white balance; a photographed background sets its own"
        fields.point("Gain rgb", f"{sensor}.gain_rgb", step=0.05, hint=hint)
        hint = "2.2, 1 for linear images, or 0 for the curve of sRGB"
        fields.number("Gamma", f"{sensor}.gamma", step=0.1, hint=hint)
        hint = "Share of the lens's natural fall-off to the corners"
        fields.slider("Vignetting", f"{sensor}.vignetting", span=(0.0, 1.0, 0.05), hint=hint)
        hint = "Measured: light times 1 + k1 r^2 + k2 r^4 + k3 r^6, r = 1 at the corner"
        fields.point("Fall-off k", f"{sensor}.falloff", step=0.05, hint=hint)
        fields.check("Noise", f"{sensor}.noise", hint="Shot and read noise of the image sensor")
        hint = "Electrons of a white pixel at no gain"
        fields.number("Full well e", f"{sensor}.full_well_e", step=1000.0, hint=hint)
        fields.number("Read noise e", f"{sensor}.read_noise_e", step=0.5, hint="Electrons")
        fields.number(
            "Noise seed", f"{sensor}.seed", step=1, whole=True, hint="Equal seeds give equal noise"
        )

    def _turn(self, event: Any) -> None:
        if event.client is not None:
            tilt, pan, roll = (float(s.value) for s in (self.tilt, self.pan, self.roll))
            self.desk.edit(f"{self.path}.wxyz", wxyz_of((tilt, pan, roll)))

    def _take_lens(self, event: Any) -> None:
        self.desk.edit(self.path, with_lens(self.camera, event.target.value))
        self.desk.fields.refresh()

    def _change_list(self, event: Any) -> None:
        cameras = self.desk.session.design.optics.cameras
        if event.target.value == ADD:
            cameras = (*cameras, further_camera(self.camera))
            self.number = len(cameras) + 1
        elif self.number > 1:
            cameras = without_item(cameras, self.number - 1)
        self.desk.edit(FURTHER, cameras)
        self.refresh()

    def _choose(self, event: Any) -> None:
        if event.client is not None:
            self.number = self.choice.options.index(self.choice.value) + 1
            self.refresh()

    def refresh(self) -> None:
        """List the cameras as they stand, and edit the chosen one."""
        count = len(self.desk.session.design.optics.all_cameras)
        self.number = min(self.number, count)
        names = tuple(f"camera {k}" for k in range(1, count + 1))
        if tuple(self.choice.options) != names:
            self.choice.options = names
        put(self.choice, names[self.number - 1])
        if self.choice.visible != (count > 1):
            self.choice.visible = count > 1
        path = FIRST if self.number == 1 else f"{FURTHER}[{self.number - 1}]"
        self.desk.fields.rebind(self.path, path)
        self.path = path
        self.handle.follow()
        self.bought.refresh()
        self._show_turn()
        sensor = f"{path}.sensor"
        for name in ("full_well_e", "read_noise_e", "seed"):
            self.desk.fields.reveal(f"{sensor}.{name}", self.camera.sensor.noise)
        distorts = self.camera.lens in COEFFICIENTS or bool(self.camera.distortion)
        self.desk.fields.reveal(f"{path}.distortion", distorts)

    def _show_turn(self) -> None:
        """Show the angles, unless the widgets say the same in other words."""
        now = tuple(float(s.value) for s in (self.tilt, self.pan, self.roll))
        wxyz = self.camera.wxyz
        tilt, pan, roll = now
        if wxyz_of((tilt, pan, roll)) == wxyz:
            return
        for handle, value in zip((self.tilt, self.pan, self.roll), angles_of(wxyz), strict=True):
            put(handle, value)
