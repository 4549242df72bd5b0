"""Printable parts in the 3D view: one mesh each, shown or hidden, moved apart."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ui.scene.nodes import Meshes
from workbench.core.result.fabrication import FabricationPart, PartGroup, PartMotion
from workbench.view.section_cut import Plane

MOULD_COLOURS = ((122, 162, 214), (146, 186, 160), (214, 182, 112), (180, 150, 200))
SENSOR_COLOURS = ((150, 150, 156), (205, 140, 120), (120, 190, 200), (200, 190, 150))


class PartsView:
    """Nodes of all parts of a design."""

    def __init__(self, server: Any) -> None:
        self.server = server
        self.meshes = Meshes(server.scene, "/parts")
        self.plane: Plane | None = None
        """What the parts are cut by, where they stand."""
        self.meshes.plane = self._plane
        self.on_moved: Callable[[], None] = lambda: None
        """Set by the scene: other parts are on show, or they stand elsewhere."""
        self.parts: dict[str, FabricationPart] = {}
        self.motions: tuple[PartMotion, ...] = ()
        self.shown: set[str] = set()
        self.spread = 1.0

    def load(
        self, parts: tuple[FabricationPart, ...], motions: tuple[PartMotion, ...] = ()
    ) -> None:
        """Take the parts of another design; none of them is on show yet.

        Args:
            motions: How the mould is opened: its parts move one after another, as the recipe says.
        """
        self.clear()
        self.parts = {part.name: part for part in parts}
        self.motions = motions

    def show(self, names: set[str], spread: float) -> None:
        """Show these parts, moved apart by `spread` in [0, 1]."""
        self.shown, self.spread = names & set(self.parts), spread
        with self.server.atomic():
            # Meshes travel when they are first asked for: a housing nobody looks at costs nothing.
            for name in self.shown - set(self.meshes.nodes):
                part = self.parts[name]
                looks = {"color": self.colour(name), "flat_shading": True}
                self.meshes.put(name, part.points_mm, part.faces, looks)
            for name, node in self.meshes.nodes.items():
                node.position = self.moved(name, (0.0, 0.0, 0.0))
                node.visible = name in self.shown
            if self.plane is not None:
                # Parts move through the plane as they move apart.
                self.meshes.recut()
        self.on_moved()

    def _plane(self, name: str) -> Plane | None:
        """The plane as a part sees it from where it stands."""
        return self.plane and self.plane.moved(np.asarray(self.moved(name, (0.0, 0.0, 0.0))))

    def cut(self, plane: Plane | None) -> None:
        """Cut the parts by a plane, or make them whole."""
        self.plane = plane
        self.meshes.recut()

    def clear(self) -> None:
        """Take every part away."""
        self.meshes.keep(())
        self.parts.clear()
        self.shown = set()

    def moved(self, name: str, place_mm: tuple[float, float, float]) -> tuple[float, float, float]:
        """Where a place of a part stands at the present spread [mm]."""
        part = self.parts.get(name)
        if part is None:
            return place_mm
        x, y, z = np.asarray(place_mm) + self._share(name) * np.asarray(part.explode)
        return float(x), float(y), float(z)

    def _share(self, name: str) -> float:
        """How much of its way a part has gone: those of the mould go in turn, others together."""
        for turn, motion in enumerate(self.motions):
            if motion.part == name:
                return min(max(self.spread * len(self.motions) - turn, 0.0), 1.0)
        return self.spread

    def bounds_mm(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of the parts on show [mm]."""
        corners = [
            np.asarray(self.moved(name, tuple(side)))
            for name in self.shown
            for points in (np.asarray(self.parts[name].points_mm),)
            for side in (points.min(axis=0), points.max(axis=0))
        ]
        return np.min(corners, axis=0), np.max(corners, axis=0)

    def colour(self, name: str) -> tuple[int, int, int]:
        """In what colour a part is drawn."""
        group = self.parts[name].group
        colours = MOULD_COLOURS if group is PartGroup.MOULD else SENSOR_COLOURS
        names = [n for n, part in self.parts.items() if part.group is group]
        return colours[names.index(name) % len(colours)]
