"""MJCF and URDF of a sensor: masses against closed forms, poses and meshes as others read them."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.optics.camera.camera import project, rotation_camera_to_sensor
from tests.made_robots import CAMERA, FOOT_MM, box, made_robot, part, written
from workbench.core.base.errors import GeometryError
from workbench.core.design.camera import Camera, LensModel
from workbench.robots.camera_pose import field_y_deg
from workbench.robots.inertia import of_body, together
from workbench.robots.robot_body import plain_name
from workbench.robots.robot_files import robot_files
from workbench.robots.urdf import roll_pitch_yaw

SINGLE = 1e-6
"""Seven digits are written, and MuJoCo reads meshes in single precision."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("robot"))


@pytest.fixture
def mujoco() -> Any:
    return pytest.importorskip("mujoco")


def test_a_box_has_the_inertia_of_a_box() -> None:
    """m (b^2 + c^2) / 12 about each axis; 1 g/cm3 is 1e-6 kg/mm3."""
    a, b, c = FOOT_MM
    found = part("foot", box(FOOT_MM), 1.24, -4.0).inertia()
    assert found.mass_kg == pytest.approx(1.24e-6 * a * b * c)
    assert found.centre_m == pytest.approx([0.0, 0.0, -0.004], abs=1e-12)
    squares = np.array([b * b + c * c, a * a + c * c, a * a + b * b]) * 1e-6
    assert found.tensor_kgm2 == pytest.approx(np.diag(found.mass_kg / 12.0 * squares), abs=1e-15)


def test_halves_together_are_the_whole() -> None:
    """Two cubes side by side, apart from the origin, are the box of both."""
    cube = box((10.0, 10.0, 10.0))
    halves = [
        of_body(np.add(cube.vertices, [at, 7.0, -3.0]), np.asarray(cube.faces), 2.0)
        for at in (-5.0, 5.0)
    ]
    bar = box((20.0, 10.0, 10.0))
    whole = of_body(np.add(bar.vertices, [0.0, 7.0, -3.0]), np.asarray(bar.faces), 2.0)
    found = together(halves)
    assert found.mass_kg == pytest.approx(whole.mass_kg)
    assert found.centre_m == pytest.approx(whole.centre_m)
    assert found.tensor_kgm2 == pytest.approx(whole.tensor_kgm2, abs=1e-15)


def test_a_surface_without_volume_has_no_mass() -> None:
    """A box turned inside out."""
    cube = box((10.0, 10.0, 10.0))
    with pytest.raises(GeometryError, match="no volume that could have a mass"):
        of_body(np.asarray(cube.vertices), np.asarray(cube.faces)[:, ::-1], 1.0)


def test_mujoco_reads_masses_and_inertias(mujoco: Any, folder: Path) -> None:
    """Foot and tube on one body, the elastomer on its child: volume times density."""
    model = mujoco.MjModel.from_xml_path(str(folder / "sensor.xml"))
    robot = made_robot()
    wanted = {
        "sensor": together(body.inertia() for body in robot.rigid),
        "skin": robot.membrane.inertia(),
    }
    ball_kg = 1.07e-6 * 4.0 / 3.0 * math.pi * 15.0**3
    assert wanted["skin"].mass_kg == pytest.approx(ball_kg, rel=0.02)  # 1,280 triangles
    for name, inertia in wanted.items():
        body = model.body(name)
        assert body.mass[0] == pytest.approx(inertia.mass_kg, rel=SINGLE)
        assert body.ipos == pytest.approx(inertia.centre_m, abs=1e-8)
        turned = np.zeros(9)
        mujoco.mju_quat2Mat(turned, body.iquat)
        turned = turned.reshape(3, 3)
        tensor = turned @ np.diag(body.inertia) @ turned.T
        assert tensor == pytest.approx(inertia.tensor_kgm2, abs=SINGLE * inertia.tensor_kgm2.max())
    assert model.site("mount").pos == pytest.approx([0.0, 0.0, -0.008])


def test_mujoco_has_the_meshes_in_metres(mujoco: Any, folder: Path) -> None:
    """Each geom where its part is; the taxels in the order of the skin's nodes."""
    model = mujoco.MjModel.from_xml_path(str(folder / "sensor.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    robot = made_robot()

    def points_mm(geom: str) -> np.ndarray:
        mesh = model.mesh(model.geom(geom).dataid[0])
        first, count = mesh.vertadr[0], mesh.vertnum[0]
        turned = data.geom(geom).xmat.reshape(3, 3)
        return 1e3 * (data.geom(geom).xpos + model.mesh_vert[first : first + count] @ turned.T)

    places = {"foot": robot.foot, "tube": robot.rigid[0], "pad": robot.membrane}
    for geom, body in places.items():
        ends = np.stack([body.points_mm.min(axis=0), body.points_mm.max(axis=0)])
        found = points_mm(geom)
        assert np.stack([found.min(axis=0), found.max(axis=0)]) == pytest.approx(ends, abs=1e-4)
    assert points_mm("taxels") == pytest.approx(robot.skin.points_mm, abs=1e-4)


def test_mujocos_camera_is_ours(mujoco: Any, folder: Path) -> None:
    """Its axes, and the pixel where it sees a place, as its own sensor reports it."""
    spec = mujoco.MjSpec.from_file(str(folder / "sensor.xml"))
    place_mm = np.array([3.0, -6.0, 30.0])
    spec.worldbody.add_site(name="place", pos=place_mm * 1e-3)
    spec.add_sensor(
        type=mujoco.mjtSensor.mjSENS_CAMPROJECTION,
        objtype=mujoco.mjtObj.mjOBJ_SITE,
        objname="place",
        reftype=mujoco.mjtObj.mjOBJ_CAMERA,
        refname="camera",
    )
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    axes = data.camera("camera").xmat.reshape(3, 3)
    # MuJoCo: +X right, +Y up, looks along -Z; ours: +Y down, along +Z.
    ours = rotation_camera_to_sensor(CAMERA) * [1.0, -1.0, -1.0]
    assert axes == pytest.approx(ours, abs=1e-5)
    assert 1e3 * data.camera("camera").xpos == pytest.approx(CAMERA.position_mm, abs=1e-6)
    (pixel,) = project(CAMERA, place_mm[None])
    assert data.sensordata[-2:] == pytest.approx(pixel, abs=0.02)


def test_the_vertical_field_is_that_of_the_lens() -> None:
    """Pinhole: tan(y/2) = 3/4 tan(x/2); a fisheye of 4:3: y = 3/4 x, at most 170 degrees."""
    pinhole = Camera(width_px=640, height_px=480, fov_x_deg=100.0)
    wanted = 2.0 * math.degrees(math.atan(0.75 * math.tan(math.radians(50.0))))
    assert field_y_deg(pinhole) == pytest.approx(wanted)
    fisheye = Camera(width_px=640, height_px=480, fov_x_deg=160.0, lens=LensModel.EQUIDISTANT)
    assert field_y_deg(fisheye) == pytest.approx(120.0)
    upright = Camera(width_px=480, height_px=640, fov_x_deg=150.0, lens=LensModel.EQUIDISTANT)
    assert field_y_deg(upright) == 170.0


def test_a_ball_lies_on_it_for_1000_steps(mujoco: Any, folder: Path) -> None:
    """MuJoCo's contact carries it; taxels feel it only where it is, as deep as it stands."""
    spec = mujoco.MjSpec.from_file(str(folder / "sensor.xml"))
    ball = spec.worldbody.add_body(name="ball", pos=[0.0, 0.0, 0.0481])
    ball.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0.0, 0.0, 1.0])
    ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.006, 0.0, 0.0], mass=0.05)
    model = spec.compile()
    data = mujoco.MjData(model)
    for _ in range(1000):
        mujoco.mj_step(model, data)
    assert data.body("ball").xpos[2] == pytest.approx(0.048, abs=2e-4)
    assert not data.warning.number.any()
    depth_mm = 1e3 * data.sensor("touch").data.reshape(3, -1)[0]
    points_mm = made_robot().skin.points_mm
    centre_mm = 1e3 * data.body("ball").xpos
    stands_mm = np.maximum(6.0 - np.linalg.norm(points_mm - centre_mm, axis=1), 0.0)
    assert depth_mm.max() > 0.0
    # The skin's vertices and the hull that collides are two meshes of one dome.
    assert depth_mm == pytest.approx(stands_mm, abs=2e-3)


def test_taxels_tell_how_fast_it_slides(mujoco: Any, folder: Path) -> None:
    """A block that moves by 20 mm/s along X over the tip: both speeds together are that."""
    spec = mujoco.MjSpec.from_file(str(folder / "sensor.xml"))
    block = spec.worldbody.add_body(name="block", pos=[0.0, 0.0, 0.0466])
    block.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[1.0, 0.0, 0.0])
    block.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.02, 0.02, 0.005], mass=0.05)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qvel[0] = 0.02
    mujoco.mj_forward(model, data)
    depth, *speeds = data.sensor("touch").data.reshape(3, -1)
    deepest = int(depth.argmax())
    assert made_robot().skin.points_mm[deepest, :2] == pytest.approx([0.0, 0.0], abs=1.0)
    assert np.hypot(*speeds)[deepest] == pytest.approx(0.02, rel=0.01)


def test_mujoco_reads_the_urdf(mujoco: Any, folder: Path) -> None:
    """The same masses, and the camera where it is above the mount."""
    spec = mujoco.MjSpec.from_file(str(folder / "sensor.urdf"))
    spec.compiler.fusestatic = False
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    robot = made_robot()
    base = together(body.inertia() for body in robot.rigid)
    assert model.body("made_base").mass[0] == pytest.approx(base.mass_kg, rel=SINGLE)
    skin_kg = robot.membrane.inertia().mass_kg
    assert model.body("made_skin").mass[0] == pytest.approx(skin_kg, rel=SINGLE)
    camera = data.body("made_camera")
    assert 1e3 * camera.xpos == pytest.approx([1.0, -2.0, 3.0 + 8.0], abs=1e-5)
    assert camera.xmat.reshape(3, 3) == pytest.approx(rotation_camera_to_sensor(CAMERA), abs=1e-5)


def test_yourdfpy_reads_the_urdf(folder: Path) -> None:
    """Links, meshes in metres, and the skin where it is above the mount."""
    yourdfpy = pytest.importorskip("yourdfpy")
    robot = yourdfpy.URDF.load(str(folder / "sensor.urdf"), load_collision_meshes=True)
    assert robot.base_link == "made_mount"
    assert set(robot.link_map) == {"made_mount", "made_base", "made_skin", "made_camera"}
    low, high = robot.scene.bounds
    assert 1e3 * low[2] == pytest.approx(0.0, abs=1e-4)
    assert 1e3 * high[2] == pytest.approx(42.0 + 8.0, abs=1e-3)
    placed = robot.get_transform("made_camera", "made_mount")
    assert placed[:3, :3] == pytest.approx(rotation_camera_to_sensor(CAMERA), abs=1e-5)


@pytest.mark.parametrize("pitch_deg", [0.0, 40.0, -90.0, 90.0])
def test_angles_of_urdf_are_the_rotation(pitch_deg: float) -> None:
    """Rz(y) Ry(p) Rx(r) of the angles is the matrix, straight up and down too."""

    def turn(angle: float, axis: int) -> np.ndarray:
        found = np.eye(3)
        one, two = (axis + 1) % 3, (axis + 2) % 3
        found[[one, two], [one, two]] = math.cos(angle)
        found[one, two], found[two, one] = -math.sin(angle), math.sin(angle)
        return found

    wanted = turn(0.7, 2) @ turn(math.radians(pitch_deg), 1) @ turn(-0.4, 0)
    roll, pitch, yaw = roll_pitch_yaw(wanted)
    assert turn(yaw, 2) @ turn(pitch, 1) @ turn(roll, 0) == pytest.approx(wanted, abs=1e-7)


def test_files_are_written_without_mujoco(monkeypatch: pytest.MonkeyPatch) -> None:
    """Who exports need not have it."""
    monkeypatch.setitem(sys.modules, "mujoco", None)
    assert {"sensor.xml", "skin.xml", "sensor.urdf", "membrane.stl"} <= robot_files(
        made_robot()
    ).keys()


@pytest.mark.parametrize(
    ("name", "plain"),
    [("geltip", "geltip"), ("My pad, v2!", "my_pad_v2"), ("3 mm", "sensor_3_mm"), ("ä", "sensor")],
)
def test_names_are_plain(name: str, plain: str) -> None:
    """Letters, digits and underscores, no digit first."""
    assert plain_name(name) == plain
