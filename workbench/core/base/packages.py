"""A package that is not installed: which one, and the command that installs it.

`pip install sensor-workbench` brings all of them. Where only some were installed on purpose, as on
a robot (docs/slim.md), most calls work, and the others are to say what they lack.
"""

from __future__ import annotations

import contextlib
from collections.abc import Generator

from workbench.core.base.errors import WorkbenchError

NAMES = {
    "cv2": "opencv-python-headless",
    "dask": "dask[distributed]",
    "distributed": "dask[distributed]",
    "lib3mf": "build123d",
    "msgspec": "viser",
    "OCP": "build123d",
    "tomli_w": "tomli-w",
    "vtkmodules": "pyvista",
    "zstandard": "viser",
}
"""What pip knows modules by, or what brings them, where that is not their own name."""
OURS = ("workbench", "designs", "geometry", "sim", "ui")


class PackageError(WorkbenchError):
    """A package that a call needs is not installed.

    Attributes:
        package: Its name for pip.
    """

    exit_code = 2

    def __init__(
        self, message: str, *, hint: str = "", at: str = "", package: str | None = None
    ) -> None:
        super().__init__(message, hint=hint, at=at)
        self.package = package


def missing_package(error: ModuleNotFoundError) -> PackageError | None:
    """The error for people; None where what is missing is a module of ours, which is a bug."""
    module = (error.name or "").partition(".")[0]
    if not module or module in OURS:
        return None
    package = NAMES.get(module, module)
    return PackageError(
        f"this needs the Python package {package}, which is not installed",
        hint=f"pip install {package}, or all that the workbench uses: pip install sensor-workbench",
        at=module,
        package=package,
    )


@contextlib.contextmanager
def naming_packages() -> Generator[None]:
    """Let a call inside say which package it lacks.

    Raises:
        PackageError: Instead of `ModuleNotFoundError`.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        named = missing_package(error)
        if named is None:
            raise
        raise named from error
