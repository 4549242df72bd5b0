"""The design as a text file, with the files of a body of its own under `bodies/`."""

from __future__ import annotations

from typing import Any

from workbench.core.design.design import SensorDesign
from workbench.project.design_toml import design_files, design_to_toml
from workbench.report.export import Export, Files


def files(design: SensorDesign, found: dict[str, Any]) -> Files:
    """`design.toml` and what it names."""
    return {"design.toml": design_to_toml(design).encode(), **design_files(design)}.items()


EXPORT = Export(
    place=1,
    makes=("design.toml", "bodies/*"),
    kept=("design.toml", "bodies/*"),
    stages=(),
    files=files,
)
