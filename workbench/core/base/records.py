"""Nouns that are one file each: the files of a package, and what each says of itself.

A family, a stage, a light model, an indenter is a module with a record of an agreed name. Nothing
else needs to be told: who asks for them walks the package. A folder of one's own with the same tree
(`<folder>/designs/mine.py`) joins in through the environment variable `WORKBENCH_EXTENSIONS`.
"""

from __future__ import annotations

import functools
import importlib
import os
import pkgutil
from pathlib import Path
from typing import Any

VARIABLE = "WORKBENCH_EXTENSIONS"
"""Folders whose files join the packages of the same names, as in `PATH`."""


def names(package: str) -> list[str]:
    """Names of the files of a package, sorted; none of them is imported.

    Args:
        package: Dotted name, for example `designs`.
    """
    return sorted(info.name for info in pkgutil.iter_modules(_path(package)) if not info.ispkg)


def folders(package: str) -> list[Path]:
    """Folders of a package, sorted by name; none of them is imported."""
    places = (Path(place) for place in _path(package))
    found = [folder for place in places if place.is_dir() for folder in place.iterdir()]
    return sorted((folder for folder in found if folder.is_dir()), key=lambda found: found.name)


def _path(package: str) -> list[str]:
    """Where the files of a package lie, folders of one's own last."""
    path = importlib.import_module(package).__path__
    for folder in filter(None, os.environ.get(VARIABLE, "").split(os.pathsep)):
        more = str(Path(folder, *package.split(".")))
        if more not in path:
            path.append(more)
    return list(path)


@functools.cache
def records(package: str, record: str) -> dict[str, Any]:
    """The records of the files of a package that have one, by the name of the file.

    Args:
        package: Dotted name, for example `designs`.
        record: What the record is called in every file, for example `FAMILY`.
    """
    modules = {name: importlib.import_module(f"{package}.{name}") for name in names(package)}
    found = {name: getattr(module, record, None) for name, module in modules.items()}
    return {name: value for name, value in found.items() if value is not None}
