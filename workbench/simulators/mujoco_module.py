"""MuJoCo, found when it is needed; its compiled module tells type checkers nothing."""

from __future__ import annotations

import importlib
from typing import Any

from workbench.core.base.packages import naming_packages

MjModel = Any
"""A `mujoco.MjModel`."""
MjData = Any
"""A `mujoco.MjData`."""


def mujoco() -> Any:
    """The module.

    Raises:
        PackageError: If it is not installed.
    """
    with naming_packages():
        return importlib.import_module("mujoco")
