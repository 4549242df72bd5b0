"""Images do not depend on how many threads draw them."""

from __future__ import annotations

import os
import subprocess
import sys

SCRIPT = """
import hashlib, sys
import numpy as np
import taichi as ti
ti.init(arch=ti.cpu, cpu_max_num_threads=int(sys.argv[1]), default_fp=ti.f32, log_level=ti.ERROR)
from sim.optics.studio.render import Studio
from sim.optics.proof.specimen import dent, finger
from tests.synthetic_light import lit
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LightModel
from workbench.core.design.optics import Markers, Optics
mesh = finger(edge_mm=0.8)
light, table = lit(mesh, LightModel.HYBRID)
camera = Camera(width_px=160, height_px=120)
optics = Optics(camera=camera, light_model=LightModel.HYBRID, markers=Markers(visible=True))
moved = dent(mesh.outer, at_mm=(15.0, 0.0, 22.0), depth_mm=1.5, radius_mm=4.0)
linear = Studio(mesh, light, optics, table=table).linear(np.stack([moved, 0.5 * moved]))
print(hashlib.sha256(linear.tobytes()).hexdigest())
"""


def test_one_thread_and_four_give_the_same_bits() -> None:
    """The linear light of two frames has one digest."""
    digests = []
    for threads in (1, 4):
        done = subprocess.run(
            [sys.executable, "-c", SCRIPT, str(threads)],
            capture_output=True,
            text=True,
            check=True,
            env=os.environ | {"ENABLE_TAICHI_HEADER_PRINT": "0"},
        )
        digests.append(done.stdout.split()[-1])
    assert digests[0] == digests[1]
    assert len(digests[0]) == 64
