"""Photon-traced images of the light scenes, recorded once, that light models are compared with.

Billions of photons take a GPU minutes and two CPU cores hours, so what they showed is shipped as
`photon_reference.npz`. Three steps write it anew, each where it can run:

    python -m workbench.proof.validation.optics.photon_reference STEP

with the steps `scenes FILE`, which needs the CAD kernel, `trace FILE OUT [PHOTONS [SCENE ...]]`,
which wants a GPU, and `images FILE OUT`, which draws into the shipped file what was traced. Each
scene keeps the digest of its body: of another one, nothing is compared.

Radiance at the vertices is traced in two halves with different photons, so that the score of one
half against the other is known: the ceiling of what any model can reach. The images are drawn by
the workbench's own rasteriser from those vertices; `validate optics --reference mitsuba` is the
witness from outside.
"""

from __future__ import annotations

import dataclasses
import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from sim.optics.studio.render import Studio
from workbench.core.base.codec import pack, unpack
from workbench.core.design.lighting import LightModel
from workbench.core.design.optics import Composition, Optics
from workbench.core.result.results import MembraneMesh
from workbench.proof.validation.optics.light_images import dent_box, flat_exposure, score
from workbench.proof.validation.optics.light_scenes import (
    SCENES,
    LightScene,
    body_digest,
    mesh_of,
    optics_of,
    skins_of,
)

FILE = Path(__file__).with_name("photon_reference.npz")
PHOTONS = 1_000_000_000
"""Of each half of each frame."""
BATCH = 200_000_000


def frames_of(scene: LightScene, mesh: MembraneMesh) -> dict[str, np.ndarray]:
    """Displacements [mm] (V, 3) of a scene's frames by name, the undeformed one first."""
    from sim.optics.raster.dents import FINGER_DENTS, PAW_DENTS, TRUNK_DENTS, dented

    dents = {"finger": FINGER_DENTS, "trunk": TRUNK_DENTS, "paw": PAW_DENTS}[scene.body]
    found = {"flat": np.zeros_like(mesh.outer.points_mm, dtype=np.float32)}
    found |= {dent.name: dented(mesh.outer, dent) for dent in dents}
    if scene.body == "finger":
        found["contact"] = pressed(mesh)
    return found


def pressed(mesh: MembraneMesh) -> np.ndarray:
    """The finger's skin under the default ball at 1 mm, by the contact stage, (V, 3) [mm]."""
    from workbench.core.base.monitor import silent
    from workbench.core.design.design import Elastomer
    from workbench.core.press.indenter import Indenter
    from workbench.core.press.press import ContactSettings, Press
    from workbench.pipeline.stages.press import PressInputs, press
    from workbench.proof.specimens import finger_points

    path = Press(target_mm=(0.0, 10.0, 35.0), depth_mm=1.0, frames=1)
    settings = ContactSettings()
    contact = press(
        PressInputs(
            mesh=mesh,
            points=finger_points(),
            material=Elastomer(),
            indenter=Indenter(),
            path=path,
            settings=settings,
        ),
        monitor=silent,
    )
    return np.asarray(contact.displacement_mm[-1])


def write_scenes(file: Path) -> None:
    """Everything that tracing needs of every scene, without a CAD kernel."""
    arrays: dict[str, np.ndarray] = {}
    trees: dict[str, Any] = {}
    for scene in SCENES:
        mesh = skins_of(mesh_of(scene.body))
        optics = optics_of(scene, LightModel("photons"))
        found, tree = pack((mesh, optics, frames_of(scene, mesh)))
        trees[scene.name] = tree
        arrays |= {f"{scene.name}|{name}": array for name, array in found.items()}
    arrays["trees"] = np.array([json.dumps(trees)])
    np.savez_compressed(file, allow_pickle=False, **arrays)


def read_scenes(file: Path) -> dict[str, Any]:
    """Mesh, optics and frames of each scene by its name."""
    with np.load(file) as data:
        trees = json.loads(str(data["trees"][0]))
        arrays = {name: data[name] for name in data.files if name != "trees"}
    found = {}
    for scene, tree in trees.items():
        head = f"{scene}|"
        own = {n.removeprefix(head): a for n, a in arrays.items() if n.startswith(head)}
        found[scene] = unpack(own, tree)
    return found


def trace(file: Path, out: Path, photons: int, names: list[str]) -> None:
    """Trace the halves of every frame of the named scenes, all without names.

    Frames whose file is there already are kept.
    """
    from sim.optics.light.lights import place_leds
    from sim.optics.transport.paths import Photons
    from sim.optics.transport.radiance import trace_radiance
    from workbench.pipeline.devices import open_device

    device = open_device()
    out.mkdir(parents=True, exist_ok=True)
    for name, (mesh, optics, frames) in read_scenes(file).items():
        if names and not any(name.startswith(wanted) for wanted in names):
            continue
        leds, seed = place_leds(optics.ring, optics.lamps), optics.transport.baking.seed
        for frame, displacement in frames.items():
            target = out / f"{name.replace(' ', '_')}_{frame}.npz"
            if target.exists():
                continue
            start = time.perf_counter()
            halves = []
            for half in range(2):
                found = trace_radiance(
                    mesh,
                    leds,
                    optics.camera,
                    optics.transport,
                    Photons(count=photons, seed=seed, first=half * photons),
                    displacement_mm=displacement,
                )
                halves.append(found.radiance * (len(leds.rgb) / found.photons))
            seconds = time.perf_counter() - start
            np.savez_compressed(
                target,
                halves=np.stack(halves).astype(np.float32),
                photons=photons,
                device=device,
                seconds=seconds,
                balance=json.dumps(found.balance),
            )
            print(f"{target.name}: 2 x {photons:.3g} photons in {seconds:.1f} s", flush=True)


def write_images(scenes: Path, traced: Path, file: Path) -> None:
    """Draw what `photon_reference trace` left and write the shipped file.

    Args:
        scenes: Written by its step `scenes`.
        traced: Folder of its step `trace`; of scenes that are not there the file keeps what it has.
        file: Target.
    """
    from workbench.pipeline.devices import open_device

    open_device()
    arrays = dict(np.load(file)) if file.exists() else {}
    for scene, (mesh, optics, frames) in read_scenes(scenes).items():
        path = traced / f"{scene.replace(' ', '_')}_flat.npz"
        if path.exists():
            kept = {name: a for name, a in arrays.items() if not name.startswith(f"{scene}|")}
            arrays = kept | _scene_arrays(scene, mesh, optics, frames, traced)
            arrays["device"] = np.array(str(np.load(path)["device"]))
    np.savez_compressed(file, allow_pickle=False, **arrays)


def _scene_arrays(
    scene: str,
    mesh: MembraneMesh,
    optics: Optics,
    frames: dict[str, np.ndarray],
    traced: Path,
) -> dict[str, np.ndarray]:
    from workbench.core.base.monitor import silent
    from workbench.pipeline.stages.bake import BakeInputs, bake

    light = bake(
        BakeInputs(mesh=mesh, ring=optics.ring, lamps=optics.lamps, model=LightModel("photons")),
        monitor=silent,
    )
    data = {name: np.load(traced / f"{scene.replace(' ', '_')}_{name}.npz") for name in frames}
    rest = data["flat"]["halves"].mean(axis=0)
    optics = dataclasses.replace(optics, composition=Composition.ABSOLUTE)
    studio = Studio(mesh, light, optics, radiance=rest)
    flat = studio.linear(np.zeros((1, *rest.shape), dtype=np.float32), radiance=rest[None])[0]
    exposure = flat_exposure(flat)
    body = scene.split(maxsplit=1)[0]
    found: dict[str, np.ndarray] = {f"{scene}|body": np.array(body_digest(body))}
    for name, displacement in frames.items():
        halves = data[name]["halves"]
        drawn = [
            Studio(mesh, light, optics, radiance=half) if name == "flat" else studio
            for half in halves
        ]
        shown = [
            exposure * studio_of.linear(displacement[None], radiance=half[None])[0]
            for studio_of, half in zip(drawn, halves, strict=True)
        ]
        image = (shown[0] + shown[1]) / 2.0
        whole = (slice(0, image.shape[0]), slice(0, image.shape[1]))
        box = whole if name == "flat" else dent_box(studio, displacement, image.shape[:2])
        ceiling = score(shown[0], shown[1], box)
        corners = (box[0].start, box[0].stop, box[1].start, box[1].stop)
        numbers = (*corners, *image.shape[:2], ceiling.ssim_1, ceiling.psnr_dB)
        photons = 2.0 * float(data[name]["photons"])
        found[f"{scene}|{name}|numbers"] = np.array([*numbers, photons, exposure])
        found[f"{scene}|{name}|light"] = image[box].astype(np.float16)
    return found


def main(words: list[str]) -> None:
    """Run one of the steps."""
    step, *rest = words
    if step == "scenes":
        from workbench.pipeline.devices import open_device

        open_device()
        write_scenes(Path(rest[0]))
    elif step == "trace":
        photons = int(float(rest[2])) if len(rest) > 2 else PHOTONS
        trace(Path(rest[0]), Path(rest[1]), photons, rest[3:])
    else:
        write_images(Path(rest[0]), Path(rest[1]), FILE)


if __name__ == "__main__":
    main(sys.argv[1:])
