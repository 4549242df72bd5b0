"""A sensor of simple bodies for robots' programs: a box for a foot, a tube, a finger's skin."""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np
import trimesh

from workbench.core.design.camera import Camera
from workbench.robots.robot_body import RobotBody, RobotPart
from workbench.robots.robot_files import robot_files

FOOT_MM = (30.0, 20.0, 8.0)
CAMERA = Camera(
    width_px=320,
    height_px=240,
    fov_x_deg=90.0,
    position_mm=(1.0, -2.0, 3.0),
    # 30 degrees about X, then 10 about Z.
    wxyz=(0.962250, 0.257834, -0.022557, 0.084186),
)


def part(name: str, mesh: trimesh.Trimesh, density_g_cm3: float, height_mm: float) -> RobotPart:
    """A mesh, lifted, as a part."""
    points = np.add(mesh.vertices, [0.0, 0.0, height_mm])
    return RobotPart(
        name=name, points_mm=points, faces=np.asarray(mesh.faces), density_g_cm3=density_g_cm3
    )


@functools.cache
def made_robot() -> RobotBody:
    """Foot of 30 x 20 x 8 mm below 0, tube up to 38 mm, elastomer from 15 to 42 mm."""
    from sim.optics.proof.specimen import finger

    tube = trimesh.creation.annulus(11.0, 13.0, 38.0, sections=64)
    cap = trimesh.creation.icosphere(3, 15.0)
    return RobotBody(
        name="made",
        rigid=(part("tube", tube, 1.18, 19.0), part("foot", box(FOOT_MM), 1.24, -4.0)),
        membrane=part("membrane", cap, 1.07, 27.0),
        skin=finger(edge_mm=1.0).outer,
        camera=CAMERA,
        friction=0.3,
    )


def box(size_mm: tuple[float, float, float]) -> trimesh.Trimesh:
    """A box about the origin."""
    return trimesh.creation.box(size_mm)


def written(folder: Path) -> Path:
    """The files of the made robot in a folder."""
    for name, content in robot_files(made_robot()).items():
        (folder / name).write_bytes(content)
    return folder
