"""Meshes of the 3D view by name: made once, then updated in place, removed when they go.

A cut, a hidden part and an opacity belong to the name, not to the mesh: they stay when a body is
rebuilt.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from ui.scene.pointing import listen
from workbench.view.section_cut import Plane, clip, packed

DIMMED = 0.06
"""Opacity of what belongs to another state."""
GLASS = 0.25
"""Opacity of what is looked through."""


class Meshes:
    """All plain meshes below one name of the scene tree."""

    def __init__(
        self, api: Any, prefix: str, on_click: Callable[[Any], None] | None = None
    ) -> None:
        self.api = api
        self.prefix = prefix
        self.on_click = on_click
        self.nodes: dict[str, Any] = {}
        self.whole: dict[str, tuple[np.ndarray, np.ndarray]] = {}
        """Vertices [mm] and triangles of each mesh before it is cut."""
        self.plane: Callable[[str], Plane | None] = lambda name: None
        """Set by whoever cuts: the plane by which a mesh is cut, in its own frame."""
        self.allowed = True
        """Whether the designer wants to see them at all."""
        self.opacity: float | None = None
        """In place of the opacity of their looks."""
        self.dimmed = False
        """Whether they are of another state: what takes their place is being made."""
        self.glass = False
        """Whether they are looked through, at what is inside."""
        self._own: dict[str, float | None] = {}
        """Opacity of the looks of each mesh; None where it has none."""
        self._shown = True

    def put(
        self, name: str, points: np.ndarray, faces: np.ndarray, looks: Mapping[str, Any]
    ) -> Any:
        """Show a mesh; `looks` count when the name is new.

        Args:
            name: Its name below the prefix.
            points: Vertices [mm], shape (N, 3).
            faces: Triangles, shape (M, 3).
            looks: Colour, opacity, shading and, unless both, the side to draw, as viser calls them.
        """
        self.whole[name] = np.asarray(points), np.asarray(faces)
        self._own[name] = looks.get("opacity")
        vertices, triangles = self._cut(name)
        if name in self.nodes:
            replace(self.nodes[name], vertices, triangles)
            return self.nodes[name]
        drawn = {"side": "double", **looks}
        if (opacity := self._opacity(name)) is not None:
            drawn["opacity"] = opacity
        node = self.api.add_mesh_simple(f"{self.prefix}/{name}", vertices, triangles, **drawn)
        node.visible = self._shown and self.allowed
        if self.on_click is not None:
            listen(node, self.on_click)
        self.nodes[name] = node
        return node

    def _cut(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        points, faces = self.whole[name]
        plane = self.plane(name)
        if plane is not None:
            kept = clip(points, faces, plane)
            points, faces, _ = packed(kept.points_mm, kept.faces)
        return drawable(points, faces)

    def recut(self) -> None:
        """Cut every mesh anew: the plane has moved."""
        for name, node in self.nodes.items():
            replace(node, *self._cut(name))

    def keep(self, names: Iterable[str]) -> None:
        """Remove every mesh but these."""
        kept = set(names)
        for name in [name for name in self.nodes if name not in kept]:
            self.nodes.pop(name).remove()
            del self.whole[name]

    def show(self, visible: bool) -> None:
        """Show or hide all of them."""
        self._shown = visible
        for node in self.nodes.values():
            if node.visible != (visible and self.allowed):
                node.visible = visible and self.allowed

    def allow(self, wanted: bool) -> None:
        """Let them be seen, or hide them whatever else is shown."""
        self.allowed = wanted
        self.show(self._shown)

    def take_clicks(self, on_click: Callable[[Any], None] | None) -> None:
        """Tell of clicks on any of them, or no longer."""
        if on_click is self.on_click:
            return
        self.on_click = on_click
        for node in self.nodes.values():
            if on_click is None:
                node.remove_click_callback()
            else:
                listen(node, on_click)

    def set_opacity(self, opacity: float) -> None:
        """Draw all of them with this opacity in [0, 1]."""
        self.opacity = opacity
        self._fade()

    def dim(self, dimmed: bool) -> None:
        """Draw them as a shadow of what was, or as they are."""
        if dimmed == self.dimmed:
            return
        self.dimmed = dimmed
        self._fade()

    def look_through(self, glass: bool) -> None:
        """Draw them as glass, or as they are."""
        if glass != self.glass:
            self.glass = glass
            self._fade()

    def _opacity(self, name: str) -> float | None:
        if self.dimmed:
            return DIMMED
        if self.glass:
            return GLASS
        return self._own[name] if self.opacity is None else self.opacity

    def _fade(self) -> None:
        for name, node in self.nodes.items():
            node.opacity = self._opacity(name)


def drawable(points: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A mesh as viser takes it; of one with nothing left, a triangle without an area."""
    if not len(faces):
        return np.zeros((3, 3), np.float32), np.array([[0, 1, 2]], np.uint32)
    return np.asarray(points, np.float32), np.asarray(faces, np.uint32)


def replace(node: Any, vertices: np.ndarray, faces: np.ndarray) -> None:
    """Another mesh in the same node."""
    # Faces must never point past the vertices between the two messages.
    if len(vertices) >= len(node.vertices):
        node.vertices = vertices
        node.faces = faces
    else:
        node.faces = faces
        node.vertices = vertices
