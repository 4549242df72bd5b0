"""Where tensors of PyTorch lie beside the arrays of the open device."""

from __future__ import annotations

from sim.optics.light.device_arrays import computes_on_gpu
from workbench.core.base.errors import DeviceError


def tensor_device() -> str:
    """What PyTorch calls the open device.

    Raises:
        DeviceError: If that is a GPU and this build of PyTorch knows none.
    """
    import torch

    if not computes_on_gpu():
        return "cpu"
    if not torch.cuda.is_available():
        raise DeviceError(
            f"the sensor is on a GPU, and PyTorch {torch.__version__} finds no CUDA device",
            hint="install a CUDA build of PyTorch, take render and feel, or set "
            "WORKBENCH_DEVICE=cpu",
            at="device",
        )
    return "cuda"
