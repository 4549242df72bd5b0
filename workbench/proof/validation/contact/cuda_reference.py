"""Forces of a CUDA run beside those of the CPU; a shipped file stands in where there is no CUDA.

`python -m workbench.proof.validation.contact.cuda_reference` writes the file on a machine with
CUDA: the forces of `repeat.forces` in float64, the name of the device and the date.
"""

from __future__ import annotations

import datetime
import json
import subprocess
from pathlib import Path

import numpy as np

from workbench.core.base.errors import DeviceError, StoreError
from workbench.pipeline.devices import VARIABLE, cuda_count
from workbench.proof.validation.contact import repeat

FILE = Path(__file__).with_name("cuda_reference.json")
FORCES = ("finger_sheared_N", "block_N")


def how() -> str:
    """What is compared with what on this machine, for the case of the row."""
    if cuda_count():
        return "CPU against CUDA, both on this machine"
    if not FILE.exists():
        return "CPU against CUDA, of which this machine has none and no figures are shipped"
    shipped = json.loads(FILE.read_text(encoding="utf-8"))
    return f"CPU of this machine against shipped figures of {shipped['device']}, {shipped['date']}"


def difference() -> float:
    """Largest difference of a force over that press's largest force [1].

    Raises:
        StoreError: If there is neither CUDA nor a file.
    """
    cpu = repeat.elsewhere(**{VARIABLE: "cpu"})
    if cuda_count():
        cuda = repeat.elsewhere(**{VARIABLE: "cuda"})
    elif FILE.exists():
        shipped = json.loads(FILE.read_text(encoding="utf-8"))
        cuda = {name: np.array(shipped[name]) for name in FORCES}
    else:
        raise StoreError(
            f"{FILE.name} is missing and the driver reports 0 CUDA devices",
            hint="write it on a machine with CUDA: "
            "python -m workbench.proof.validation.contact.cuda_reference",
        )
    return max(
        float(np.abs(cpu[name] - cuda[name]).max() / np.abs(cuda[name]).max()) for name in FORCES
    )


def write() -> None:
    """Write the file from a run on this machine's CUDA device.

    Raises:
        DeviceError: If there is none.
    """
    if not cuda_count():
        raise DeviceError(
            "the driver reports 0 CUDA devices", hint="run this on a machine with CUDA"
        )
    cuda = repeat.elsewhere(**{VARIABLE: "cuda"})
    name = subprocess.run(
        ["nvidia-smi", "--query-gpu=name", "--format=csv,noheader"],
        capture_output=True,
        text=True,
        check=False,
    ).stdout.splitlines()
    record = {
        "device": name[0] if name else "a CUDA device",
        "date": datetime.date.today().isoformat(),
        "made": "python -m workbench.proof.validation.contact.cuda_reference",
        **{force: cuda[force].tolist() for force in FORCES},
    }
    FILE.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    write()
