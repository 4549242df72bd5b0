"""The folder that a command writes into."""

from __future__ import annotations

import contextlib
from collections.abc import Container, Iterable
from pathlib import Path

from workbench.core.base.errors import DesignError, StoreError
from workbench.core.result.force_field import Source
from workbench.system.whole_files import write_atomically

NUMBER = "[0-9][0-9][0-9]"
IMAGE_FILES = (
    *("background.png", "markers.csv", "frames.npz"),
    *(f"{name}_{NUMBER}.png" for name in ("frame", "difference", "motion")),
)
"""All that a run writes of one camera; nothing else may be removed, it is the designer's own."""
CAMERA_FILES = tuple(f"camera_[2-8]/{pattern}" for pattern in IMAGE_FILES)
SOURCE_FILES = (
    *("sources.csv", "sources.npz"),
    *(f"sources_{source}{end}" for source in Source for end in ("_*.vtp", ".pvd")),
)
"""What a run with `--sources` writes."""
RUN_FILES = (
    *("summary.json", "report.html", "maps.npz"),
    *IMAGE_FILES,
    *CAMERA_FILES,
    *("contact.npz", "poses.csv", "forces.csv", "slip.csv"),
    *SOURCE_FILES,
    *("mesh.vtu", "membrane.vtp", "contact_*.vtp", "contact.pvd"),
    *(
        f"{folder}/*.{ending}"
        for folder in ("moulds", "parts")
        for ending in ("stl", "step", "3mf")
    ),
    *("all_parts.3mf", "build_sheet.html", "recipe.json", "bom.csv"),
)
"""All that a run writes, as patterns of `Path.glob`."""


def prepare(out: Path, *, clear: Iterable[str] = ("summary.json",)) -> None:
    """Make the folder and check that it can be written, before anything is computed.

    Files of an earlier run go: a run that fails must not leave another one's.

    Args:
        clear: What goes, as patterns of `Path.glob`.

    Raises:
        DesignError: If a file has that name.
        StoreError: If the folder cannot be made or written.
    """
    if out.exists() and not out.is_dir():
        raise DesignError(
            f"{out} is a file, the results need a folder", hint="name another folder", at="--out"
        )
    probe = out / ".probe"
    write_atomically(probe, b"")
    for stale in (probe, *(path for pattern in clear for path in out.glob(pattern))):
        try:
            stale.unlink(missing_ok=True)
        except OSError as error:
            raise StoreError(
                f"cannot remove {stale}: {error.strerror or error}",
                hint="remove it yourself, or name another folder",
                at="--out",
            ) from error


def remove_stale(folder: Path, patterns: Iterable[str], *, keep: Container[str]) -> None:
    """Remove files of an earlier run that this one does not replace.

    Args:
        patterns: As of `Path.glob`, relative to the folder.
        keep: Paths relative to the folder that stay.
    """
    for pattern in patterns:
        for path in folder.glob(pattern):
            if path.relative_to(folder).as_posix() not in keep:
                with contextlib.suppress(OSError):
                    path.unlink()
