"""Two fingers of ours pull at a peg on a spring, in MuJoCo: gently they slip, firmly they hold.

Shows: the `sensor.xml` of a pack, `wb.attach` with the skin's force; images and slip as a video.
"""

import subprocess
import sys
from pathlib import Path

import cv2
import mujoco
import numpy as np

import workbench as wb

PACK, VIDEO = Path("geltip_pack"), Path("out/examples/demo_mujoco.mp4")
if not (PACK / "sensor.xml").exists():  # minutes, once
    export = "-m workbench.cli export geltip --width-px 320 --pack".split()
    subprocess.run([sys.executable, *export, str(PACK)], check=True)

# A peg of 10 mm on a spring of 150 N/m between two fingers of a hand that can be lifted.
PULLED_MM, SPRING_N_MM, FRICTION = 6.0, 0.15, 0.3
HAND = """<mujoco><visual><global offwidth="640" offheight="360"/></visual><worldbody>
<light pos=".1 -.2 .3" dir="-.3 .6 -.9"/><geom type="plane" size=".2 .2 .01"/>
<camera name="side" pos="0 -.22 .1" xyaxes="1 0 0 0 .3 1"/>
<body name="peg" pos="0 0 .045" gravcomp="1"><joint name="peg" axis="0 0 1" type="slide"
stiffness="150" damping="1"/><geom name="peg" type="cylinder" size=".005 .04" mass=".02"/></body>
<body name="hand" pos="0 0 .05"><joint name="hand" type="slide" axis="0 0 1"/>
<inertial pos="0 0 0" mass=".2" diaginertia="1e-4 1e-4 1e-4"/>
<body name="left" pos="-.05 0 0" quat=".7071068 0 .7071068 0">
<joint name="left" type="slide" axis="0 0 1" damping="10"/></body>
<body name="right" pos=".05 0 0" quat=".7071068 0 -.7071068 0">
<joint name="right" type="slide" axis="0 0 1" damping="10"/></body></body></worldbody>
<actuator><position joint="hand" kp="2000" kv="40"/><motor joint="left"/><motor joint="right"/>
</actuator></mujoco>"""
spec = mujoco.MjSpec.from_string(HAND)
for side in ("left", "right"):
    finger = mujoco.MjSpec.from_file(str(PACK / "sensor.xml"))
    spec.body(side).add_frame().attach_body(finger.body("sensor"), f"{side}_", "")
model = spec.compile()
data = mujoco.MjData(model)
sensor = wb.Sensor.load(PACK)  # loaded once: each finger has a touch of its own
skins = ("left_skin", "right_skin")
fingers = [wb.attach(model, data, skin, "peg", sensor, apply_force=True) for skin in skins]
try:
    scene = mujoco.Renderer(model, 360, 640)
except Exception as error:  # whatever OpenGL fails with where there is none
    scene = None
    print(f"the video has no picture of the scene: {error}")

VIDEO.parent.mkdir(parents=True, exist_ok=True)
size = (640, 240 if scene is None else 600)
video = cv2.VideoWriter(str(VIDEO), cv2.VideoWriter.fourcc(*"mp4v"), 25.0, size)
risen_mm = {}
for grip_N in (0.5, 2.5):
    mujoco.mj_resetData(model, data)
    for step in range(400):
        data.ctrl[:] = 1e-3 * PULLED_MM * np.clip((step - 100) / 250, 0.0, 1.0), grip_N, grip_N
        mujoco.mj_step(model, data)
        frames = [finger() if step % 10 == 0 else finger.feel() for finger in fingers]
        if step % 10:
            continue
        picture = np.hstack([frame.rgb[0, :, :, ::-1] for frame in frames])
        if scene is not None:
            scene.update_scene(data, "side")
            picture = np.vstack([scene.render()[:, :, ::-1], picture])
        told = [f"{f.force_N[0, 2]:.2f} N, {100 * f.slip[0]:.0f} % slips" for f in frames]
        picture = np.ascontiguousarray(picture)
        video.write(cv2.putText(picture, "   ".join(told), (10, 20), 0, 0.5, (255, 255, 255)))
    risen_mm[grip_N] = 1e3 * data.joint("peg").qpos[0]
    print(f"{grip_N} N: the peg rose by {risen_mm[grip_N]:.2f} mm of {PULLED_MM} mm;", *told)
video.release()
assert abs(risen_mm[0.5] - 2 * FRICTION * 0.5 / SPRING_N_MM) < 0.1, "Coulomb"
assert 4.0 < risen_mm[2.5] < PULLED_MM
