"""The body of a sensor in the 3D view: skin by region, pins, clear support, foot.

The skin is translucent, so that support, pins, LEDs and camera show through. Driven regions have
the tint of their actuator; faces that the designer took out of the sensing side are grey.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ui.scene.nodes import Meshes
from workbench.core.result.results import Label, Solid
from workbench.project.aim import SkinPlace, sensing_skin, skin_place
from workbench.view.region_words import region_words
from workbench.view.scene_shapes import contact_side, first_hit, outer_faces, skin_parts
from workbench.view.section_cut import Plane, clip

SKIN_COLOUR = (196, 206, 220)
ACTUATOR_COLOURS = ((225, 105, 165), (90, 175, 240), (170, 120, 230), (120, 200, 110))
ACTUATOR_NAMES = ("pink", "blue", "purple", "green")
"""What those colours are called."""
SKIN = {"color": SKIN_COLOUR, "opacity": 0.55}
UNSENSED = {"color": (90, 90, 96), "opacity": 0.8}
PINS = {"color": (60, 64, 72), "flat_shading": False}
SUPPORT = {"color": (150, 205, 235), "opacity": 0.12, "cast_shadow": False, "side": "front"}
FOOT = {"color": (92, 98, 108), "flat_shading": True, "side": "front"}
"""Closed bodies, filled where they are cut: the back is never seen, and takes time to draw."""
TIP_COLOUR = (245, 245, 245)


class SensorView:
    """Nodes of one body."""

    def __init__(self, api: Any, on_click: Callable[[Any], None]) -> None:
        self.api = api
        self.skin = Meshes(api, "/sensor/skin", on_click)
        self.inside = Meshes(api, "/sensor/inside")
        self.support = Meshes(api, "/sensor/rigid")
        self.foot = Meshes(api, "/sensor/foot")
        self.tips: Any = None
        self._skin_shown = True
        self.plane: Plane | None = None
        """What the body is cut by."""
        self.points = np.zeros((0, 3))
        """Vertices of the sensing side [mm], shape (N, 3)."""
        self.solid: Solid | None = None
        self._sensing = np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int32)
        """Its sensing skin, as `sensing_skin`."""

    def show_solid(self, solid: Solid) -> None:
        """Show a body in place of the one before."""
        self.dim(False)
        self.solid = solid
        self._sensing = sensing_skin(solid)
        self.points, _ = outer_faces(solid.membrane)
        parts = skin_parts(solid.membrane)
        pins = parts.pop("pins", None)
        for name, (points, triangles) in parts.items():
            self.skin.put(name, points, triangles, _looks(name))
        self.skin.keep(parts)
        if pins is not None:
            self.inside.put("pins", *pins, PINS)
        self.inside.keep(() if pins is None else ("pins",))
        # Where the support stands on the foot, only one of both is drawn: they would flicker.
        clear = solid.support.faces[~solid.support.has(Label.BASE)]
        self.support.put("support", solid.support.points_mm, clear, SUPPORT)
        self.foot.put("foot", solid.base.points_mm, solid.base.faces, FOOT)
        self._show_tips(solid)
        self.show(True)

    def _show_tips(self, solid: Solid) -> None:
        if self.tips is not None:
            self.tips.remove()
            self.tips = None
        tips = np.asarray(solid.tips_mm)
        if self.plane is not None and len(tips):
            # A ball is small: it is on show where its middle is kept.
            tips = tips[self.plane.depth_mm(tips) > 0.0]
        count = len(tips)
        if count:
            points, faces = ball(solid.tip_radius_mm)
            self.tips = self.api.add_batched_meshes_simple(
                "/sensor/tips",
                points,
                faces,
                batched_wxyzs=np.tile(np.array([1.0, 0.0, 0.0, 0.0]), (count, 1)),
                batched_positions=tips,
                batched_colors=TIP_COLOUR,
            )

    def tints(self) -> str:
        """Which driven region has which colour; empty without driven regions."""
        numbers = sorted(
            int(name.partition("_")[2]) for name in self.skin.nodes if name.startswith("actuator_")
        )
        return ", ".join(
            f"{region_words(f'actuator_{n}')}: {ACTUATOR_NAMES[n % len(ACTUATOR_NAMES)]}"
            for n in numbers
        )

    def dim(self, dimmed: bool) -> None:
        """Draw it as a shadow of what was, while another sensor's body is built, or as it is."""
        for meshes in self.groups:
            meshes.dim(dimmed)

    def show(self, visible: bool) -> None:
        """Show or hide all of it."""
        self.show_skin(visible)
        self.support.show(visible)
        self.foot.show(visible)

    @property
    def groups(self) -> tuple[Meshes, ...]:
        """All meshes of the body."""
        return self.skin, self.inside, self.support, self.foot

    def cut(self, plane: Plane | None) -> None:
        """Cut the body by a plane, or make it whole."""
        self.plane = plane
        for meshes in self.groups:
            meshes.plane = lambda name: plane
            meshes.recut()
        if self.solid is not None and len(self.solid.tips_mm):
            self._show_tips(self.solid)
            self.follow_tips()

    def show_skin(self, visible: bool) -> None:
        """Show or hide what the coloured skin of a press takes the place of."""
        self._skin_shown = visible
        self.skin.show(visible)
        self.inside.show(visible)
        self.follow_tips()

    def hit(self, origin: np.ndarray, direction: np.ndarray) -> tuple[int, np.ndarray] | None:
        """Membrane triangle and point [mm] that a click ray meets first on the skin, or None."""
        if self.solid is None:
            return None
        membrane = self.solid.membrane
        # Faces taken out of the sensing side stay clickable, to be taken in again.
        clickable = np.flatnonzero(
            membrane.has(Label.OUTER)
            | ((self.solid.patches >= 0) if len(self.solid.patches) else False)
        )
        points, faces = membrane.points_mm, membrane.faces[clickable]
        if self.plane is not None:
            kept = clip(points, faces, self.plane)
            points, faces, clickable = kept.points_mm, kept.faces, clickable[kept.source]
        found = first_hit(points, faces, origin, direction)
        return None if found is None else (int(clickable[found[0]]), found[1])

    def follow_tips(self) -> None:
        """Show the tips of pins where the pins are shown."""
        if self.tips is not None:
            self.tips.visible = self._skin_shown and self.inside.allowed

    def place_near(self, target_mm: tuple[float, float, float]) -> SkinPlace | None:
        """The place of the sensing side nearest to a point; None without a body."""
        return None if self.solid is None else skin_place(self._sensing, target_mm)

    def side_of(self, target_mm: tuple[float, float, float], usual: np.ndarray) -> np.ndarray:
        """Unit direction to an eye that sees a press at the target; `usual` without a body."""
        place = self.place_near(target_mm)
        if self.solid is None or place is None:
            return usual
        return contact_side(*outer_faces(self.solid.membrane), place, usual)

    @property
    def bounds_mm(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of skin and foot [mm]; of the origin without a body."""
        if self.solid is None:
            return np.zeros(3), np.zeros(3)
        points = np.concatenate([self.points, np.asarray(self.solid.base.points_mm)])
        return points.min(axis=0), points.max(axis=0)


def _looks(name: str) -> dict[str, Any]:
    kind, _, number = name.partition("_")
    if kind == "actuator":
        return {**SKIN, "color": ACTUATOR_COLOURS[int(number) % len(ACTUATOR_COLOURS)]}
    return UNSENSED if kind == "unsensed" else SKIN


def ball(radius_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """A small sphere: vertices (N, 3) and triangles (M, 3)."""
    import trimesh

    mesh = trimesh.creation.icosphere(subdivisions=2, radius=radius_mm)
    return np.asarray(mesh.vertices, np.float32), np.asarray(mesh.faces, np.uint32)
