"""Writing the pack of a design, with its meshes and the licence of what made it."""

from __future__ import annotations

from importlib import metadata
from pathlib import Path
from typing import Any

from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import Skin
from workbench.planning.plan import InlineRunner, StageMonitor, evaluate, plan
from workbench.project.design_toml import design_files
from workbench.project.project import Project
from workbench.robots.robot_body import robot_body
from workbench.robots.robot_files import robot_files
from workbench.sensor.making import make_pack
from workbench.sensor.pack import write_pack

DISTRIBUTION = "sensor-workbench"
LICENSE = "LICENSE"
SKINS = ("outer", "inner", "cavity")
STAGES = ("build", "mesh", "housing")
"""What its meshes and masses are of."""


def export_pack(
    design: SensorDesign,
    folder: Path,
    project: Project,
    *,
    width_px: int | None = None,
    monitor: StageMonitor | None = None,
) -> list[Path]:
    """Write a pack, with the sensor as MJCF and URDF; returns the paths.

    Args:
        design: The sensor.
        folder: Made where there is none; files of an earlier pack are written anew.
        project: Where results are kept.
        width_px: Width of its images, the camera's own where left out.
        monitor: Told stage, fraction and note.

    Raises:
        WorkbenchError: If the design cannot be condensed, its rigid parts cannot be made, or a file
            cannot be written.
    """
    pack = make_pack(design, project, width_px=width_px, monitor=monitor)
    case, runner = PressCase(), InlineRunner(project.store)
    for _ in evaluate(design, case, runner, wanted=STAGES, monitor=monitor):
        pass
    calls = plan(design, case)
    solid, mesh, housing = (project.store.load(name, calls[name].key) for name in STAGES)
    others = {f"{name}.stl": _stl(getattr(mesh, name)) for name in SKINS}
    taxels = Skin(points_mm=pack.skin.points_mm, faces=pack.skin.faces, normals=pack.skin.normals)
    robot = robot_files(robot_body(design, solid, housing, taxels))
    files = {**others, **robot, LICENSE: licence(), **dict(design_files(design))}
    return write_pack(pack, folder, files)


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
