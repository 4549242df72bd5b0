"""One scene as photons of the workbench and as Mitsuba 3 show it, in the same units.

To what the workbench draws, 1 / n^2 of it since Mitsuba counts radiance in air, come the mirror
images of skin (`sim.optics.proof.ghost`) and LEDs (`maps.pixel_glare`) in the cavity's wall: a path
tracer shows them, the product leaves them out of its images. Mitsuba renders in a process of its
own, which is this module's `main`, in its plain variant `scalar_rgb`, which needs no LLVM.
"""

from __future__ import annotations

import dataclasses
import functools
import importlib
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.base.errors import DeviceError
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedRing, LightModel
from workbench.core.design.optics import Coating, Optics
from workbench.core.result.light import LightField
from workbench.core.result.results import MembraneMesh

FINER = 6
"""Mirror images of LEDs are a pixel wide: they are averaged over this many rays squared."""
PHOTONS = 10_000_000
SAMPLES = {1.41: 1000, 1.0: 300}
"""Of a pixel in each half, by refractive index; lights are found by chance behind a wall."""
RING = LedRing(count=3, radius_mm=6.0, size_mm=6.0, height_mm=0.5, phase_deg=90.0)
COATING = Coating(albedo=0.6, specular=0.0)
CAMERA = Camera(width_px=64, height_px=48)
DENT = {"at_mm": (0.0, 14.0, 32.0), "depth_mm": 1.5, "radius_mm": 5.0}
MOVED_MM = 0.1
REMEDY = 'pip install "sensor-workbench[mitsuba]"'


@dataclass(frozen=True, kw_only=True, slots=True)
class Case:
    """One scene."""

    index: float
    dented: bool

    @property
    def name(self) -> str:
        """For rows, for example `n = 1.41, dented`."""
        return f"n = {self.index:g}, {'dented' if self.dented else 'at rest'}"


CASES = tuple(Case(index=index, dented=dented) for index in (1.41, 1.0) for dented in (False, True))


@dataclass(frozen=True, kw_only=True, slots=True)
class Witness:
    """Images of one scene in Mitsuba's units, each (H, W, 3)."""

    mitsuba: np.ndarray
    error: np.ndarray
    """Standard error of each of Mitsuba's pixels."""
    traced: np.ndarray
    """Photons and mirror images."""
    product: np.ndarray
    """Photons alone: what the workbench shows."""
    direct: np.ndarray
    """The null: direct light alone, drawn by the workbench."""
    moved: np.ndarray
    """Pixels that see the dent, (H, W), bool."""


@functools.cache
def body() -> MembraneMesh:
    """The finger at edges of 1 mm, as both programs see it."""
    from sim.optics.proof.specimen import finger

    return finger(edge_mm=1.0)


def displacement_mm(case: Case) -> np.ndarray:
    """Of the seen skin's vertices [mm], shape (V, 3)."""
    from sim.optics.proof.specimen import dent

    skin = body().seen
    return dent(skin, **DENT) if case.dented else np.zeros_like(skin.points_mm, dtype=np.float32)


def witness(case: Case, *, photons: int = PHOTONS, samples: int | None = None) -> Witness:
    """Both programs' images of one scene.

    Raises:
        DeviceError: If Mitsuba cannot render.
    """
    mitsuba, error = rendered(case, samples or SAMPLES[case.index])
    optics = Optics(
        camera=CAMERA,
        ring=RING,
        coating=COATING,
        refractive_index=case.index,
        light_model=LightModel("photons"),
    )
    product, mirrored, moved = _traced(case, optics, photons)
    return Witness(
        mitsuba=mitsuba,
        error=error,
        traced=product + mirrored,
        product=product,
        direct=_direct(case, optics) / case.index**2,
        moved=moved,
    )


def _traced(case: Case, optics: Optics, photons: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What photons show and mirror images add, (H, W, 3), and the pixels that see the dent."""
    from sim.optics.field.bake import bake_light
    from sim.optics.proof.ghost import mirrored_radiance
    from sim.optics.studio.render import Studio

    mesh, moved = body(), displacement_mm(case)
    radiance = _radiance(case, optics, photons)
    light = bake_light(mesh, RING, model=LightModel("photons"))
    studio = Studio(mesh, light, optics, radiance=radiance)
    image = studio.linear(moved[None], radiance=radiance[None])[0] / case.index**2
    skin = dataclasses.replace(mesh.seen, points_mm=mesh.seen.points_mm + moved)
    pressed = dataclasses.replace(mesh, outer=skin)
    mirrored = mirrored_radiance(pressed, CAMERA, case.index, radiance) / case.index**2
    marked = np.repeat((np.linalg.norm(moved, axis=1) > MOVED_MM)[:, None], 3, axis=1)
    shown = studio.linear(moved[None], radiance=marked[None].astype(np.float32))[0]
    return image, mirrored + _glare(mesh, light, case.index), shown[:, :, 0] > 0.0


def _radiance(case: Case, optics: Optics, photons: int) -> np.ndarray:
    """Toward the camera at the seen skin's vertices, shape (V, 3)."""
    from sim.optics.light.lights import place_leds
    from sim.optics.transport.paths import Photons
    from sim.optics.transport.radiance import trace_radiance

    transport, leds = optics.transport, place_leds(RING)
    if transport is None:
        raise ValueError("photons trace light")
    found = trace_radiance(
        body(),
        leds,
        CAMERA,
        transport,
        Photons(count=photons, seed=transport.baking.seed),
        displacement_mm=displacement_mm(case) if case.dented else None,
    )
    return found.radiance * (len(leds.rgb) / found.photons)


def _glare(mesh: MembraneMesh, light: LightField, index: float) -> np.ndarray:
    """Mirror images of the LEDs in air, shape (H, W, 3)."""
    from sim.optics.camera.camera import refracted_rays
    from sim.optics.maps.pixel_glare import glare_radiance

    if index == 1.0:
        return np.zeros((CAMERA.height_px, CAMERA.width_px, 3))
    fine = dataclasses.replace(
        CAMERA, width_px=FINER * CAMERA.width_px, height_px=FINER * CAMERA.height_px
    )
    rays = refracted_rays(fine, mesh.cavity, index)
    shining = glare_radiance(fine, rays, mesh.cavity, light, index)
    blocks = shining.reshape(CAMERA.height_px, FINER, CAMERA.width_px, FINER, 3)
    return blocks.mean(axis=(1, 3))


def _direct(case: Case, optics: Optics) -> np.ndarray:
    from sim.optics.field.bake import bake_light
    from sim.optics.studio.render import Studio

    light = bake_light(body(), RING, model=LightModel("direct"))
    plain = dataclasses.replace(optics, light_model=LightModel("direct"))
    return Studio(body(), light, plain).linear(displacement_mm(case)[None])[0].astype(np.float64)


def rendered(case: Case, samples: int) -> tuple[np.ndarray, np.ndarray]:
    """Mitsuba's image and the standard error of its pixels, (H, W, 3) each.

    Raises:
        DeviceError: If it fails.
    """
    from sim.optics.light.lights import place_leds
    from sim.optics.proof.mitsuba_scene import scene_files, write_scene
    from workbench.core.design.lighting import Baking
    from workbench.core.design.optics import Transport

    transport = Transport(coating=COATING, refractive_index=case.index, baking=Baking())
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        moved = displacement_mm(case) if case.dented else None
        leds = place_leds(RING)
        files = scene_files(body(), leds, CAMERA, transport, displacement_mm=moved)
        write_scene(folder, files)
        halves = [render(folder, samples=samples, seed=seed) for seed in (1, 2)]
    return (halves[0] + halves[1]) / 2.0, np.abs(halves[0] - halves[1]) / 2.0


def render(folder: Path, *, samples: int, seed: int) -> np.ndarray:
    """Linear RGB (H, W, 3) of the scene in a folder, by Mitsuba in a process of its own.

    Raises:
        DeviceError: With the last line that Mitsuba said.
    """
    target = folder / f"image_{seed}.npy"
    words = [str(folder / "scene.xml"), str(samples), str(seed), str(target)]
    done = subprocess.run(
        [sys.executable, "-m", __name__, *words], capture_output=True, text=True, check=False
    )
    if done.returncode != 0 or not target.exists():
        said = (done.stderr.strip() or "nothing").splitlines()[-1]
        raise DeviceError(f"Mitsuba stopped with {done.returncode}: {said}", hint=REMEDY)
    return np.load(target).astype(np.float64)


def main(words: list[str]) -> None:
    """Render SCENE with SAMPLES and SEED to OUT: the process that `render` starts."""
    scene, samples, seed, target = words
    mitsuba: Any = importlib.import_module("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    image = mitsuba.render(mitsuba.load_file(scene), spp=int(samples), seed=int(seed))
    np.save(target, np.array(image)[:, :, :3])


if __name__ == "__main__":
    main(sys.argv[1:])
