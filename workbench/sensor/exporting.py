"""Writing the pack of a design, with its meshes and the licence of what made it."""

from __future__ import annotations

from importlib import metadata
from pathlib import Path
from typing import Any

from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh, Skin
from workbench.planning.plan import StageMonitor, plan
from workbench.project.design_toml import design_files
from workbench.project.project import Project
from workbench.sensor.making import make_pack
from workbench.sensor.pack import write_pack

DISTRIBUTION = "sensor-workbench"
LICENSE = "LICENSE"
SKINS = ("outer", "inner", "cavity")


def export_pack(
    design: SensorDesign,
    folder: Path,
    project: Project,
    *,
    width_px: int | None = None,
    monitor: StageMonitor | None = None,
) -> list[Path]:
    """Write a pack; returns the paths.

    Args:
        design: The sensor.
        folder: Made where there is none; files of an earlier pack are written anew.
        project: Where results are kept.
        width_px: Width of its images, the camera's own where left out.
        monitor: Told stage, fraction and note.

    Raises:
        WorkbenchError: If the design cannot be condensed, or a file cannot be written.
    """
    pack = make_pack(design, project, width_px=width_px, monitor=monitor)
    call = plan(design, PressCase())["mesh"]
    mesh: MembraneMesh = project.store.load(call.stage, call.key)
    others = {f"{name}.stl": _stl(getattr(mesh, name)) for name in SKINS}
    return write_pack(pack, folder, {**others, LICENSE: licence(), **dict(design_files(design))})


def licence() -> bytes:
    """The licence that the program came with."""
    for path in metadata.files(DISTRIBUTION) or ():
        if path.name == LICENSE:
            return path.read_binary()
    return (Path(__file__).parents[2] / LICENSE).read_bytes()


def _stl(skin: Skin) -> bytes:
    import trimesh

    mesh = trimesh.Trimesh(skin.points_mm, skin.faces, process=False)
    written: Any = mesh.export(file_type="stl")
    return bytes(written)
