"""Options for pip that choose the build of PyTorch: the CPU's where no NVIDIA driver answers.

The build for GPUs is what PyPI has, several gigabytes with CUDA. Prints nothing where there is a
driver, where the reader has chosen an index already, or where PyTorch's own index does not answer
within `WAIT_S`: pip then takes what it finds. Never fails, never hangs.
"""

from __future__ import annotations

import os
import platform
import subprocess
import sys

CPU_INDEX = "https://download.pytorch.org/whl/cpu"
WAIT_S = 3.0
CHOSEN = ("PIP_INDEX_URL", "PIP_EXTRA_INDEX_URL")
PROBE = (
    "import sys, urllib.request as r; r.urlopen(sys.argv[1], timeout=float(sys.argv[2])).read(1)"
)


def has_nvidia_driver() -> bool:
    """Whether `nvidia-smi` lists a GPU."""
    return _ends_well(["nvidia-smi", "-L"])


def reachable(address: str) -> bool:
    """Whether an address answers in time; name look-ups have no time limit of their own."""
    return _ends_well([sys.executable, "-c", PROBE, f"{address}/torch/", str(WAIT_S)])


def options() -> str:
    """What pip is to be told, and on stderr why."""
    if platform.system() != "Linux":
        why, found = "other systems have the CPU build on PyPI", ""
    elif any(os.environ.get(name) for name in CHOSEN):
        why, found = "your own index of packages is used", ""
    elif has_nvidia_driver():
        why, found = "an NVIDIA driver answers: the build for GPUs", ""
    elif reachable(CPU_INDEX):
        why, found = "no NVIDIA driver answers: the build for processors", CPU_INDEX
    else:
        why, found = f"{CPU_INDEX} does not answer in {WAIT_S:g} s: what pip finds", ""
    print(f"PyTorch: {why}", file=sys.stderr)
    return f"--extra-index-url {found}" if found else ""


def _ends_well(command: list[str]) -> bool:
    try:
        done = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=WAIT_S,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0


if __name__ == "__main__":
    print(options())
