"""The hexahedra of the membrane as arrays."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from workbench.core.design.design import SensorDesign
from workbench.report.export import Export
from workbench.report.mesh_arrays import volume_bytes


def files(design: SensorDesign, found: dict[str, Any]) -> Iterator[tuple[str, bytes]]:
    """Nodes, cells and labels, of a membrane that has hexahedra."""
    hexes = found["mesh"].hexes
    if hexes is not None:
        yield "mesh.npz", volume_bytes(hexes)


EXPORT = Export(place=3, makes=("mesh.npz",), stages=("mesh",), files=files)
