"""The scene of the last image that a process rendered, kept for the next one of the same light."""

from __future__ import annotations

from typing import TYPE_CHECKING

from workbench.core.base.digest import digest
from workbench.core.design.optics import Optics
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.stage import Ref
from workbench.pipeline.store import Store

if TYPE_CHECKING:
    from sim.optics.studio.render import Studio


class KeptStudio:
    """One scene."""

    def __init__(self) -> None:
        self._key = ""
        self._studio: Studio | None = None

    def open(
        self, store: Store, mesh: MembraneMesh, light: Ref, table: Ref | None, optics: Optics
    ) -> Studio:
        """The scene of a baked mesh, made anew where another was kept.

        Args:
            store: Where light and table are.
            mesh: What `light` was baked on.
            light: The light field, whose key knows the mesh.
            table: Its table of moved skin, of models that have one.
            optics: Camera and lights.
        """
        key = digest((light, table, optics))
        if self._studio is None or self._key != key:
            from sim.optics.studio.render import Studio

            field = store.load(light.stage, light.key)
            moved = table and store.load(table.stage, table.key)
            self._key, self._studio = key, Studio(mesh, field, optics, table=moved)
        return self._studio
