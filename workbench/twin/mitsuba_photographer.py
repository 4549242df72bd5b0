"""Photographs of a twin by Mitsuba 3, in a process of its own that can be ended.

Another coating, mirror images in the wall, and a tracer that shares no line with the product's:
what of a reader's quality rests on the product's own light shows in these. Lens, image sensor and
noise are those of `photographer`, and so are dots on the skin, which dim what Mitsuba saw.
"""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from workbench.core.base.errors import DeviceError
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.optics import Optics
from workbench.core.result.results import MembraneMesh
from workbench.twin.mitsuba_scene import SEEN, Pose, check_lens, write_scene
from workbench.twin.photographer import Lit, Photographer

if TYPE_CHECKING:
    # It needs the device that a photographer opens.
    from sim.optics.studio.render import Studio

MODULE = "workbench.twin.mitsuba_tracer"
REMEDY = (
    'pip install "sensor-workbench[mitsuba]", and LLVM 16 or newer, whose library '
    "DRJIT_LIBLLVM_PATH names where it is not found; or --light photons"
)
LOOK_S = 0.2
"""How often somebody is asked whether to go on [s]."""
DARK = 1e-12
"""Radiance below which dots dim nothing."""


class MitsubaPhotographer(Photographer):
    """Light and camera of one twin, seen by Mitsuba."""

    def _lit(self, moved: np.ndarray | None, number: int, monitor: Monitor) -> Lit:
        pose = Pose(displacement_mm=moved, photons=self.photons, seed=self._seed_of(number))
        return seen_by_mitsuba(self.mesh, self.optics, pose, monitor)

    def _shown(self, studio: Studio, lit: Lit, moved: np.ndarray | None) -> np.ndarray:
        assert lit.image is not None
        if studio is self.plain:
            return lit.image
        dotted = super()._shown(studio, lit, moved)
        bare = super()._shown(self.plain, lit, moved)
        kept = np.divide(dotted, bare, out=np.ones_like(bare), where=bare > DARK)
        return lit.image * np.clip(kept, 0.0, 1.0)


def check_mitsuba(optics: Optics) -> None:
    """Whether Mitsuba can photograph a sensor here, in seconds.

    Raises:
        DesignError: If it has no like of the camera's lens.
        DeviceError: If it is not installed or cannot compile.
    """
    check_lens(optics.camera)
    if importlib.util.find_spec("mitsuba") is None:
        raise DeviceError("Mitsuba is not installed", hint=REMEDY, at="--light")
    with tempfile.TemporaryDirectory() as name:
        _run([], Path(name), silent)


def seen_by_mitsuba(mesh: MembraneMesh, optics: Optics, pose: Pose, monitor: Monitor) -> Lit:
    """A pose in Mitsuba's light.

    Args:
        mesh: The skins.
        optics: LEDs, camera, coating, index.
        pose: Of the skin, with its photons.
        monitor: Progress and cancellation.

    Raises:
        DeviceError: If Mitsuba stops.
        Cancelled: If the monitor says so; its process is ended.
    """
    from sim.optics.raster.vertex_light import ambient_radiance

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_scene(folder, mesh, optics, pose, ambient_radiance(optics, mesh.seen))
        _run([str(folder)], folder, monitor)
        with np.load(folder / SEEN) as seen:
            radiance, image = (seen[key].astype(np.float32) for key in ("radiance", "image"))
    return Lit(radiance=radiance, image=image)


def _run(words: Sequence[str], folder: Path, monitor: Monitor) -> None:
    """Run the tracer and tell how far it is; what it says goes to files in a folder."""
    told, complaints = folder / "told.txt", folder / "complaints.txt"
    with told.open("wb") as out, complaints.open("wb") as err:
        child = subprocess.Popen([sys.executable, "-m", MODULE, *words], stdout=out, stderr=err)
        try:
            while child.poll() is None:
                monitor(_fraction(told), "light by Mitsuba")
                time.sleep(LOOK_S)
        finally:
            child.kill()
            child.wait()
    if child.returncode != 0:
        said = complaints.read_text(encoding="utf-8", errors="replace").strip().splitlines()
        why = next((line for line in said if "LLVM" in line), said[-1] if said else "nothing")
        raise DeviceError(
            f"Mitsuba stopped with {child.returncode}: {why}", hint=REMEDY, at="--light"
        )


def _fraction(told: Path) -> float:
    lines = told.read_text(encoding="utf-8").split()
    return float(lines[-1]) if lines else 0.0
