"""The weights that a press names: found, checked and offered.

A state holds paths. A design file holds them relative to the project's folder where they lie
inside it, so that a project can be moved; the usual place is its folder `weights/`. Data cards are
read once for each file as it stands: planning asks for them at every edit.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath
from typing import Any

from sim.forces.network.spec import Target
from sim.forces.network.weights import SUFFIX, NetworkWeights, load_weights
from workbench.core.base.errors import StoreError, shown
from workbench.core.press.learned import NONE, SHIPPED, LearnedSettings, WeightsFile
from workbench.pipeline.shipped import is_shipped, shipped_weights

FOLDER = "weights"
"""Of a project."""
AT = "learned.weights"
TARGETS = {"weights": Target.FORCE, "displacement": Target.DISPLACEMENT}
"""What the networks predict by the field of `LearnedSettings` that names them."""


@dataclass(frozen=True, kw_only=True, slots=True)
class About:
    """What is known of weights without their numbers."""

    target: Target
    hex_mm: float
    """Spacing of the mesh that they were trained on [mm]."""
    card: Mapping[str, Any]


def weights_files(settings: LearnedSettings) -> tuple[WeightsFile | None, WeightsFile | None]:
    """The files of the force and of the displacement network; None where there is none.

    The shipped displacement network goes with the shipped force network: own weights of forces are
    of another membrane, which it does not know.
    """
    force = _file(settings.weights, Target.FORCE)
    own = settings.weights != SHIPPED and settings.displacement == SHIPPED
    return force, None if own else _file(settings.displacement, Target.DISPLACEMENT)


def _file(setting: str, target: Target) -> WeightsFile | None:
    if setting == NONE or (setting == SHIPPED and not is_shipped(target)):
        return None
    path = shipped_weights(target) if setting == SHIPPED else Path(setting)
    return WeightsFile(name=path.name, path=str(path))


def read_weights(file: WeightsFile) -> NetworkWeights:
    """The weights of a file.

    Raises:
        StoreError: If it is missing, damaged, renamed, or holds no weights.
    """
    return load_weights(Path(file.path))


def about(file: WeightsFile) -> About:
    """What the file says of itself.

    Raises:
        StoreError: As `read_weights`.
    """
    try:
        found = os.stat(file.path)
    except (OSError, ValueError) as error:
        # The second: a path of a design file that no system takes.
        raise StoreError(
            f"cannot read the weights {shown(file.name)}: "
            f"{getattr(error, 'strerror', None) or error}",
            hint=f"choose other weights, or put the file into the project's folder {FOLDER}",
            at=AT,
        ) from error
    return _about(file.path, (found.st_mtime_ns, found.st_size))


@functools.lru_cache(maxsize=32)
def _about(path: str, stamp: tuple[int, int]) -> About:
    weights = load_weights(Path(path))
    hex_mm = weights.card.get("hex_mm")
    known = isinstance(hex_mm, (int, float))
    return About(
        target=weights.target,
        hex_mm=float(hex_mm) if known else weights.spacing_mm,
        card=weights.card,
    )


def offered(folder: Path, settings: LearnedSettings, field: str) -> dict[str, str]:
    """What can be chosen in a field, by name for people.

    Args:
        folder: Of the project.
        settings: As they stand; what they name is among the choices, there or not.
        field: A key of `TARGETS`.
    """
    target, now = TARGETS[field], getattr(settings, field)
    found: dict[str, str] = {}
    if is_shipped(target):
        path = shipped_weights(target)
        alone = target is Target.DISPLACEMENT and settings.weights != SHIPPED
        size = path.name.partition("-")[0]
        found[f"shipped, {size}"] = str(path) if alone else SHIPPED
    if target is Target.DISPLACEMENT:
        # Where none ships, or none goes with the force network, asking for it comes to the same.
        plain = now == SHIPPED and SHIPPED not in found.values()
        found["contact solver's own"] = SHIPPED if plain else NONE
    for path in sorted((folder / FOLDER).glob(f"*-{target.value}-*{SUFFIX}")):
        found[path.name] = str(path)
    if now not in found.values():
        missing = "" if Path(now).is_file() else " (missing)"
        found[f"{Path(now).name}{missing}" if now else "none shipped"] = now
    return found


def to_project(settings: LearnedSettings, folder: Path) -> dict[str, str]:
    """The settings as a table of a design file: paths inside the project relative to it."""

    def relative(setting: str) -> str:
        path = Path(setting)
        return path.relative_to(folder).as_posix() if path.is_relative_to(folder) else setting

    return {name: relative(getattr(settings, name)) for name in TARGETS}


def from_project(
    settings: LearnedSettings, folder: Path, *, enclosed: bool = False
) -> LearnedSettings:
    """The settings of a design file with paths that hold anywhere.

    Args:
        settings: As the file has them.
        folder: Of the project.
        enclosed: Whether somebody else may have written them: then they name only files in the
            project's `FOLDER`, there or not.
    """

    def whole(setting: str) -> str:
        if setting in (SHIPPED, NONE):
            return setting
        if enclosed:
            # Of both kinds of paths, the name alone.
            return str(folder / FOLDER / PureWindowsPath(setting).name)
        return os.path.normpath(folder / setting)

    return LearnedSettings(**{name: whole(getattr(settings, name)) for name in TARGETS})


def chosen(path: Path, target: Target = Target.FORCE) -> str:
    """The setting for a file that somebody names, once it is seen to hold such weights.

    Raises:
        StoreError: If it is missing, damaged, renamed, or of another target.
    """
    whole = path.resolve()
    found = about(WeightsFile(name=whole.name, path=str(whole)))
    if found.target is not target:
        raise StoreError(
            f"{whole.name} predicts {found.target}, not {target}",
            hint=f"choose weights whose name has -{target.value}- in it",
            at=AT,
        )
    return str(whole)
