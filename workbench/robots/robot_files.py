"""All files of a sensor for robots' programs."""

from __future__ import annotations

from workbench.robots.mesh_files import mesh_files
from workbench.robots.mjcf import mjcf
from workbench.robots.robot_body import RobotBody
from workbench.robots.urdf import urdf


def robot_files(body: RobotBody) -> dict[str, bytes]:
    """`sensor.xml`, `sensor.urdf` and the meshes that both name, by file name.

    Raises:
        GeometryError: If a part encloses no volume.
    """
    return {**mjcf(body), **urdf(body), **mesh_files(body)}
