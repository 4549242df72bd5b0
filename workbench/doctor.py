"""`workbench doctor`: what this installation is, and what it lacks."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import os
import platform
import shutil
from pathlib import Path

from workbench import __version__
from workbench.devices import chosen_device, cuda_count, torch_build

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
    "scipy",
    "numpy",
)
OPTIONAL = {
    "pymeshlab": "isotropic remeshing (GPL-3.0)",
    "pypardiso": "fast sparse solver, extra [mkl]",
    "mitsuba": "path-traced reference images, extra [mitsuba]",
    "distributed": "sweeps on a cluster, extra [cluster]",
}


def report(project: Path) -> tuple[list[str], bool]:
    """Lines for people, and whether everything needed is there."""
    lines = [
        f"workbench   {__version__}",
        f"python      {platform.python_version()} on {platform.system()} {platform.machine()}",
        f"processors  {os.cpu_count()}",
        f"compute     {chosen_device()} ({cuda_count()} CUDA devices)",
    ]
    healthy = True
    for name in REQUIRED:
        version = _version(name)
        healthy = healthy and version is not None
        lines.append(f"{name:24}{version or 'MISSING: run make setup'}")
    if _version("torch"):
        lines.append(f"{'torch build':24}{torch_build()}")
    for name, purpose in OPTIONAL.items():
        lines.append(f"{name:24}{_version(name) or 'not installed'} - optional: {purpose}")
    folder = next(p for p in (project, *project.parents) if p.exists())
    free_gb = shutil.disk_usage(folder).free / 2**30
    writable = os.access(folder, os.W_OK)
    healthy = healthy and writable
    state = "" if writable else ", NOT WRITABLE: choose another with --project"
    lines.append(f"{'project':24}{project} ({free_gb:.0f} GB free{state})")
    browser = os.environ.get("CHROMIUM") or shutil.which("chromium") or "none (only tests need one)"
    lines.append(f"{'browser for tests':24}{browser}")
    return lines, healthy


def _version(name: str) -> str | None:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return None
