"""What the page asks for: the pack of a design as one file."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workbench.core.base.monitor import Monitor
from workbench.core.design.design import SensorDesign
from workbench.pipeline.store import Store
from workbench.project.design_bundle import zipped
from workbench.project.project import Project
from workbench.sensor.exporting import export_pack
from workbench.sensor.making import WHOLE
from workbench.system.whole_files import write_atomically

FOLDER = "packs"
"""In a project: the files, by the name of their design."""


@dataclass(frozen=True, kw_only=True, slots=True)
class WritePack:
    """The pack of a design in a zip archive of its project; a `PreviewCall`."""

    design: SensorDesign
    project: Path
    """Folder of it."""
    width_px: int

    @property
    def lane(self) -> str:
        """The worker that answers it."""
        return "sim"

    @property
    def stage(self) -> str:
        """What messages call it."""
        return "writing the pack"

    @property
    def needs(self) -> tuple[str, ...]:
        """Stages that must be stored before."""
        return WHOLE

    def answer(self, store: Store, kept: dict[str, Any], monitor: Monitor) -> Path:
        """Write it; returns its path.

        Raises:
            WorkbenchError: If the design cannot be condensed, or a file cannot be written.
        """
        with tempfile.TemporaryDirectory() as text:
            paths = export_pack(
                self.design,
                Path(text),
                Project(self.project),
                width_px=self.width_px,
                monitor=lambda stage, fraction, note: monitor(fraction, note),
            )
            files = {path.name: path.read_bytes() for path in paths}
        found = self.project / FOLDER / f"{self.design.name}.zip"
        found.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(found, zipped({f"{self.design.name}/{n}": b for n, b in files.items()}))
        return found
