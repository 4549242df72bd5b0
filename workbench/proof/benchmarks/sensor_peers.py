"""MuJoCo's own tactile sensor beside ours: on the same skin, under the same ball, in one run.

MuJoCo returns three numbers a taxel, from geometry: how deep the object stands there, and how fast
it slides along two tangents. Its contact force is that of a spring chosen for stability, whose
stiffness grows with the mass of what it holds. Taxim and FOTS cannot be installed as packages.
"""

from __future__ import annotations

import functools
import importlib.util
from collections.abc import Callable
from typing import Any

import numpy as np

from workbench.core.result.results import Skin
from workbench.proof.benchmarks.timing import median_s
from workbench.proof.row import Row, stated
from workbench.robots.mjcf import SKIN, taxels
from workbench.sensor.sensor import Sensor
from workbench.simulators.mujoco_attach import attach
from workbench.simulators.mujoco_module import mujoco
from workbench.simulators.mujoco_shapes import MM_OF_M

BALL_MM = 6.0
LIGHT_KG, HEAVY_KG = 1e-3, 1e-1
AXES = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}


def rows(sensor: Sensor, poses: np.ndarray) -> list[Row]:
    """Rows of MuJoCo, none where it is not installed.

    Args:
        sensor: Ours.
        poses: Of the ball in each frame, shape (K, 7).
    """
    if importlib.util.find_spec("mujoco") is None:
        return []
    count, taxel_count = len(poses), len(sensor.skin.points_mm)
    ball = f"ball of {BALL_MM:g} mm"
    rates: dict[tuple[str, str], Callable[[], None]] = {
        (
            "sensor_peer_frames",
            f"{ball}, MuJoCo's tactile sensor of {taxel_count} taxels: three numbers each",
        ): functools.partial(_followed, *_simulated(sensor, touch=True), poses),
        (
            "sensor_peer_bare",
            f"{ball}, MuJoCo without a sensor: positions, contact and its force",
        ): functools.partial(_followed, *_simulated(sensor, touch=False), poses),
        ("sensor_attached", f"{ball}, `wb.attach` in MuJoCo: force and image"): functools.partial(
            _attached, sensor, poses, images=True
        ),
        ("sensor_attached_forces", f"{ball}, the same, forces alone"): functools.partial(
            _attached, sensor, poses, images=False
        ),
    }
    found = [
        stated(name, case, functools.partial(_rate, run, count), unit="1/s")
        for (name, case), run in rates.items()
    ]
    at_rest = poses[count // 2]
    for mass_kg in (LIGHT_KG, HEAVY_KG):
        found.append(
            stated(
                "sensor_peer_force",
                f"{ball} of {1e3 * mass_kg:g} g at rest in the tip: MuJoCo's contact",
                functools.partial(_contact_N, sensor, mass_kg, at_rest),
                unit="N",
            )
        )
    found.append(
        stated(
            "sensor_force",
            f"{ball} of any mass, the same place: the skin",
            functools.partial(_skin_N, sensor, at_rest),
            unit="N",
        )
    )
    return found


def _simulated(sensor: Sensor, *, touch: bool, mass_kg: float = LIGHT_KG) -> tuple[Any, Any]:
    """Model and data of a ball over the skin, with MuJoCo's tactile sensor or without."""
    skin = sensor.skin
    asset = taxels(Skin(points_mm=skin.points_mm, faces=skin.faces, normals=skin.normals))
    joints = "".join(f'<joint name="{n}" type="slide" axis="{axis}"/>' for n, axis in AXES.items())
    radius_m = 0.5 * BALL_MM / MM_OF_M
    feels = '<sensor><tactile geom="pad" mesh="taxels"/></sensor>' if touch else ""
    xml = f"""<mujoco><include file="{SKIN}"/><worldbody>
    <body name="skin"><geom name="pad" type="mesh" mesh="taxels"/></body>
    <body>{joints}<geom name="ball" type="sphere" size="{radius_m}" mass="{mass_kg}"/></body>
    </worldbody>{feels}</mujoco>"""
    model = mujoco().MjModel.from_xml_string(xml, {SKIN: asset})
    return model, mujoco().MjData(model)


def _followed(model: Any, data: Any, poses: np.ndarray) -> None:
    """The simulation at one place of the ball after the other."""
    forward = mujoco().mj_forward
    for pose in poses:
        data.qpos[:] = pose[:3] / MM_OF_M
        forward(model, data)


def _attached(sensor: Sensor, poses: np.ndarray, *, images: bool) -> None:
    model, data = _simulated(sensor, touch=False)
    touch = attach(model, data, "skin", "ball", sensor)
    for pose in poses:
        data.qpos[:] = pose[:3] / MM_OF_M
        mujoco().mj_forward(model, data)
        if images:
            touch()
        else:
            touch.feel()


def _contact_N(sensor: Sensor, mass_kg: float, pose: np.ndarray) -> float:
    """Normal force of MuJoCo's contact on a ball at rest."""
    model, data = _simulated(sensor, touch=False, mass_kg=mass_kg)
    _followed(model, data, pose[None])
    total_N = 0.0
    for contact in range(data.ncon):
        wrench = np.zeros(6)
        mujoco().mj_contactForce(model, data, contact, wrench)
        total_N += wrench[0]
    return total_N


def _skin_N(sensor: Sensor, pose: np.ndarray) -> float:
    sensor.reset(1)
    felt = sensor.feel(pose, sensor.object("sphere", size_mm=BALL_MM))
    return float(np.linalg.norm(felt.force_N[0]))


def _rate(run: Callable[[], None], count: int) -> float:
    """Frames a second."""
    return count / median_s(run)
