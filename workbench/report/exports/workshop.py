"""Everything to print, pour and solder: moulds, parts, build sheet, recipe, parts list."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from workbench.core.design.design import SensorDesign
from workbench.report.export import Export


def files(design: SensorDesign, found: dict[str, Any]) -> Iterator[tuple[str, bytes]]:
    """The files of the stage."""
    for name, content in found["package"].files.items():
        yield name, content.tobytes()


EXPORT = Export(
    place=7,
    makes=(
        *(f"{folder}/*.{end}" for folder in ("moulds", "parts") for end in ("stl", "step", "3mf")),
        *("all_parts.3mf", "build_sheet.html", "recipe.json", "bom.csv"),
    ),
    stages=("mould", "housing", "recipe", "package"),
    files=files,
)
