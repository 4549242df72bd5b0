"""The membrane in tetrahedra, as arrays."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from workbench.core.design.design import SensorDesign
from workbench.report.export import Export
from workbench.report.mesh_arrays import volume_bytes


def files(design: SensorDesign, found: dict[str, Any]) -> Iterator[tuple[str, bytes]]:
    """Nodes, cells and labels."""
    yield "tets.npz", volume_bytes(found["tets"])


EXPORT = Export(
    place=4,
    makes=("tets.npz",),
    stages=("tets",),
    files=files,
    option="tets",
    help="also tetrahedra: about a minute",
)
