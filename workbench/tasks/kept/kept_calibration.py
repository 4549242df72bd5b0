"""A calibration in a folder: to fit camera and light takes minutes, and who was stopped goes on.

```
calibrated/
  design.toml   the design in the light that was fitted, as every other command takes it
  pictures/     the file of the built sensor that it names
  told.json     how well it explains the photographs, and of what it is; written last
```
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError
from workbench.core.design.design import SensorDesign
from workbench.project.design_toml import design_files, design_table, design_to_toml
from workbench.project.named_designs import load_design
from workbench.system.whole_files import write_atomically
from workbench.tasks.kept.kept_key import kept_key

SOURCES = ("workbench.calibration.calibrate", "workbench.calibration.fitted_design")
"""Code that it rests on, with what it imports."""
DESIGN, TOLD = "design.toml", "told.json"
Fitted = tuple[SensorDesign, dict[str, Any]]


def kept_calibration(folder: Path, rests_on: list[object], fit: Callable[[], Fitted]) -> Fitted:
    """A calibration from its folder; fitted and kept where it is of something else, or not there.

    Args:
        folder: Where it is kept.
        rests_on: What it is of, besides the code: design, photographs, what is fitted.
        fit: Fits it: the calibrated design, and figures to tell.

    Raises:
        StoreError: If the folder cannot be written.
        WorkbenchError: As `fit`; nothing is kept then.
    """
    key = kept_key(rests_on, SOURCES)
    found = _read(folder, key)
    if found is None:
        found = fit()
        _write(folder, key, found)
    return found


def _read(folder: Path, key: str) -> Fitted | None:
    """None where there is none, or of something else, or a file is damaged."""
    try:
        told = json.loads((folder / TOLD).read_bytes())
        if told["key"] != key:
            return None
        design = load_design(folder / DESIGN)
        return (design, dict(told["told"])) if told["design"] == _seal(design) else None
    except (OSError, ValueError, KeyError, TypeError, DesignError):
        return None


def _seal(design: SensorDesign) -> str:
    """Half a file may be a design too, and another file may lie where the sensor's own was."""
    return digest(design_table(design))


def _write(folder: Path, key: str, found: Fitted) -> None:
    design, told = found
    for name, content in design_files(design).items():
        write_atomically(folder / name, content)
    write_atomically(folder / DESIGN, design_to_toml(design).encode())
    table = {"key": key, "design": _seal(design), "told": told}
    write_atomically(folder / TOLD, json.dumps(table).encode())
