"""A sensor as URDF, `sensor.urdf`: the same bodies, meshes and masses as its MJCF.

    NAME_mount           where a robot holds it: below the foot, no mass
      NAME_base          rigid parts; its frame is the sensor's
        NAME_skin        elastomer
        NAME_camera      optical frame: +Z forward, +X right, +Y down (REP 103)

Mesh files are named without a folder: they lie beside the file.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence

import numpy as np

from sim.optics.camera.camera import rotation_camera_to_sensor
from workbench.core.base.version import VERSION
from workbench.robots.inertia import M_OF_MM, Inertia, together
from workbench.robots.mesh_files import SCALE, mesh_file
from workbench.robots.robot_body import RobotBody, RobotPart
from workbench.robots.xml_text import document, element, numbers

MODEL = "sensor.urdf"


def urdf(body: RobotBody) -> dict[str, bytes]:
    """The file by its name; its meshes are `mesh_files`."""
    root = ET.Element("robot", name=body.name)
    mount, base, skin, camera = (
        f"{body.name}_{name}" for name in ("mount", "base", "skin", "camera")
    )
    element(root, "link", name=mount)
    _link(root, base, body.rigid, solid=body.foot)
    _link(root, skin, (body.membrane,), solid=body.membrane)
    element(root, "link", name=camera)
    _fixed(root, (mount, base), -body.mount_mm)
    _fixed(root, (base, skin), np.zeros(3))
    turn = rotation_camera_to_sensor(body.camera)
    _fixed(root, (base, camera), np.array(body.camera.position_mm), turn)
    says = f"{body.name}, by sensor workbench {VERSION}; m, kg, s; no mass of camera, LEDs, cables"
    return {MODEL: document(root, says)}


def roll_pitch_yaw(rotation: np.ndarray) -> np.ndarray:
    """Angles r, p, y [rad] of Rz(y) Ry(p) Rx(r), as URDF has them, of a matrix: shape (3,)."""
    from scipy.spatial.transform import Rotation

    # Straight up or down, roll and yaw turn about one axis: any share of it will do.
    return Rotation.from_matrix(rotation).as_euler("xyz", suppress_warnings=True)


def _link(root: ET.Element, name: str, parts: Sequence[RobotPart], *, solid: RobotPart) -> None:
    link = element(root, "link", name=name)
    _inertial(link, together(part.inertia() for part in parts))
    for tag, shown in (("visual", parts), ("collision", (solid,))):
        for part in shown:
            geometry = element(element(link, tag), "geometry")
            element(geometry, "mesh", filename=mesh_file(part), scale=numbers(SCALE))


def _inertial(link: ET.Element, inertia: Inertia) -> None:
    inertial = element(link, "inertial")
    element(inertial, "origin", xyz=numbers(inertia.centre_m), rpy="0 0 0")
    element(inertial, "mass", value=numbers([inertia.mass_kg]))
    places = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2)}
    tensor = inertia.tensor_kgm2
    found = {key: numbers([tensor[place]]) for key, place in {**places, "izz": (2, 2)}.items()}
    element(inertial, "inertia", **found)


def _fixed(
    root: ET.Element,
    links: tuple[str, str],
    origin_mm: np.ndarray,
    rotation: np.ndarray | None = None,
) -> None:
    """A joint that does not move, from the first link to the second."""
    parent, child = links
    joint = element(root, "joint", name=f"{child}_joint", type="fixed")
    element(joint, "parent", link=parent)
    element(joint, "child", link=child)
    angles = roll_pitch_yaw(np.eye(3) if rotation is None else rotation)
    element(joint, "origin", xyz=numbers(origin_mm * M_OF_MM), rpy=numbers(angles))
