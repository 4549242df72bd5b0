"""What Mitsuba 3 showed of the scenes of `recorded_scenes`, shipped as figures with their scene.

Figures are means of squares of pixels with their standard errors, so that they are compared where
Mitsuba is not installed. To record anew, where the CAD kernel is and then where Mitsuba is:

    python -m workbench.proof.validation.optics.mitsuba_record write FOLDER
    python -m workbench.proof.validation.optics.mitsuba_tracer FOLDER/NUMBER SAMPLES BATCHES
    python -m workbench.proof.validation.optics.mitsuba_record keep FOLDER

The record holds scene.xml of each scene; its surfaces are what the families build, of which it
holds a digest and moments.
"""

from __future__ import annotations

import functools
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from workbench.core.base.errors import StoreError
from workbench.core.design.optics import Coating
from workbench.proof.validation.optics.recorded_scenes import (
    SCENES,
    RecordedScene,
    body_of,
    cells,
    displacement_mm,
    moments,
    scene_digest,
)

FILE = Path(__file__).with_name("mitsuba_record.npz")
AS_BUILT = 1e-4
"""Two builds of one body agree in single precision; another mesh of it has other faces."""
HINT = "record it anew: python -m workbench.proof.validation.optics.mitsuba_record"


@dataclass(frozen=True, kw_only=True, slots=True)
class Recorded:
    """Mitsuba's figures of one scene, radiance in air per unit of power [1/(mm2 sr)]."""

    mean: np.ndarray
    """Of skin through the wall, without mirror images: squares of the image, shape (6, 8, 3)."""
    error: np.ndarray
    """Their standard errors, shape (6, 8, 3)."""
    whole: np.ndarray
    """Of everything that a path tracer shows, shape (6, 8, 3)."""
    samples: int
    """Of each pixel."""
    version: str
    """Of Mitsuba."""


@functools.cache
def recorded(number: int) -> Recorded:
    """What is recorded of a scene by its number.

    Raises:
        StoreError: If nothing is, or of another scene than today's.
    """
    scene = SCENES[number]
    if not FILE.exists():
        raise StoreError(f"{FILE.name} is missing", hint=HINT)
    with np.load(FILE) as data:
        held = {name.split("|")[1]: data[name] for name in data.files if name[0] == str(number)}
    if not held or str(held["digest"]) != scene_digest(scene):
        raise StoreError(f"{FILE.name} holds another scene as {scene.name}: {HINT}", hint=HINT)
    if not np.allclose(held["moments"], moments(scene), rtol=AS_BUILT, atol=AS_BUILT):
        raise StoreError(f"{FILE.name} holds another body of {scene.name}: {HINT}", hint=HINT)
    return Recorded(
        mean=held["mean"].astype(np.float64),
        error=held["error"].astype(np.float64),
        whole=held["whole"].astype(np.float64),
        samples=int(held["samples"]),
        version=str(held["version"]),
    )


def figures(folder: Path) -> dict[str, np.ndarray]:
    """Of what the tracer left in a folder: mean, error, whole, version, and the scene's text."""
    with np.load(folder / "batches.npz") as data:
        batches = cells(data["batches"])
        whole, version = cells(data["whole"]), data["version"]
        samples = np.array(int(data["samples"]) * len(batches))
    return {
        "mean": batches.mean(axis=0).astype(np.float32),
        "error": (batches.std(axis=0, ddof=1) / np.sqrt(len(batches))).astype(np.float32),
        "whole": whole.astype(np.float32),
        "samples": samples,
        "version": version,
        "scene": np.array((folder / "scene.xml").read_text(encoding="utf-8")),
    }


def write_folder(scene: RecordedScene, folder: Path) -> None:
    """Everything that Mitsuba reads of a scene; the coating in its exact form."""
    from sim.optics.light.lights import place_leds
    from sim.optics.proof.mitsuba_scene import scene_files, write_scene

    optics, moved = scene.optics, displacement_mm(scene)
    files = scene_files(
        body_of(scene),
        place_leds(optics.ring),
        optics.camera,
        optics.transport,
        displacement_mm=moved if scene.dented else None,
    )
    files["scene.xml"] = _as_ours(files["scene.xml"], scene.coating)
    files["index.txt"] = f"{optics.refractive_index:.9g}\n".encode()
    write_scene(folder, files)


def _as_ours(exported: bytes, coating: Coating) -> bytes:
    """An exported scene with our coating instead of the nearest of Mitsuba's own.

    Its LEDs let light through, as ours do.
    """
    root = ElementTree.fromstring(exported)
    for node in root.iter("bsdf"):
        if node.attrib["type"] == "principled":
            _change(node, "coated_ink")
            for name in ("albedo", "specular", "roughness"):
                value = f"{getattr(coating, name):.9g}"
                ElementTree.SubElement(node, "float", {"name": name, "value": value})
    for shape in root.iter("shape"):
        if shape.attrib["type"] == "disk":
            _change(shape.find("bsdf"), "null")
    return ElementTree.tostring(root)


def _change(node: ElementTree.Element | None, kind: str) -> None:
    if node is None:
        raise ValueError("the exported scene has a light without a surface")
    node.attrib["type"] = kind
    for inner in list(node):
        node.remove(inner)


def keep(folder: Path) -> None:
    """Write the shipped file from folders that the tracer has been in."""
    arrays: dict[str, np.ndarray] = {}
    for number, scene in enumerate(SCENES):
        found = figures(folder / str(number))
        found |= {"digest": np.array(scene_digest(scene)), "moments": moments(scene)}
        arrays |= {f"{number}|{name}": array for name, array in found.items()}
    np.savez_compressed(FILE, allow_pickle=False, **arrays)


def main(words: list[str]) -> None:
    """`write FOLDER` or `keep FOLDER`."""
    from workbench.pipeline.devices import open_device

    open_device()
    step, folder = words[0], Path(words[1])
    if step == "keep":
        keep(folder)
        return
    for number, scene in enumerate(SCENES):
        write_folder(scene, folder / str(number))


if __name__ == "__main__":
    main(sys.argv[1:])
