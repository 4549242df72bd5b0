"""The meshes of a sensor's parts: STL files in mm, scaled to metres where they are read."""

from __future__ import annotations

from typing import Any

from workbench.robots.inertia import M_OF_MM
from workbench.robots.robot_body import RobotBody, RobotPart

SCALE = (M_OF_MM, M_OF_MM, M_OF_MM)


def mesh_file(part: RobotPart) -> str:
    """Name of a part's file."""
    return f"{part.name}.stl"


def mesh_files(body: RobotBody) -> dict[str, bytes]:
    """Binary STL by file name: of the rigid parts and of the membrane."""
    import trimesh

    found: dict[str, bytes] = {}
    for part in (*body.rigid, body.membrane):
        mesh = trimesh.Trimesh(part.points_mm, part.faces, process=False)
        written: Any = mesh.export(file_type="stl")
        found[mesh_file(part)] = bytes(written)
    return found
