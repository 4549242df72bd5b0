"""`workbench doctor`: what this installation is, and what it lacks."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import os
import platform
import shutil
import tempfile
from pathlib import Path

from sim.forces.network.spec import Target
from sim.forces.network.weights import load_weights
from workbench.core.base.errors import DeviceError, StoreError
from workbench.core.base.version import VERSION
from workbench.pipeline.devices import (
    chosen_device,
    cuda_count,
    solver_device,
    torch_build,
    torch_device,
)
from workbench.pipeline.shipped import is_shipped, shipped_weights

REQUIRED = (
    "viser",
    "taichi",
    "trimesh",
    "build123d",
    "pytetwild",
    "torch",
    "opencv-python-headless",
    "pyvista",
    "embreex",
    "manifold3d",
    "potpourri3d",
    "scipy",
    "numpy",
    "shapely",
    "threadpoolctl",
    "tomli-w",
    "websockets",
)
OPTIONAL = {
    "pymeshlab": "isotropic remeshing (GPL-3.0)",
    "pypardiso": "fast sparse solver, extra [mkl]",
    "mitsuba": "path-traced reference images, extra [mitsuba]",
    "mujoco": "sensors on robots in simulation, extra [robots]",
}

UNUSABLE = "UNUSABLE"


def report(project: Path) -> tuple[list[str], bool]:
    """Lines for people, and whether everything needed is there."""
    lines = [
        f"workbench   {VERSION}",
        f"python      {platform.python_version()} on {platform.system()} {platform.machine()}",
        f"processors  {os.cpu_count()}",
    ]
    healthy = True
    try:
        lines.append(f"compute     {chosen_device()} ({cuda_count()} CUDA devices)")
    except DeviceError as error:
        lines.append(f"compute     {error.message}: {error.hint}")
        healthy = False
    for name in REQUIRED:
        version = _version(name)
        healthy = healthy and version is not None
        lines.append(f"{name:24}{version or 'MISSING: run make setup'}")
    if _version("torch"):
        try:
            lines.append(f"{'torch build':24}{torch_build()}")
        except (ImportError, OSError) as error:
            lines.append(f"{'torch build':24}DOES NOT LOAD: {error}")
            healthy = False
    for name, purpose in OPTIONAL.items():
        lines.append(f"{name:24}{_version(name) or 'not installed'} - optional: {purpose}")
    lines.append(f"{'finite elements':24}{_linear_solver()}")
    found, whole = _learned_forces()
    lines, healthy = lines + found, healthy and whole
    state = _folder_state(project)
    healthy = healthy and not state.startswith(UNUSABLE)
    lines.append(f"{'project':24}{project} ({state})")
    browser = os.environ.get("CHROMIUM") or shutil.which("chromium") or "none (only tests need one)"
    lines.append(f"{'browser for tests':24}{browser}")
    return lines, healthy


def _linear_solver() -> str:
    """What solves the equations of finite elements."""
    if _version("scipy") is None:
        return "nothing to solve with: run make setup"
    from sim.fem.linear_solver import has_pardiso

    near = "the GPU near the contact, elsewhere " if solver_device() == "cuda" else ""
    if has_pardiso():
        return f"{near}PARDISO of Intel MKL"
    faster = "pip install pypardiso on an x86 processor"
    return f"{near}SuperLU, about 3 times as slow as PARDISO: {faster}"


def _learned_forces() -> tuple[list[str], bool]:
    """Where networks compute and which ship, and whether all that is there is whole."""
    lines, whole = [], True
    if _version("torch"):
        try:
            lines.append(f"{'learned forces on':24}{torch_device()}")
        except (ImportError, OSError, DeviceError) as error:
            lines.append(f"{'learned forces on':24}nothing: {error}")
            whole = False
    for target in (Target.FORCE, Target.DISPLACEMENT):
        name = f"network: {target.value}"
        try:
            path = shipped_weights(target)
            load_weights(path)
            lines.append(f"{name:24}{path.name} ({path.stat().st_size / 1e6:.1f} MB)")
        except StoreError as error:
            lines.append(f"{name:24}{error.message}; {error.hint}")
            whole = whole and not is_shipped(target)
    return lines, whole


def _folder_state(project: Path) -> str:
    """Free space for a project folder, or why it cannot be used."""
    try:
        folder = next(p for p in (project, *project.parents) if p.exists())
        # Permission bits do not tell of read-only and virtual file systems: write something.
        with tempfile.TemporaryFile(dir=folder):
            free_gb = shutil.disk_usage(folder).free / 2**30
    except OSError as error:
        return f"{UNUSABLE}: {error.strerror or error}; choose another with --project"
    return f"{free_gb:.0f} GB free"


def _version(name: str) -> str | None:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return None
