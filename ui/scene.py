"""Results to nodes of the 3D view. One node per kind; nodes are updated, not made anew."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ui.imaging import coloured_glb, heat_colours
from workbench.core.design import Camera, LedRing, LensModel
from workbench.core.fabrication import MouldSet
from workbench.core.press import Indenter, Press
from workbench.core.results import Contact, Skin, Solid
from workbench.previews import corner_normals, indenter_shape, outer_faces, standing_pose

SKIN_COLOUR = (196, 206, 220)
FOOT_COLOUR = (92, 98, 108)
PART_COLOURS = ((122, 162, 214), (146, 186, 160), (214, 182, 112), (180, 150, 200), (150, 150, 150))
FRUSTUM_MM = 5.0


class Scene:
    """The 3D view of one design."""

    def __init__(self, server: Any, *, fast: bool, on_aim: Callable[[Any], None]) -> None:
        self.server = server
        self.on_aim = on_aim
        self.api = server.scene
        self._leds: list[Any] = []
        self._frames: list[Any] = []
        self._parts: dict[str, Any] = {}
        self._explode: dict[str, np.ndarray] = {}
        self._contact: Contact | None = None
        self._hidden = False
        self._views: dict[int, tuple[Any, Any]] = {}
        self._shown = 0
        self._points = np.zeros((0, 3))
        self._normals = np.zeros((0, 3))
        self._lowest_mm = 0.0
        self.membrane: Any = None
        self.foot: Any = None
        self.camera: Any = None
        self.indenter: Any = None
        self._prepare(fast)

    def _prepare(self, fast: bool) -> None:
        camera = self.server.initial_camera
        camera.position = (84.0, 62.0, 62.0)
        camera.look_at = (0.0, 0.0, 18.0)
        camera.fov = 0.6
        if fast:
            # Without the environment map only direct light is left: fill the shadows.
            self.api.configure_environment_map(None)
            self.api.configure_default_lights(True, cast_shadow=False)
            self.api.add_light_hemisphere(
                "/fill", sky_color=(255, 255, 255), ground_color=(120, 120, 130), intensity=2.0
            )
        self.api.add_grid(
            "/grid",
            width=160,
            height=160,
            cell_size=5,
            section_size=20,
            position=(0, 0, -8.1),
        )

    def show_solid(self, solid: Solid) -> None:
        """Show a body; the press of another body disappears."""
        points, faces = outer_faces(solid.membrane)
        self._points, self._normals = points, corner_normals(points, faces)
        vertices = points.astype(np.float32)
        with self.server.atomic():
            self.clear_frames()
            self.clear_mould()
            if self.membrane is None:
                self.membrane = self.api.add_mesh_simple(
                    "/sensor/membrane",
                    vertices,
                    faces.astype(np.uint32),
                    color=SKIN_COLOUR,
                    opacity=0.55,
                    side="double",
                )
                self.membrane.on_click(self.on_aim)
            else:
                self._replace(self.membrane, vertices, faces.astype(np.uint32))
            self.membrane.visible = True
            base = solid.base
            foot = np.asarray(base.points_mm, np.float32), np.asarray(base.faces, np.uint32)
            if self.foot is None:
                self.foot = self.api.add_mesh_simple(
                    "/sensor/foot", *foot, color=FOOT_COLOUR, flat_shading=True, side="double"
                )
            else:
                self._replace(self.foot, *foot)
            self.foot.visible = True

    @staticmethod
    def _replace(node: Any, vertices: np.ndarray, faces: np.ndarray) -> None:
        # Faces must never point past the vertices between the two messages.
        if len(vertices) >= len(node.vertices):
            node.vertices = vertices
            node.faces = faces
        else:
            node.faces = faces
            node.vertices = vertices

    def show_lights(self, ring: LedRing) -> None:
        """Show the LEDs of a ring in their colours."""
        azimuth = np.radians(ring.phase_deg + 360.0 * np.arange(ring.count) / ring.count)
        with self.server.atomic():
            while len(self._leds) > ring.count:
                self._leds.pop().remove()
            for i, angle in enumerate(azimuth):
                place = (
                    ring.radius_mm * math.cos(angle),
                    ring.radius_mm * math.sin(angle),
                    ring.height_mm,
                )
                text = ring.colours[i * len(ring.colours) // ring.count]
                colour = tuple(int(text[k : k + 2], 16) for k in (1, 3, 5))
                if i == len(self._leds):
                    led = self.api.add_icosphere(f"/leds/{i}", radius=0.7, subdivisions=2)
                    self._leds.append(led)
                self._leds[i].position = place
                self._leds[i].color = colour

    def show_camera(self, camera: Camera, image: np.ndarray | None = None) -> None:
        """Show the camera as a frustum; a fisheye is drawn at most 150 degrees wide."""
        across = math.radians(min(camera.fov_x_deg, 150.0))
        high = 2 * math.atan(math.tan(across / 2) * camera.height_px / camera.width_px)
        aspect = camera.width_px / camera.height_px
        if self.camera is None:
            self.camera = self.api.add_camera_frustum(
                "/camera", fov=high, aspect=aspect, scale=FRUSTUM_MM, color=(255, 200, 0)
            )
        with self.server.atomic():
            self.camera.fov = high
            self.camera.aspect = aspect
            self.camera.position = camera.position_mm
            self.camera.wxyz = camera.wxyz
            self.camera.color = (255, 200, 0) if camera.lens is LensModel.PINHOLE else (255, 150, 0)
            if image is not None:
                self.camera.image = image

    def show_indenter(self, indenter: Indenter, path: Press) -> None:
        """Show the indenter standing on the skin at the target."""
        points, faces = indenter_shape(indenter)
        self._lowest_mm = -float(points[:, 2].min())
        vertices, triangles = points.astype(np.float32), faces.astype(np.uint32)
        if self.indenter is None:
            self.indenter = self.api.add_mesh_simple(
                "/indenter", vertices, triangles, color=(232, 124, 44), flat_shading=False
            )
        else:
            with self.server.atomic():
                self._replace(self.indenter, vertices, triangles)
        self.place_indenter(path)

    def place_indenter(self, path: Press) -> None:
        """Stand the indenter on the skin near the target of a press."""
        if self.indenter is not None and len(self._points):
            self._pose(standing_pose(self._points, self._normals, path.target_mm, self._lowest_mm))

    def _pose(self, pose: np.ndarray) -> None:
        with self.server.atomic():
            self.indenter.position = tuple(pose[:3])
            self.indenter.wxyz = tuple(pose[3:])

    def aim(self, origin: np.ndarray, direction: np.ndarray) -> tuple[float, float, float] | None:
        """The skin vertex that a click ray meets first, or None."""
        if not len(self._points):
            return None
        facing = self._normals @ direction < 0
        offset = self._points - origin
        along = offset @ direction
        aside = np.linalg.norm(offset - along[:, None] * direction, axis=1)
        aside[~facing | (along < 0)] = np.inf
        best = int(np.argmin(aside))
        x, y, z = self._points[best]
        return (float(x), float(y), float(z)) if np.isfinite(aside[best]) else None

    def nearest(self, target_mm: tuple[float, float, float]) -> tuple[np.ndarray, float]:
        """The skin vertex nearest to a point and its distance [mm]."""
        distance = np.linalg.norm(self._points - np.asarray(target_mm), axis=1)
        best = int(np.argmin(distance))
        return self._points[best], float(distance[best])

    def load_frames(self, skin: Skin, contact: Contact) -> float:
        """Prepare the coloured skin of every frame; returns the largest displacement [mm]."""
        self.clear_frames()
        size = np.linalg.norm(contact.displacement_mm, axis=2)
        top = max(float(size.max()), 1e-9)
        faces = np.asarray(skin.faces)
        for k, moved in enumerate(contact.displacement_mm):
            points = (np.asarray(skin.points_mm) + moved).astype(np.float32)
            glb = coloured_glb(points, faces, heat_colours(size[k] / top, SKIN_COLOUR))
            node = self.api.add_glb(f"/frames/{k}", glb, visible=False)
            node.on_click(self.on_aim)
            self._frames.append(node)
        self._contact = contact
        return top

    def clear_frames(self) -> None:
        """Forget the frames of a press."""
        for node in self._frames:
            node.remove()
        self._frames.clear()
        self._contact = None
        self._shown = 0
        if self.membrane is not None and not self._hidden:
            self.membrane.visible = True

    def show_frame(self, number: int) -> None:
        """Show frame `number` of the press, 0 for the untouched skin."""
        if self._contact is None or self.membrane is None:
            return
        number = min(number, len(self._frames))
        self._shown = number
        if self._hidden:
            return
        with self.server.atomic():
            for k, node in enumerate(self._frames, start=1):
                if (k == number) != node.visible:
                    node.visible = k == number
            self.membrane.visible = number == 0
            if self.indenter is not None:
                self._pose(self._contact.indenter_pose[max(number, 1) - 1])

    def show_mould(self, moulds: MouldSet, spread: float) -> None:
        """Show the parts of a mould, moved apart by `spread` in [0, 1]."""
        self.clear_mould()
        with self.server.atomic():
            for i, part in enumerate(moulds.parts):
                self._parts[part.name] = self.api.add_mesh_simple(
                    f"/mould/{part.name}",
                    np.asarray(part.points_mm, np.float32),
                    np.asarray(part.faces, np.uint32),
                    color=PART_COLOURS[i % len(PART_COLOURS)],
                    flat_shading=True,
                    side="double",
                )
                self._explode[part.name] = np.asarray(part.explode)
        self.spread_mould(spread)

    def spread_mould(self, spread: float) -> None:
        """Move the parts of the mould apart."""
        with self.server.atomic():
            for name, node in self._parts.items():
                node.position = tuple(spread * self._explode[name])

    def clear_mould(self) -> None:
        """Take the mould away."""
        for node in self._parts.values():
            node.remove()
        self._parts.clear()
        self._explode.clear()

    def step_back(self, moulds: MouldSet) -> None:
        """Move every tab's camera back until the exploded mould fits; remembers where it was."""
        points = np.concatenate(
            [np.asarray(part.points_mm) + np.asarray(part.explode) for part in moulds.parts]
        )
        low, high = points.min(axis=0), points.max(axis=0)
        centre, size = (low + high) / 2, float(np.linalg.norm(high - low))
        for number, client in self.server.get_clients().items():
            camera = client.camera
            self._views.setdefault(number, (camera.position, camera.look_at))
            camera.position = centre + size * np.array([0.8, -1.2, 0.6])
            camera.look_at = centre

    def step_forward(self) -> None:
        """Give every tab's camera its place before `step_back` again."""
        for number, client in self.server.get_clients().items():
            if number in self._views:
                client.camera.position, client.camera.look_at = self._views.pop(number)

    def show_sensor(self, visible: bool) -> None:
        """Show or hide everything but the mould."""
        self._hidden = not visible
        nodes = [self.membrane, self.foot, self.camera, self.indenter, *self._leds]
        with self.server.atomic():
            for node in nodes:
                if node is not None:
                    node.visible = visible
            for node in self._frames:
                node.visible = False
        if visible:
            self.show_frame(self._shown)
