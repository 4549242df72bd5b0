"""What tasks found, as a project keeps it: `tasks/<digest of the design>/<task>-<size>-<network>`.

`workbench task` leaves a copy of its `result.json` here, so that designs can be compared by what
they tell apart. It is found by all that makes the design except its name; the name tells that an
earlier state of a design was judged.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from workbench.core.base.digest import digest
from workbench.core.design.design import SensorDesign
from workbench.project.design_toml import design_table
from workbench.project.project import Project
from workbench.system.whole_files import write_atomically

FOLDER, ENDING = "tasks", ".json"

Kept = Mapping[str, Mapping[str, Any]]
"""Results by `<task>-<size>-<network>`, as `result.json` has them."""


def design_key(design: SensorDesign) -> str:
    """Digest of a design without its name."""
    return digest({name: value for name, value in design_table(design).items() if name != "name"})


def keep(project: Project, design: SensorDesign, result: Mapping[str, Any]) -> Path:
    """Keep a copy of a result in the place of an earlier one; returns its file.

    Args:
        project: In whose folder.
        design: Whose sensor was judged.
        result: What `result.json` holds.

    Raises:
        StoreError: If the folder cannot be written.
    """
    name = "-".join(str(result[part]) for part in ("task", "size", "network"))
    path = project.folder / FOLDER / design_key(design) / f"{name}{ENDING}"
    write_atomically(path, json.dumps(result, indent=1, allow_nan=False).encode())
    return path


def kept(project: Project, design: SensorDesign) -> Kept:
    """What tasks found of a design; files that cannot be read count as none."""
    return _read(project.folder / FOLDER / design_key(design))


def earlier(project: Project, design: SensorDesign) -> tuple[str, ...]:
    """Tasks that were run on a design of this name which was another then, sorted."""
    own = design_key(design)
    return tuple(
        sorted(
            {
                str(result["task"])
                for folder in (project.folder / FOLDER).glob("*")
                if folder.name != own
                for result in _read(folder).values()
                if result["design"] == design.name
            }
        )
    )


def _read(folder: Path) -> Kept:
    found = {}
    for path in sorted(folder.glob(f"*{ENDING}")):
        try:
            result = json.loads(path.read_bytes())
        except (OSError, ValueError):
            continue
        if isinstance(result, dict) and {"task", "design", "rows", "details"} <= set(result):
            found[path.stem] = result
    return found
