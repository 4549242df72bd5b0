"""The arrows between packages point one way, and starting the front loads nothing heavy."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
OURS = ("workbench", "designs", "geometry", "sim", "ui")
FILES = sorted(p for name in OURS for p in (ROOT / name).rglob("*.py"))


def may_import(room: str, target: str) -> bool:
    """Whether a module of `room` may import `target`: the table of the architecture."""
    core = target == "workbench.core" or target.startswith("workbench.core.")
    package = target.split(".", maxsplit=1)[0]
    if room == "core":
        return core
    if room == "designs":
        return core or package == "designs"
    if room == "geometry":
        return core or package == "geometry"
    if room == "sim":
        surface = target.startswith(("geometry.surface", "geometry.rays"))
        return core or package == "sim" or surface
    if room == "ui":
        return package in ("ui", "workbench")
    return package in ("workbench", "designs", "geometry", "sim")


def room_of(path: Path) -> str:
    parts = path.relative_to(ROOT).parts
    return "core" if parts[:2] == ("workbench", "core") else parts[0]


def imported(path: Path) -> list[str]:
    names: list[str] = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    return [name for name in names if name.split(".")[0] in OURS]


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(ROOT)))
def test_imports_point_one_way(path: Path) -> None:
    """No module imports a layer above it; `workbench serve` may reach the front, lazily."""
    room = room_of(path)
    for name in imported(path):
        lazy_front = path.name == "commands.py" and name.startswith("ui.app")
        # `from geometry import surface` is named as package and as module: the module decides.
        if name in OURS and may_import(room, f"{name}.surface"):
            continue
        assert lazy_front or may_import(room, name), f"{path.name} imports {name}"


def test_core_imports_only_the_standard_library_and_numpy() -> None:
    """core has no third-party import but numpy."""
    for path in FILES:
        if room_of(path) != "core":
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            modules = []
            if isinstance(node, ast.Import):
                modules = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                modules = [node.module or ""]
            for module in modules:
                top = module.split(".")[0]
                assert top in sys.stdlib_module_names or top in ("numpy", "workbench"), module


def test_front_loads_no_heavy_package() -> None:
    """`import ui.app` leaves taichi, torch and build123d out of the process."""
    code = (
        "import sys, ui.app;"
        "print([m for m in ('taichi', 'torch', 'build123d') if m in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert done.stdout.strip() == "[]"


def test_no_file_is_longer_than_500_lines() -> None:
    """A file over 500 lines must be split."""
    for path in FILES:
        assert len(path.read_text().splitlines()) <= 500, path
