"""Meshes for ParaView."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from workbench.core.design.design import SensorDesign
from workbench.report.export import Export


def files(design: SensorDesign, found: dict[str, Any]) -> Iterator[tuple[str, bytes]]:
    """The volume, where there are cells, and the membrane with its labels."""
    from workbench.report.vtkfiles import vtk_files

    yield from vtk_files(found["build"], found["mesh"], tets=found.get("tets")).items()


EXPORT = Export(place=6, makes=("mesh.vtu", "membrane.vtp"), stages=("build", "mesh"), files=files)
