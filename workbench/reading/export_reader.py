"""A learned reader for other programs: TorchScript, and a short script that shows its use.

The network takes two photographs of its own size as grey levels and gives units: what
`Predictor` does around it is inside. It needs neither the design nor the workbench.
"""

from __future__ import annotations

import io
import warnings
from pathlib import Path

from sim.reading.network.reader_file import ReaderFile
from workbench.system.whole_files import write_atomically

NETWORK, SCRIPT = "reader.pt", "read.py"
_SCRIPT = '''\
"""Depth and force from photographs, a video or a camera: {design}.

python read.py IDLE PHOTO...   each photo against the one at rest
python read.py VIDEO           a file, or the number of a camera; the first frame is at rest

Needs torch, numpy and opencv. Arrays go to NAME_depth.npy, in mm; NaN sees no skin.
"""
import sys
from pathlib import Path

import cv2
import numpy as np
import torch

torch.set_grad_enabled(False)
network = torch.jit.load(Path(__file__).with_name("reader.pt")).eval()
COLUMNS, ROWS = {columns}, {rows}  # of the images that the network sees
CAMERA = ({width}, {height})  # width and height that depth is given in


def grey(image):  # an OpenCV image as the network wants it, shape (1, 3, ROWS, COLUMNS)
    how = cv2.INTER_AREA if image.shape[1] > COLUMNS else cv2.INTER_LINEAR
    rgb = np.ascontiguousarray(image[:, :, ::-1], np.float32)
    small = cv2.resize(rgb, (COLUMNS, ROWS), interpolation=how)
    return torch.from_numpy(small).permute(2, 0, 1)[None]


def read(idle, photo):  # depth [mm] in the camera's size, force on the membrane [N], its deviation
    depth, sees, force, sigma = network(grey(idle), grey(photo))
    wide = cv2.resize(depth[0].numpy(), CAMERA, interpolation=cv2.INTER_LINEAR)
    seen = cv2.resize(sees[0].float().numpy(), CAMERA, interpolation=cv2.INTER_LINEAR) > 0.5
    return np.where(seen, wide, np.nan), force[0].numpy(), float(sigma[0])


def frames(names):  # name and image of each frame, the one at rest first
    if len(names) > 1:
        yield from ((Path(name).stem, cv2.imread(name)) for name in names)
        return
    video, number = cv2.VideoCapture(int(names[0]) if names[0].isdigit() else names[0]), 0
    while (got := video.read())[0]:
        yield f"{{number:05d}}", got[1]
        number += 1


if __name__ == "__main__":
    images = frames(sys.argv[1:])
    _, idle = next(images)
    for name, photo in images:
        depth, force, sigma = read(idle, photo)
        told = f"{{np.nanmax(depth):.2f}} mm, force {{force.round(3)}} +- {{sigma:.2f}} N"
        print(f"{{name}}: {{told}}", flush=True)
        if len(sys.argv) > 2:
            np.save(f"{{name}}_depth.npy", depth.astype(np.float32))
'''


def export_reader(reader: ReaderFile, out: Path) -> tuple[Path, Path]:
    """Write both files.

    Args:
        reader: The reader.
        out: A folder that exists.

    Returns:
        Paths of the network and of the script.

    Raises:
        StoreError: If the disk is full or read-only.
    """
    import torch

    from sim.reading.network.standalone import standalone

    spec = reader.spec
    example = torch.full((1, 3, spec.rows, spec.columns), 100.0)
    buffer = io.BytesIO()
    with warnings.catch_warnings(), torch.inference_mode():
        # PyTorch would rather have another format, which older versions cannot read; and the size
        # of the images is fixed, as it says.
        warnings.simplefilter("ignore")
        traced = torch.jit.trace(standalone(reader), (example, example), check_trace=False)
        torch.jit.save(traced, buffer)
    width_px, height_px = reader.camera_px
    script = _SCRIPT.format(
        design=reader.design,
        columns=spec.columns,
        rows=spec.rows,
        width=width_px,
        height=height_px,
    )
    write_atomically(out / NETWORK, buffer.getvalue())
    write_atomically(out / SCRIPT, script.encode())
    return out / NETWORK, out / SCRIPT
