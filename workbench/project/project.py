"""A project folder: where a designer's work lives.

```
.workbench/
  store/     results by stage and key; elsewhere if `$WORKBENCH_STORE` names a folder for them
  designs/   autosave.toml
  variants/  kept designs with their press, figures and thumbnails; `trash/` has deleted ones
  tasks/     what tasks told apart, by design
  sweeps/    one-parameter sweeps with their figures
  searches/  searches by goals, each with its journal, front and report
  bodies/    files of imported bodies by hash
  pictures/  backgrounds and patterns of markers by hash
  indenters/ meshes of STL indenters by key
  calibration/ photographs of the built sensor, and the last calibration
  crash/     one file per bug that reached the edge
```
"""

from __future__ import annotations

import contextlib
import os
import time
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError, StoreError, shown
from workbench.core.design.design import SensorDesign
from workbench.pipeline.store import Store
from workbench.project.design_toml import design_files, design_to_toml
from workbench.system.names import LONGEST, is_name
from workbench.system.unfinished import UNFINISHED, is_left_behind
from workbench.system.whole_files import free_path, write_atomically

VARIABLE = "WORKBENCH_PROJECT"
DEFAULT_FOLDER = ".workbench"
STORE_VARIABLE = "WORKBENCH_STORE"
"""Folder of the results of all projects: what one has computed, the others find."""
PARTS = tuple(f"{folder}{UNFINISHED}" for folder in ("", "*/", "*/trash/", "designs/previous/*/"))
"""Where files may lie that were being written when their writer was killed."""


class Project:
    """Where a designer's work lives."""

    def __init__(self, folder: Path | str | None = None) -> None:
        self.folder = Path(folder or os.environ.get(VARIABLE) or DEFAULT_FOLDER).resolve()
        self.store = Store(os.environ.get(STORE_VARIABLE) or self.folder / "store")

    def design_path(self, name: str) -> Path:
        """File of a saved design.

        Raises:
            DesignError: If the name cannot be one of a file, or could leave the folder.
        """
        if not is_name(name):
            raise DesignError(
                f"{shown(name)} cannot be a design name",
                hint=f"use letters, digits, spaces and dashes, at most {LONGEST}",
                at="name",
            )
        return self.folder / "designs" / f"{name}.toml"

    def save_design(self, name: str, design: SensorDesign, **extra: Any) -> Path:
        """Write a design by atomic replacement; `extra` tables are kept beside it."""
        path = self.design_path(name)
        self.keep_files(design)
        write_atomically(path, (design_to_toml(design, **extra)).encode())
        return path

    def keep_files(self, design: SensorDesign) -> None:
        """Keep the files that a design is made of; each is written once.

        Raises:
            StoreError: If the project folder cannot be written.
        """
        for name, content in design_files(design).items():
            if not (self.folder / name).exists():
                write_atomically(self.folder / name, content)

    def keep_aside(self, name: str) -> Path:
        """Copy a design file that cannot be read to a free name beside it; returns that file.

        Raises:
            StoreError: If the folder cannot be written.
        """
        path = self.design_path(name)
        kept = free_path(path.with_name(f"{path.stem}-broken{path.suffix}"))
        try:
            content = path.read_bytes()
        except OSError as error:
            raise StoreError(
                f"cannot read {path}: {error.strerror or error}",
                hint="check the file and its permissions",
                at=str(path),
            ) from error
        write_atomically(kept, content)
        return kept

    def sweep(self) -> None:
        """Remove what killed writers left behind, and results beyond the store's limit."""
        self.store.sweep()
        for pattern in PARTS:
            for part in self.folder.glob(pattern):
                if part.is_file() and is_left_behind(part):
                    with contextlib.suppress(OSError):
                        part.unlink()

    def write_crash(self, text: str) -> Path:
        """Keep a traceback for a bug report; returns the file."""
        name = f"{time.strftime('%Y%m%d-%H%M%S')}-{os.getpid()}.txt"
        # Two bugs in one second, or in an hour that a clock set back lives twice.
        path = free_path(self.folder / "crash" / name)
        write_atomically(path, text.encode())
        return path
