"""A design by what somebody typed: a preset, a family with its defaults, or a file."""

from __future__ import annotations

import os
from importlib import resources
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.core.design.design import SensorDesign
from workbench.project.bodies import ENDINGS, design_of_file
from workbench.project.design_toml import design_from_toml
from workbench.project.project import Project
from workbench.system.whole_files import MAX_TOML_BYTES


def presets() -> dict[str, str]:
    """Name and one-line purpose of each shipped design."""
    found = {}
    for file in sorted(_preset_folder().iterdir(), key=lambda f: f.name):
        if file.name.endswith(".toml"):
            text = file.read_text(encoding="utf-8")
            found[file.name[:-5]] = text.splitlines()[0].lstrip("# ")
    return found


def _preset_folder() -> Any:
    return resources.files("designs") / "presets"


def load_design(
    name: str | Path, *, unit: str = "auto", project: Project | None = None
) -> SensorDesign:
    """A preset by name, else a family with its defaults, else a TOML, STL or STEP file.

    Args:
        name: Name or path.
        unit: Unit of an STL file.
        project: Where the files of a design's body may be kept, besides the design's own folder.

    Raises:
        DesignError: If there is no such preset, family or file, or the file is not valid.
    """
    from designs.family import families

    name = str(name)
    if name in presets():
        text = (_preset_folder() / f"{name}.toml").read_text(encoding="utf-8")
        return design_from_toml(text, source=name)
    if name in families():
        return SensorDesign(name=name, family=name)
    if name.lower().endswith(ENDINGS):
        return design_of_file(Path(name), unit)
    if name.endswith(".toml") or os.sep in name:
        path = Path(name)
        kept = () if project is None else (project.folder,)
        beside = path.absolute().parent
        roots = (beside, beside.parent, *kept)
        return design_from_toml(_read(path), source=name, roots=roots)
    raise DesignError(
        f"there is no preset, family, TOML, STL or STEP file named {shown(name)}",
        hint=suggest(name, {*presets(), *families()}),
        at="design",
    )


def _read(path: Path) -> str:
    try:
        size = path.stat().st_size
        if size > MAX_TOML_BYTES:
            raise DesignError(
                f"{path} has {size} bytes, a design has at most {MAX_TOML_BYTES}",
                hint="is this really a design file?",
                at="design",
            )
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise DesignError(
            f"cannot read {path}: {getattr(error, 'strerror', None) or error}",
            hint="give the path of a readable UTF-8 TOML file",
            at="design",
        ) from error
