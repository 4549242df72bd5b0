"""`wb.attach`: a sensor on a body in MuJoCo, what it feels there, and its force on both bodies."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pytest

from tests.unit.test_sensor import small_pack
from workbench.core.base.errors import DesignError, SolveError
from workbench.core.base.packages import PackageError
from workbench.sensor.sensor import Sensor
from workbench.simulators.mujoco_attach import AttachOptions, attach
from workbench.simulators.mujoco_shapes import distances_mm, thing_of_geom, thing_of_geoms

mujoco = pytest.importorskip("mujoco")
pytestmark = pytest.mark.usefixtures("taichi_device")

TIP_MM = 42.0
GRAVITY = 9.81
BALL = '<geom name="ball" type="sphere" size=".003" mass=".02"/>'
AT_REST = np.array([1.0, 0.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def sensor() -> Sensor:
    return Sensor(small_pack())


def simulated(
    things: str,
    *,
    pose: str = "",
    option: str = 'gravity="0 0 0"',
    more: str = "",
    joint: str = "<freejoint/>",
) -> tuple[Any, Any]:
    """A model with a pad on the body `skin` of an arm, which stands free, and further bodies."""
    xml = f"""<mujoco><option {option}/><worldbody><body name="arm" {pose}>{joint}
    <inertial pos=".01 .02 .03" mass=".5" diaginertia="1e-3 1e-3 1e-3"/>
    <body name="skin"><geom name="pad" type="capsule" fromto="0 0 0 0 0 .027" size=".015"
    mass=".01"/></body></body>{things}</worldbody>{more}</mujoco>"""
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def ball_over(depth_mm: float, *, name: str = "ball", aside_mm: float = 0.0) -> str:
    """A ball of 6 mm that stands so deep in the tip."""
    height_m = 1e-3 * (TIP_MM + 3.0 - depth_mm)
    geom = BALL.replace('"ball"', f'"{name}"')
    place = f"{1e-3 * aside_mm} 0 {height_m}"
    return f'<body name="{name}" pos="{place}"><freejoint/>{geom}</body>'


def test_a_ball_in_the_tip_is_pushed_along_the_axis(sensor: Sensor) -> None:
    """.3 mm deep: up on the ball, down on the arm, the frame as `Sensor.render` gives it."""
    model, data = simulated(ball_over(0.3))
    frame = attach(model, data, "skin", "ball", sensor, apply_force=True)()
    sensor.reset(1)
    pose = np.r_[0.0, 0.0, TIP_MM + 3.0 - 0.3, AT_REST]
    alone = sensor.render(pose, sensor.object("sphere", size_mm=6.0))
    assert frame.force_N == pytest.approx(alone.force_N, rel=1e-3, abs=1e-4)
    assert np.abs(frame.rgb.astype(int) - alone.rgb).max() <= 1
    (force, moment) = data.body("ball").xfrc_applied.reshape(2, 3)
    assert force[2] == pytest.approx(frame.force_N[0, 2])
    assert force[2] > 0.1
    assert np.abs(force[:2]).max() < 0.02 * force[2]
    # About its middle a ball is hardly turned: the dent is where it stands.
    assert np.abs(moment).max() < 1e-4 * force[2]


def test_forces_and_moments_of_both_bodies_cancel(sensor: Sensor) -> None:
    """Beside the tip, the sensor turned and moved: no force and no moment about any place."""
    model, data = simulated(ball_over(0.5, aside_mm=1.0))
    before = attach(model, data, "skin", "ball", sensor).feel()
    pose = 'pos=".2 -.1 .3" quat=".8 .36 -.48 0"'
    model, data = simulated(f"<frame {pose}>{ball_over(0.5, aside_mm=1.0)}</frame>", pose=pose)
    turned = attach(model, data, "skin", "ball", sensor, apply_force=True).feel()
    assert turned.force_N == pytest.approx(before.force_N, rel=1e-3, abs=1e-4)
    assert turned.torque_Nmm == pytest.approx(before.torque_Nmm, rel=1e-2, abs=2e-3)
    on_ball, on_skin = data.body("ball"), data.body("skin")
    world = on_skin.xmat.reshape(3, 3) @ turned.force_N[0]
    assert on_ball.xfrc_applied[:3] == pytest.approx(world, rel=1e-5)
    total = sum(
        np.r_[
            body.xfrc_applied[:3],
            body.xfrc_applied[3:] + np.cross(body.xipos, body.xfrc_applied[:3]),
        ]
        for body in (on_ball, on_skin)
    )
    assert total == pytest.approx(np.zeros(6), abs=1e-9)


def test_a_ball_at_rest_weighs_what_it_weighs(sensor: Sensor) -> None:
    """20 g on the tip, held by the skin alone: .196 N after .15 s, and MuJoCo has no contact."""
    things = ball_over(0.2).replace("<freejoint/>", '<joint type="slide" axis="0 0 1"/>')
    model, data = simulated(things, option=f'gravity="0 0 {-GRAVITY}"', joint="")
    options: AttachOptions = {"apply_force": True, "damping_s": 4e-3}
    touch = attach(model, data, "skin", "ball", sensor, **options)
    for _ in range(75):
        mujoco.mj_step(model, data)
        felt = touch.feel()
    assert data.ncon == 0
    assert felt.force_N[0, 2] == pytest.approx(0.02 * GRAVITY, rel=0.02)


def test_forces_of_others_stay(sensor: Sensor) -> None:
    """What somebody else applies to the ball is neither taken away nor taken twice."""
    model, data = simulated(ball_over(0.3))
    touch = attach(model, data, "skin", "ball", sensor, apply_force=True)
    data.body("ball").xfrc_applied[0] = 0.25
    ours = [touch.feel().force_N[0] for _ in range(3)]
    assert data.body("ball").xfrc_applied[:3] == pytest.approx(ours[-1] + [0.25, 0.0, 0.0])


def test_without_force_mujoco_keeps_its_contact(sensor: Sensor) -> None:
    """Nothing is applied, and the model is left alone."""
    model, data = simulated(ball_over(0.3))
    assert data.ncon == 1
    felt = attach(model, data, "skin", "ball", sensor).feel()
    mujoco.mj_forward(model, data)
    assert felt.force_N[0, 2] > 0.1
    assert data.ncon == 1
    assert not data.xfrc_applied.any()


def test_an_excluded_pair_keeps_the_collisions_of_others(sensor: Sensor) -> None:
    """With the pair in the model's `exclude` the pad still meets what is not felt."""
    beside = ball_over(0.3, name="other", aside_mm=8.0).replace(".0447", ".0421")
    for more, contacts in (('<contact><exclude body1="skin" body2="ball"/></contact>', 1), ("", 0)):
        model, data = simulated(ball_over(0.3) + beside, more=more)
        attach(model, data, "skin", "ball", sensor, apply_force=True)
        mujoco.mj_forward(model, data)
        assert data.ncon == contacts


def test_a_sensor_on_two_bodies_is_two_sensors(sensor: Sensor) -> None:
    """Sheared in turn, each feels to the last bit what it feels alone."""
    names = ("ball", "deep")

    def felt(together: tuple[str, ...]) -> dict[str, list[np.ndarray]]:
        model, data = simulated(ball_over(0.4) + ball_over(0.6, name="deep"))
        touches = {name: attach(model, data, "skin", name, sensor) for name in together}
        found: dict[str, list[np.ndarray]] = {name: [] for name in together}
        for _ in range(4):
            data.qpos[[7, 14]] += [1e-4, -2e-4]
            for name, touch in touches.items():
                found[name].append(touch.feel().force_N[0])
        return found

    shared = felt(names)
    for name in names:
        assert np.array_equal(shared[name], felt((name,))[name])
    sheared = [shared[name][-1][0] for name in names]
    # The skin holds back what slides over it.
    assert sheared[0] < -0.005 < 0.005 < sheared[1]


def test_the_deepest_object_is_felt(sensor: Sensor) -> None:
    """Of two balls; once the other stands deeper, that one, from a touch of its own."""
    model, data = simulated(ball_over(0.2) + ball_over(0.5, name="deep", aside_mm=4.0))
    touch = attach(model, data, "skin", ["ball", "deep"], sensor, apply_force=True)
    # Four mm aside the dome is half a mm lower.
    touch.feel()
    assert touch.felt_object.names == ("ball",)
    assert data.body("ball").xfrc_applied[2] > 0.0
    data.qpos[9] += 1e-3
    touch.feel()
    assert touch.felt_object.names == ("deep",)
    assert not data.body("ball").xfrc_applied.any()


def test_a_simulation_that_begins_anew_is_felt_anew(sensor: Sensor) -> None:
    """After `mj_resetData` the first step gives the same force, to the last bit."""
    model, data = simulated(ball_over(0.3))
    touch = attach(model, data, "skin", "ball", sensor, apply_force=True)

    def steps() -> list[np.ndarray]:
        found = []
        for _ in range(5):
            mujoco.mj_step(model, data)
            found.append(touch.feel().force_N[0])
        return found

    first = steps()
    mujoco.mj_resetData(model, data)
    assert np.array_equal(first, steps())


def test_a_step_that_throws_the_ball_off_is_refused(sensor: Sensor) -> None:
    """A spring and a mass alone, a hair on either side of k h (h + 2 t) = 4 m: it grows or not."""
    mass_kg, stiffness_N_m, damping_s = 0.004, 2000.0, 1e-3
    longest_s = (damping_s**2 + 4.0 * mass_kg / stiffness_N_m) ** 0.5 - damping_s
    for factor, grows in ((0.98, False), (1.02, True)):
        place, speed, step_s = 1.0, 0.0, factor * longest_s
        for _ in range(400):
            speed -= step_s * stiffness_N_m * (place + damping_s * speed) / mass_kg
            place += step_s * speed
        assert (abs(place) > 1.0) is grows
    model, data = simulated(ball_over(0.4).replace('mass=".02"', 'mass="1e-4"'))
    touch = attach(model, data, "skin", "ball", sensor, apply_force=True)
    touch.feel()
    data.time += 2e-3
    with pytest.raises(SolveError, match=r"too long for 0\.1 g on a skin of .* limit is") as caught:
        touch.feel()
    assert "timestep" in caught.value.hint


SHAPES = {
    "ball": ('type="sphere" size=".003"', 1e-3),
    "capsule": ('type="capsule" size=".003 .004"', 1e-3),
    # Edges are rounded by .45 mm: three sides of a corner lose .45 (root of 3 - 1).
    "cylinder": ('type="cylinder" size=".003 .005"', 0.19),
    "cube": ('type="box" size=".003 .003 .003"', 0.34),
    # Of triangles, sampled every .1 mm.
    "box": ('type="box" size=".003 .004 .002"', 0.1),
    "ellipsoid": ('type="ellipsoid" size=".003 .004 .005"', 0.02),
}


@pytest.mark.parametrize("name", SHAPES)
def test_a_geom_is_as_far_as_mujoco_says(name: str) -> None:
    """From places .3 mm or less off: to a micrometre, but for edges that are rounded."""
    geom, tolerance_mm = SHAPES[name]
    probe = '<body name="probe" mocap="true"><geom name="probe" size="1e-6"/></body>'
    model, data = simulated(
        f'<body name="it" pos=".1 0 0" euler="30 40 50"><geom name="it" {geom}/></body>{probe}'
    )
    thing = thing_of_geom(model, model.geom("it").id)
    turned = data.geom("it").xmat.reshape(3, 3)
    random = np.random.default_rng(5)
    found, wanted = [], []
    while len(found) < 40:
        place_mm = random.uniform(-6.0, 6.0, 3)
        data.mocap_pos[0] = data.geom("it").xpos + turned @ (1e-3 * place_mm)
        mujoco.mj_kinematics(model, data)
        ids = (model.geom("it").id, model.geom("probe").id)
        away_mm = 1e3 * mujoco.mj_geomDistance(model, data, *ids, 0.01, np.zeros(6)) + 1e-3
        if 0.0 < away_mm < 0.3:
            wanted.append(away_mm)
            pose = np.r_[0.0, 0.0, 0.0, AT_REST]
            found.append(distances_mm(thing, place_mm[None], pose)[0])
    error_mm = np.array(found) - wanted
    assert np.abs(error_mm).max() < tolerance_mm
    assert np.abs(np.median(error_mm)) < 0.01


def test_the_end_of_a_capsule_is_a_ball(sensor: Sensor) -> None:
    """Upright on the tip: the force of a ball of its radius."""
    geom = '<geom name="capsule" type="capsule" size=".003 .01" mass=".1"/>'
    upright = f'<body name="capsule" pos="0 0 {1e-3 * (TIP_MM + 13.0 - 0.4)}">{geom}</body>'
    model, data = simulated(ball_over(0.4) + upright)
    on_tip = ("ball", "capsule")
    ball, capsule = (attach(model, data, "skin", name, sensor).feel() for name in on_tip)
    assert capsule.force_N == pytest.approx(ball.force_N, rel=2e-3, abs=1e-4)


def test_geoms_of_one_body_are_one_object() -> None:
    """Two boxes that overlap are the box around both."""
    halves = [
        f'<geom name="{name}" type="box" size=".003 .004 .002" pos="{at} .001 0"/>'
        for name, at in (("left", -0.002), ("right", 0.002))
    ]
    model, _ = simulated(f'<body name="bar">{"".join(halves)}</body>')
    whole = thing_of_geoms(model, [model.geom(name).id for name in ("left", "right")])
    pose = np.r_[0.0, 0.0, 0.0, AT_REST]
    places = np.array([[0.0, 1.0, 2.2], [0.0, 5.2, 0.0], [5.2, 1.0, 0.0], [-4.8, 1.0, 0.0]])
    wanted_mm = [0.2, 0.2, 0.2, -0.2]
    assert distances_mm(whole, places, pose) == pytest.approx(wanted_mm, abs=0.01)


def test_what_cannot_be_meant_is_refused(sensor: Sensor, monkeypatch: pytest.MonkeyPatch) -> None:
    """Names that are not there, no geoms, a plane; and MuJoCo where it is missing."""
    model, data = simulated(ball_over(0.3) + '<geom name="floor" type="plane" size="1 1 1"/>')
    with pytest.raises(DesignError, match="no body 'skim'") as caught:
        attach(model, data, "skim", "ball", sensor)
    assert "did you mean 'skin'" in caught.value.hint
    with pytest.raises(DesignError, match="no geom 'bal'"):
        attach(model, data, "skin", ["bal"], sensor)
    with pytest.raises(DesignError, match="no geoms are named"):
        attach(model, data, "skin", [], sensor)
    with pytest.raises(DesignError, match="'floor' is a plane") as caught:
        attach(model, data, "skin", "floor", sensor)
    assert "box" in caught.value.hint
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(PackageError, match="mujoco"):
        attach(model, data, "skin", "ball", sensor)
