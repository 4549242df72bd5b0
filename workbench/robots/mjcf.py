"""A sensor as MuJoCo's XML: `sensor.xml`, and `skin.xml` that it includes.

    body sensor          rigid parts; site `mount`, camera `camera`
      body skin          elastomer; geoms `pad` (collides) and `taxels`

Both bodies have the sensor's frame. MuJoCo collides the convex hulls of `pad` and of the foot.
The tactile sensor `touch` reads depth and two sliding speeds at each vertex of `taxels`; it wants
three unit vectors a vertex (normal, two tangents), which only a mesh in XML can hold.
Source: MuJoCo 4.0, XML reference, `sensor/tactile`.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np

from workbench.core.base.frames import tangent
from workbench.core.base.version import VERSION
from workbench.core.result.results import Skin
from workbench.robots.camera_pose import field_y_deg, opengl_wxyz
from workbench.robots.inertia import M_OF_MM, Inertia, together
from workbench.robots.mesh_files import SCALE, mesh_file
from workbench.robots.robot_body import RobotBody, RobotPart
from workbench.robots.xml_text import document, element, numbers

MODEL, SKIN = "sensor.xml", "skin.xml"
SOFT_RGBA, CLEAR_RGBA, PRINT_RGBA = "0.55 0.58 0.62 1", "0.8 0.9 1 0.3", "0.12 0.12 0.12 1"
UNTOUCHED = {"contype": "0", "conaffinity": "0"}
HIDDEN, SHOWN = "4", "2"
"""Groups of geoms: MuJoCo's viewers draw 0 to 2."""


def mjcf(body: RobotBody) -> dict[str, bytes]:
    """Files by name: the model, and the skin that it includes; its meshes are `mesh_files`."""
    root = ET.Element("mujoco", model=body.name)
    element(root, "include", file=SKIN)
    assets = element(root, "asset")
    for part in (*body.rigid, body.membrane):
        element(assets, "mesh", name=part.name, file=mesh_file(part), scale=numbers(SCALE))
    whole = element(element(root, "worldbody"), "body", name="sensor")
    _inertial(whole, together(part.inertia() for part in body.rigid))
    element(whole, "site", name="mount", pos=numbers(body.mount_mm * M_OF_MM))
    _camera(whole, body)
    for part in body.rigid:
        touched = {} if part is body.foot else UNTOUCHED
        colour = CLEAR_RGBA if part.clear else PRINT_RGBA
        _geom(whole, part, name=part.name, group=SHOWN, rgba=colour, **touched)
    soft = element(whole, "body", name="skin")
    _inertial(soft, body.membrane.inertia())
    # First among equals: the skin's friction counts, whatever it touches.
    rubs = {"friction": numbers([body.friction, 0.005, 0.0001]), "priority": "1"}
    _geom(soft, body.membrane, name="pad", group=SHOWN, rgba=SOFT_RGBA, **rubs)
    element(soft, "geom", name="taxels", type="mesh", mesh="taxels", group=HIDDEN, **UNTOUCHED)
    sensors = element(root, "sensor")
    element(sensors, "tactile", name="touch", geom="taxels", mesh="taxels")
    says = f"{body.name}, by sensor workbench {VERSION}; m, kg, s; no mass of camera, LEDs, cables"
    return {MODEL: document(root, says), SKIN: taxels(body.skin)}


def _geom(parent: ET.Element, part: RobotPart, **attributes: str) -> None:
    element(parent, "geom", type="mesh", mesh=part.name, **attributes)


def _inertial(parent: ET.Element, inertia: Inertia) -> None:
    tensor = inertia.tensor_kgm2
    places = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    element(
        parent,
        "inertial",
        pos=numbers(inertia.centre_m),
        mass=numbers([inertia.mass_kg]),
        fullinertia=numbers([tensor[place] for place in places]),
    )


def _camera(parent: ET.Element, body: RobotBody) -> None:
    camera = body.camera
    element(
        parent,
        "camera",
        name="camera",
        pos=numbers(np.array(camera.position_mm) * M_OF_MM),
        quat=numbers(opengl_wxyz(camera)),
        fovy=numbers([field_y_deg(camera)]),
        resolution=f"{camera.width_px} {camera.height_px}",
    )


def taxels(skin: Skin) -> bytes:
    """A file with the mesh `taxels`, its vertices in the order of the skin's."""
    root = ET.Element("mujoco")
    element(
        element(root, "asset"),
        "mesh",
        name="taxels",
        scale=numbers(SCALE),
        # It is no closed body.
        inertia="shell",
        vertex=numbers(skin.points_mm),
        normal=numbers(_frames(skin.normals)),
        face=" ".join(map(str, skin.faces.ravel())),
    )
    return document(root, "the taxels of sensor.xml")


def _frames(normals: np.ndarray) -> np.ndarray:
    """Normal and two tangents of each vertex, shape (N, 9)."""
    first = np.array([tangent(normal) for normal in normals])
    return np.concatenate([normals, first, np.cross(normals, first)], axis=1)
