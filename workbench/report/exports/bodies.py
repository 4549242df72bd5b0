"""The bodies of the sensor as triangles."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from workbench.core.design.design import SensorDesign
from workbench.report.export import Export


def files(design: SensorDesign, found: dict[str, Any]) -> Iterator[tuple[str, bytes]]:
    """STL files in mm."""
    from geometry.workshop.export import stl_bytes

    solid = found["build"]
    for name in ("membrane", "base"):
        surface = getattr(solid, name)
        yield f"{name}.stl", stl_bytes(surface.points_mm, surface.faces)
    # One name, one body: where the skin cuts into the support, the part to print is what there is.
    yield "support.stl", found["package"].files["parts/support.stl"].tobytes()


EXPORT = Export(
    place=2,
    makes=("membrane.stl", "base.stl", "support.stl"),
    stages=("build", "package"),
    files=files,
)
