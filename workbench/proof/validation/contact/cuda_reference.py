"""Forces of a CUDA run beside those of the CPU; a shipped record stands in where there is no CUDA.

`python -m workbench.proof.validation.contact.cuda_reference` makes the record on a machine with
CUDA: the forces of `repeat.forces` in float64, the name of the device and the date.
"""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.base.errors import DeviceError
from workbench.pipeline.devices import VARIABLE, cuda_count
from workbench.proof.validation.contact import repeat
from workbench.system.record import Record

RECORD = Record(
    path=Path(__file__).with_name("cuda_reference.json"),
    command="python -m workbench.proof.validation.contact.cuda_reference",
    sources=(
        "workbench.proof.validation.contact.repeat",
        "workbench.core.objects.kinds.sphere",
    ),
    apart=(
        "workbench.core.design.camera",
        "workbench.core.design.lighting",
        "workbench.core.design.optics",
        "workbench.core.design.photo",
        "workbench.core.press.learned",
    ),
)
FORCES = ("finger_sheared_N", "block_N")


def used() -> Record | None:
    """The record where it stands in for a device, else None."""
    return None if cuda_count() else RECORD


def how() -> str:
    """What is compared with what on this machine, for the case of the row."""
    if cuda_count():
        return "CPU against CUDA, both on this machine"
    if not RECORD.path.exists():
        return "CPU against CUDA, of which this machine has none and no figures are shipped"
    shipped = RECORD.figures()
    return f"CPU of this machine against shipped figures of {shipped['device']}, {shipped['made']}"


def difference() -> float:
    """Largest difference of a force over that press's largest force [1].

    Raises:
        StoreError: If there is neither CUDA nor a record.
    """
    cpu = repeat.elsewhere(**{VARIABLE: "cpu"})
    if cuda_count():
        cuda = repeat.elsewhere(**{VARIABLE: "cuda"})
    else:
        shipped = RECORD.figures()
        cuda = {name: np.array(shipped[name]) for name in FORCES}
    return max(
        float(np.abs(cpu[name] - cuda[name]).max() / np.abs(cuda[name]).max()) for name in FORCES
    )


def write() -> None:
    """Make the record from a run on this machine's CUDA device.

    Raises:
        DeviceError: If there is none.
    """
    if not cuda_count():
        raise DeviceError(
            "the driver reports 0 CUDA devices", hint="run this on a machine with CUDA"
        )
    RECORD.make(_figures)


def _figures() -> dict[str, Any]:
    cuda = repeat.elsewhere(**{VARIABLE: "cuda"})
    name = subprocess.run(
        ["nvidia-smi", "--query-gpu=name", "--format=csv,noheader"],
        capture_output=True,
        text=True,
        check=False,
    ).stdout.splitlines()
    device = name[0] if name else "a CUDA device"
    return {"device": device, **{force: cuda[force].tolist() for force in FORCES}}


if __name__ == "__main__":
    write()
