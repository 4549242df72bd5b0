"""Meshes of the 3D view by name: made once, then updated in place, removed when they go."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np


class Meshes:
    """All plain meshes below one name of the scene tree."""

    def __init__(
        self, api: Any, prefix: str, on_click: Callable[[Any], None] | None = None
    ) -> None:
        self.api = api
        self.prefix = prefix
        self.on_click = on_click
        self.nodes: dict[str, Any] = {}

    def put(
        self, name: str, points: np.ndarray, faces: np.ndarray, looks: Mapping[str, Any]
    ) -> Any:
        """Show a mesh; `looks` count when the name is new.

        Args:
            name: Its name below the prefix.
            points: Vertices [mm], shape (N, 3).
            faces: Triangles, shape (M, 3).
            looks: Colour, opacity and shading, as viser calls them.
        """
        vertices = np.asarray(points, np.float32)
        triangles = np.asarray(faces, np.uint32)
        if name in self.nodes:
            replace(self.nodes[name], vertices, triangles)
            return self.nodes[name]
        node = self.api.add_mesh_simple(
            f"{self.prefix}/{name}", vertices, triangles, side="double", **looks
        )
        if self.on_click is not None:
            node.on_click(self.on_click)
        self.nodes[name] = node
        return node

    def keep(self, names: Iterable[str]) -> None:
        """Remove every mesh but these."""
        kept = set(names)
        for name in [name for name in self.nodes if name not in kept]:
            self.nodes.pop(name).remove()

    def show(self, visible: bool) -> None:
        """Show or hide all of them."""
        for node in self.nodes.values():
            if node.visible != visible:
                node.visible = visible


def replace(node: Any, vertices: np.ndarray, faces: np.ndarray) -> None:
    """Another mesh in the same node."""
    # Faces must never point past the vertices between the two messages.
    if len(vertices) >= len(node.vertices):
        node.vertices = vertices
        node.faces = faces
    else:
        node.faces = faces
        node.vertices = vertices
