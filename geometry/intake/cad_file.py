"""CAD files as triangles, read in a process that may die: see `geometry.intake.cad_child`.

A damaged STEP file can end the CAD kernel with a signal, keep it busy for ever, or have it ask for
all memory. None of that may reach whoever reads: the child's end becomes a message.
"""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.imported import BodyFile

LIMIT_S, LIMIT_S_PER_MB = 7.0, 10.0
"""Time of the processor that a file may take to read: a small one that keeps the kernel busy is
refused within 10 s, and a sound one of 10 MB takes a tenth of its share."""
WAITS = 10.0
"""Times of that by the clock, for Windows: more than the signals elsewhere leave a child."""
POLL_S = 0.1
TOO_LONG = (-27, -14)
"""Status of a child that SIGPROF or SIGALRM ended, on Linux and macOS."""
RENEW = "export the body again as STEP AP203, AP214 or AP242, or as STL"


@dataclass(frozen=True, kw_only=True, slots=True)
class CadTriangles:
    """What a CAD file holds, as triangles face by face in mm."""

    points_mm: np.ndarray
    """Vertices, shape (N, 3), float64; each face has its own."""
    faces: np.ndarray
    """Triangles, shape (M, 3), counter-clockwise from outside."""
    patch: np.ndarray
    """Face of the file of each triangle, shape (M,), int32."""
    solids_mm3: tuple[float, ...]
    """Volume of each solid; empty where the file holds loose faces."""
    sound: bool
    """Whether it is one solid that the kernel calls valid."""
    notes: tuple[str, ...]
    """What the kernel repaired."""


def read_cad(file: BodyFile, monitor: Monitor = silent) -> CadTriangles:
    """The triangles of a STEP file.

    Raises:
        DesignError: If the kernel cannot read it, died of it, or took too long; naming the file.
        Cancelled: If the monitor raised it.
    """
    limit_s = LIMIT_S + LIMIT_S_PER_MB * len(file.data) / 1e6
    with tempfile.TemporaryDirectory() as folder:
        source, out = Path(folder) / "body.step", Path(folder) / "triangles.npz"
        source.write_bytes(file.data.tobytes())
        code = _ended(source, out, limit_s, monitor)
        if code != 0:
            raise _died(file.name, code, limit_s)
        with np.load(out) as found:
            said = json.loads(str(found["said"]))
            arrays = {name: found[name] for name in found.files if name != "said"}
    if "reason" in said:
        why = f": {said['reason']}" if said["reason"] else ""
        raise DesignError(
            f"{file.name} is not a STEP file that the CAD kernel can read{why}", hint=RENEW
        )
    return CadTriangles(
        points_mm=arrays["points"],
        faces=arrays["faces"],
        patch=arrays["patch"],
        solids_mm3=tuple(said["solids_mm3"]),
        sound=said["sound"],
        notes=tuple(said["notes"]),
    )


def _ended(source: Path, out: Path, limit_s: float, monitor: Monitor) -> int:
    """Exit status of the child; it is killed when the monitor raises."""
    root = str(Path(__file__).parents[2])
    paths = os.pathsep.join(filter(None, (root, os.environ.get("PYTHONPATH", ""))))
    # -P: a file of the folder that the designer stands in is not a module of ours.
    command = [sys.executable, "-P", "-m", "geometry.intake.cad_child", source, out, str(limit_s)]
    # A subprocess and not one of multiprocessing: workers are daemons, which may not have those.
    until = time.monotonic() + WAITS * limit_s
    with subprocess.Popen(
        [str(word) for word in command],
        env={**os.environ, "PYTHONPATH": paths},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    ) as child:
        try:
            while True:
                monitor(0.0, f"reading {source.suffix[1:].upper()}")
                with contextlib.suppress(subprocess.TimeoutExpired):
                    return child.wait(POLL_S)
                if time.monotonic() > until:
                    return TOO_LONG[1]
        finally:
            child.kill()


def _died(name: str, code: int, limit_s: float) -> DesignError:
    if code in TOO_LONG:
        why = f"it takes the CAD kernel more than {limit_s:.0f} s"
    else:
        how = f"signal {-code}" if code < 0 else f"exit status {code}"
        why = f"the CAD kernel ended while reading it ({how})"
    return DesignError(
        f"{name} cannot be read: {why}; the file is damaged or incomplete", hint=RENEW
    )
