"""The section in the 3D view: what is cut, its filled caps and their outline.

Bodies, parts, maps and pressed frames cut themselves; here stand the plane, which outlives them,
and the caps, one for each material in its own colour. A cap takes about a millisecond, so it
follows the slider like the rest.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ui.scene.map_view import MapView
from ui.scene.nodes import Meshes, drawable
from ui.scene.parts import PartsView
from ui.scene.pressed import PressedView
from ui.scene.sensor import SKIN_COLOUR, SensorView
from workbench.core.result.results import MembraneMesh
from workbench.view.section_cut import Plane, PressedBody, cap, clip

OUTLINE_COLOUR = (250, 250, 250)
MEMBRANE = "membrane"
CAP_COLOURS = {
    MEMBRANE: SKIN_COLOUR,
    # Deeper than the tint of a clear body: beside the skin it is told apart by lightness alone.
    "support": (58, 120, 160),
    "foot": (66, 70, 78),
}
"""Colours of caps: in each the material's, light, middle and dark."""
SHADE = 0.82
"""Caps of parts are a little darker than their outside."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Piece:
    """A closed body that is cut."""

    name: str
    points_mm: np.ndarray
    faces: np.ndarray
    colour: tuple[int, int, int]


class CutScene(Protocol):
    """What of the 3D view is cut, and decides on it."""

    server: Any
    api: Any
    body: SensorView
    map: MapView
    pressed: PressedView
    parts: PartsView
    hidden: bool
    shown_frame: int

    def follow_shadow(self) -> None:
        """Throw the shadow of what is whole."""
        ...


class Section:
    """The cut of one scene."""

    def __init__(self, scene: CutScene) -> None:
        self.scene = scene
        self.plane: Plane | None = None
        self.caps = Meshes(scene.api, "/section")
        self._outline: Any = None
        self._mesh: MembraneMesh | None = None
        self._follows: PressedBody | None = None

    def cut(self, plane: Plane | None) -> None:
        """Cut all that is on show by a plane, or make it whole."""
        if plane == self.plane:
            return
        self.plane = plane
        scene = self.scene
        with scene.server.atomic():
            for view in (scene.body, scene.map, scene.pressed, scene.parts):
                view.cut(plane)
            self.follow()
            scene.follow_shadow()

    def take_mesh(self, mesh: MembraneMesh | None) -> None:
        """The mesh whose skins a press moves; None for a body that has none yet."""
        self._mesh, self._follows = mesh, None

    def follow(self) -> None:
        """Draw the caps of what is on show now."""
        plane, ends, names = self.plane, [], []
        if plane is not None:
            for piece in self._pieces():
                kept = clip(piece.points_mm, piece.faces, plane)
                filled = cap(kept, plane)
                if len(filled.faces):
                    looks = {"color": piece.colour, "flat_shading": True, "cast_shadow": False}
                    self.caps.put(piece.name, *drawable(filled.points_mm, filled.faces), looks)
                    names.append(piece.name)
                ends.append(kept.outline_mm)
        self.caps.keep(names)
        self._draw_outline(np.concatenate(ends) if ends else np.zeros((0, 2, 3)))

    def _draw_outline(self, ends_mm: np.ndarray) -> None:
        if self._outline is not None:
            self._outline.remove()
            self._outline = None
        if len(ends_mm):
            self._outline = self.scene.api.add_line_segments(
                "/section_outline",
                ends_mm.astype(np.float32),
                colors=OUTLINE_COLOUR,
                thickness=1.5,
                thickness_units="screen",
            )

    def _pieces(self) -> Iterator[Piece]:
        """Closed bodies that are on show."""
        scene = self.scene
        solid = scene.body.solid
        if scene.hidden:
            parts = scene.parts
            for name in sorted(parts.shown):
                part = parts.parts[name]
                points = np.asarray(part.points_mm) + parts.moved(name, (0.0, 0.0, 0.0))
                r, g, b = (int(SHADE * c) for c in parts.colour(name))
                yield _piece(f"part_{name}", points, part.faces, (r, g, b))
        elif solid is not None:
            body = scene.body
            if body.skin.allowed:
                points, faces = self._membrane_mm(scene.shown_frame), solid.membrane.faces
                yield _piece(MEMBRANE, points, faces)
            for name, group, surface in (
                ("support", body.support, solid.support),
                ("foot", body.foot, solid.base),
            ):
                if group.allowed:
                    yield _piece(name, surface.points_mm, surface.faces)

    def membrane_cap(self, frame: int) -> tuple[str, np.ndarray, np.ndarray] | None:
        """Name, vertices and triangles of the membrane's cap in a frame; None where none is."""
        node, solid = self.caps.nodes.get(MEMBRANE), self.scene.body.solid
        if self.plane is None or node is None or solid is None:
            return None
        kept = clip(self._membrane_mm(frame), solid.membrane.faces, self.plane)
        filled = cap(kept, self.plane)
        return node.name, *drawable(filled.points_mm, filled.faces)

    def _membrane_mm(self, frame: int) -> np.ndarray:
        """Vertices of the membrane, where a frame has them [mm]; 0 is at rest."""
        solid, contact = self.scene.body.solid, self.scene.pressed.contact
        assert solid is not None
        if contact is None or not frame or self._mesh is None:
            return solid.membrane.points_mm
        if contact.displacement_mm.shape[1] != len(self._mesh.outer.points_mm):
            return solid.membrane.points_mm
        if self._follows is None:
            self._follows = PressedBody(solid.membrane, self._mesh)
        return self._follows.points_mm(contact, frame - 1)


def _piece(
    name: str,
    points_mm: np.ndarray,
    faces: np.ndarray,
    colour: tuple[int, int, int] | None = None,
) -> Piece:
    """A body to cut; without a colour, in that of its material."""
    return Piece(name=name, points_mm=points_mm, faces=faces, colour=colour or CAP_COLOURS[name])
