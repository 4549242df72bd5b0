"""The one place that opens a compute device.

Taichi fields and kernels belong to the thread that called `ti.init`, so a process opens its device
once, in the thread that will compute. CUDA is used where a driver answers, else the CPU; the
environment variable `WORKBENCH_DEVICE` (`cpu` or `cuda`) overrides the choice.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
import importlib
import io
import os
import threading
from typing import Any

from workbench.core.base.errors import DeviceError, shown
from workbench.core.base.monitor import Monitor
from workbench.pipeline.kernel_sources import remember_sources

VARIABLE = "WORKBENCH_DEVICE"
LOOK_S = 0.1
"""How often somebody is asked whether to go on while PyTorch loads [s]."""


def cuda_count() -> int:
    """CUDA devices that the driver reports; 0 without a driver. Imports nothing heavy."""
    try:
        driver = ctypes.CDLL("libcuda.so.1")
    except OSError:
        return 0
    count = ctypes.c_int(0)
    if driver.cuInit(0) != 0 or driver.cuDeviceGetCount(ctypes.byref(count)) != 0:
        return 0
    return count.value


def chosen_device() -> str:
    """`cuda` or `cpu`, as `open_device` will choose.

    Raises:
        DeviceError: If the environment asks for a device that is not there.
    """
    wanted = os.environ.get(VARIABLE, "auto")
    if wanted not in ("auto", "cpu", "cuda"):
        raise DeviceError(
            f"{VARIABLE} is {shown(wanted)}", hint="use cpu, cuda, or leave it unset", at="device"
        )
    count = cuda_count()
    if wanted == "cuda" and count == 0:
        raise DeviceError(
            f"{VARIABLE}=cuda, but the driver reports 0 CUDA devices",
            hint="unset it to compute on the CPU, or install the NVIDIA driver",
            at="device",
        )
    return "cuda" if count and wanted != "cpu" else "cpu"


@functools.cache
def open_device() -> str:
    """Initialise Taichi in this process and say on what: `cpu` or `cuda`.

    Raises:
        DeviceError: If the device is there but does not start.
    """
    name = chosen_device()
    os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
    import taichi as ti

    remember_sources()
    options: dict[str, Any] = {"default_fp": ti.f32, "offline_cache": True, "log_level": ti.ERROR}
    try:
        # Taichi announces its device on stdout, which belongs to the caller (`--json`).
        with contextlib.redirect_stdout(io.StringIO()):
            ti.init(arch=ti.cuda if name == "cuda" else ti.cpu, **options)
    except RuntimeError as error:
        raise DeviceError(
            f"the {name} device did not start: {error}",
            hint=f"set {VARIABLE}=cpu to compute without it",
            at="device",
        ) from error
    return name


def torch_build() -> str:
    """Which PyTorch build is installed, for example `2.13.0+cpu`; imports torch."""
    import torch

    kind = f"CUDA {torch.version.cuda}" if torch.version.cuda else "CPU only"
    return f"{torch.__version__} ({kind})"


def torch_device() -> str:
    """Where PyTorch shall compute: `cuda` where the driver and this build of it allow, else `cpu`.

    Imports torch. A CPU-only build beside a GPU is common, so only an explicit wish fails.

    Raises:
        DeviceError: If the environment asks for CUDA and there is none for PyTorch.
    """
    if chosen_device() == "cpu":
        return "cpu"
    import torch

    if torch.cuda.is_available():
        return "cuda"
    if os.environ.get(VARIABLE) == "cuda":
        raise DeviceError(
            f"{VARIABLE}=cuda, but PyTorch {torch_build()} finds no CUDA device",
            hint="install a CUDA build of PyTorch that this driver supports, or unset it",
            at="device",
        )
    return "cpu"


def solver_device() -> str:
    """Where finite elements solve their equations: `cuda` where PyTorch computes there, else `cpu`.

    They need no PyTorch, so what is wrong with it is left to those who do to say.
    """
    try:
        return torch_device()
    except (ImportError, OSError, DeviceError):
        return "cpu"


def load_torch(monitor: Monitor) -> None:
    """Import PyTorch: two seconds the first time, in which one may still be stopped.

    Raises:
        Cancelled: If the monitor says so; the import goes on and is of use to the next.
    """
    loading = threading.Thread(target=importlib.import_module, args=("torch",), daemon=True)
    loading.start()
    while loading.is_alive():
        monitor(0.0, "loading the network")
        loading.join(LOOK_S)


def start_device(monitor: Monitor) -> None:
    """Open the compute device, telling that it takes a moment."""
    monitor(0.0, "opening the device")
    open_device()
