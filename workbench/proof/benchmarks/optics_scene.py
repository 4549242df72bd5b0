"""Image rates on a machine without CAD kernel and ray caster, from a scene prepared elsewhere.

    python -m workbench.proof.benchmarks.optics_scene save FOLDER
    python -m workbench.proof.benchmarks.optics_scene run FOLDER

`save` bakes a finger's light by photons, casts its cameras' rays and writes one file per
size of image; `run` needs numpy, taichi and the open device only, and prints a line of JSON per
file. Arrays are stored as differences of neighbours, byte by byte: maps of rays are smooth, and a
file of 1280x960 pixels is then small enough to carry.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from workbench.pipeline.devices import open_device

WIDTHS_PX = (640, 1280)
FRAMES = 256
"""Frames of one measurement; several batches, so that their seams count."""
RUNS = 5
DISTINCT = 32
"""Dents in the file; a measurement repeats them."""


NOT_NEEDED = ("view.layer_weights", "backdrop.background")
"""Arrays that 8-bit images do without."""


def save(folder: Path) -> None:
    """Write the prepared scene of each image size, with dents and two images to compare with."""
    from workbench.core.design.lighting import LightModel
    from workbench.proof.benchmarks.optics import travelling_dent, video_mesh, video_studio

    open_device()
    skin = video_mesh().seen
    frames = travelling_dent(skin.points_mm, skin.normals, DISTINCT)
    for width_px in WIDTHS_PX:
        studio = video_studio(LightModel("hybrid"), width_px)
        arrays = studio.imager.state() | {"frames": frames, "images": studio.images(frames[:2])}
        for name in NOT_NEEDED:
            arrays[name] = np.zeros_like(arrays[name])
        packed = {name: packed_array(array) for name, array in arrays.items()}
        shapes = {f"shape.{name}": np.array(array.shape) for name, array in arrays.items()}
        kinds = {f"kind.{name}": np.array(array.dtype.str) for name, array in arrays.items()}
        folder.mkdir(parents=True, exist_ok=True)
        everything: dict[str, Any] = packed | shapes | kinds
        np.savez_compressed(folder / f"scene_{width_px}.npz", **everything)


def run(file: Path) -> dict[str, float | str]:
    """Measure one size; also the largest difference [grey] from the machine that saved."""
    from sim.optics.raster.imager import Imager

    device = open_device()
    with np.load(file) as stored:
        arrays = {
            name: unpacked_array(
                stored[name], tuple(stored[f"shape.{name}"]), str(stored[f"kind.{name}"])
            )
            for name in stored.files
            if not name.startswith(("shape.", "kind."))
        }
    frames = np.concatenate([arrays.pop("frames")] * (FRAMES // DISTINCT))
    reference = arrays.pop("images")
    imager = Imager.from_state(arrays)
    difference = np.abs(imager.images(frames[:2]).astype(int) - reference)
    imager.images(frames)
    times = []
    for _ in range(RUNS):
        begun = time.perf_counter()
        imager.images(frames)
        times.append(time.perf_counter() - begun)
    return {
        "name": "fps",
        "case": file.stem,
        "device": device,
        "fps": FRAMES / float(np.median(times)),
        "moved_vertices": float((np.abs(frames).max(axis=2) > 1e-3).sum(axis=1).mean()),
        "largest_grey_difference": int(difference.max()),
        "share_of_different_values": float((difference > 0).mean()),
    }


def packed_array(array: np.ndarray) -> np.ndarray:
    """Differences of neighbours as planes of bytes, for arrays of 4-byte numbers; else itself."""
    if array.dtype.itemsize != 4 or array.ndim == 0:
        return array
    columns = array.reshape(-1, array.shape[-1]).T if array.ndim > 1 else array[None]
    whole = np.ascontiguousarray(columns).view(np.uint32).ravel()
    steps = np.diff(whole, prepend=np.uint32(0))
    return np.ascontiguousarray(steps.view(np.uint8).reshape(-1, 4).T)


def unpacked_array(packed: np.ndarray, shape: tuple[int, ...], kind: str) -> np.ndarray:
    """What `packed_array` was given."""
    if np.dtype(kind).itemsize != 4 or not shape:
        return packed
    steps = np.ascontiguousarray(packed.T).view(np.uint32).ravel()
    whole = np.cumsum(steps, dtype=np.uint32).view(kind)
    if len(shape) == 1:
        return whole.reshape(shape)
    return np.ascontiguousarray(whole.reshape(shape[-1], -1).T).reshape(shape)


def main(arguments: list[str]) -> int:
    """Command line; 2 for arguments that are not understood."""
    if len(arguments) != 2 or arguments[0] not in ("save", "run"):
        print(__doc__, file=sys.stderr)
        return 2
    path = Path(arguments[1])
    if arguments[0] == "save":
        save(path)
        return 0
    for file in sorted(path.glob("scene_*.npz")):
        print(json.dumps(run(file)))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
