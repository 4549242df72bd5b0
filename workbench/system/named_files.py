"""Files that a design names by their paths: found beside it, or nowhere else if it came from far.

A designer's own design may name any file of the machine. One that came through a browser may have
been written by anybody: it names only files inside the folders it came with, and what it is told
does not tell which other files there are.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path, PurePosixPath, PureWindowsPath

BRING_IT = "load a zip that holds the file beside the design, as Download design writes it"
"""What to do about a missing file of a design from a browser."""


def find_file(paths: Sequence[tuple[Path, str]], *, enclosed: bool) -> Path | None:
    """The first of some paths at which there is a file.

    Args:
        paths: Folders, and the path below each as the design has it.
        enclosed: Whether the file must lie inside its folder, links followed.

    Raises:
        OSError: If the system refuses the path.
        ValueError: If the path holds a zero.
    """
    if enclosed:
        found = (_inside(root, name) for root, name in paths)
    else:
        found = (root / name for root, name in paths)
    return next((path for path in found if path is not None and path.is_file()), None)


def _inside(root: Path, name: str) -> Path | None:
    """The path below the folder; None if it leads out, whether or not it leads back in."""
    for kind in (PurePosixPath, PureWindowsPath):
        plain = kind(name)
        if plain.drive or plain.root or ".." in plain.parts:
            return None
    base = root.resolve()
    path = (base / name).resolve()
    return path if path.is_relative_to(base) else None
