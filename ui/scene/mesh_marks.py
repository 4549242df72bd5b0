"""What is marked of meshes in the 3D view: their edges on the body at rest, and one cell."""

from __future__ import annotations

from typing import Any

import numpy as np

from ui.scene.views import Views
from workbench.view.scene_shapes import cell_edges

CELL_COLOUR = (255, 45, 85)
EDGE_COLOUR = (20, 60, 120)


class MeshMarks:
    """Lines of one scene."""

    def __init__(self, api: Any, views: Views) -> None:
        self.api = api
        self.views = views
        self._resting = True
        self._edges: Any = None
        self._cell: Any = None

    def show_edges(self, ends_mm: np.ndarray | None) -> None:
        """Draw the edges of a mesh, shape (E, 2, 3), on the body at rest; None takes them away."""
        if self._edges is not None:
            self._edges.remove()
            self._edges = None
        if ends_mm is not None:
            self._edges = self.api.add_line_segments(
                "/edges",
                np.asarray(ends_mm, dtype=np.float32),
                colors=EDGE_COLOUR,
                thickness=1.0,
                thickness_units="screen",
            )
            self.follow(self._resting)

    def follow(self, resting: bool) -> None:
        """The mesh is that of the body at rest: its edges show while that does."""
        self._resting = resting
        if self._edges is not None and self._edges.visible != resting:
            self._edges.visible = resting

    def show_cell(self, corners_mm: np.ndarray) -> None:
        """Draw the edges of one cell of a mesh: triangle, tetrahedron or hexahedron."""
        self.clear_cell()
        self._cell = self.api.add_line_segments(
            "/cell",
            cell_edges(corners_mm).astype(np.float32),
            colors=CELL_COLOUR,
            line_width=3.0,
        )

    @property
    def marked(self) -> bool:
        """Whether a cell is drawn."""
        return self._cell is not None

    def clear_cell(self) -> None:
        """Take the cell and its mark away."""
        self.views.unmark()
        if self._cell is not None:
            self._cell.remove()
            self._cell = None
