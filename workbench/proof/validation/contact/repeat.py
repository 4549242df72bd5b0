"""The same press in processes of their own, with other thread counts or on another device.

A process opens its device once, so a second device or thread count needs a second process. Run as
`python -m workbench.proof.validation.contact.repeat FILE` it presses `specimens` and writes what
came out.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from workbench.core.base.errors import LaneError
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.pipeline.devices import VARIABLE, open_device

THREADS = "TI_CPU_MAX_NUM_THREADS"
"""Taichi's own variable for the threads of its CPU device."""
TOLERANCE = 2e-4
"""Devices may stop at different looks: at the default of 1e-3 that alone is some 0.1 %."""
TIMEOUT_S = 600.0


def forces() -> dict[str, np.ndarray]:
    """Reaction [N] by press, (K, 3), and the displacement [mm] of one, on this process's device."""
    open_device()
    from sim.contact.press import press_membrane
    from sim.contact.studies import finger, specimens
    from workbench.core.design.design import Elastomer

    sheared = finger.press_finger(
        finger.at_45_degrees(frames=2, shear_mm=(0.0, 0.5)),
        settings=ContactSettings(active_radius_mm=9.0, tolerance=TOLERANCE),
    )
    mesh, points = specimens.flat_block(width_mm=12.0, height_mm=4.0, grid_mm=0.5)
    block = press_membrane(
        mesh,
        points,
        Elastomer(friction=0.0),
        PressCase(
            indenter=Indenter(size_mm=8.0),
            press=Press(target_mm=(0.0, 0.0, 4.0), depth_mm=0.5, frames=1),
            settings=ContactSettings(active_radius_mm=12.0, tolerance=TOLERANCE),
        ),
    )
    return {
        "finger_sheared_N": sheared.reaction_N,
        "block_N": block.reaction_N,
        "displacement_mm": sheared.displacement_mm,
    }


def elsewhere(**variables: str) -> dict[str, np.ndarray]:
    """The same from a new process with some environment variables set.

    Raises:
        LaneError: If that process fails; its last words are in the hint.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "forces.npz"
        # The caller may have found this package on sys.path only.
        here = str(Path(__file__).parents[4])
        paths = os.pathsep.join(filter(None, (here, os.environ.get("PYTHONPATH", ""))))
        done = subprocess.run(
            [sys.executable, "-m", "workbench.proof.validation.contact.repeat", str(path)],
            env={**os.environ, **variables, "PYTHONPATH": paths},
            capture_output=True,
            text=True,
            timeout=TIMEOUT_S,
            check=False,
        )
        if done.returncode or not path.exists():
            raise LaneError(
                f"a press in a process of its own ended with {done.returncode}",
                hint=done.stderr.strip()[-400:],
            )
        with np.load(path) as arrays:
            return dict(arrays)


def differing_bytes() -> float:
    """Bytes that differ between the results with 1 and with 2 CPU threads."""
    one, two = (elsewhere(**{VARIABLE: "cpu", THREADS: str(count)}) for count in (1, 2))
    return float(
        sum(np.count_nonzero(one[name].view(np.uint8) != two[name].view(np.uint8)) for name in one)
    )


if __name__ == "__main__":
    with open(sys.argv[1], "wb") as file:
        np.savez(file, allow_pickle=False, **forces())
