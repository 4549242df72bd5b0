"""NumPy arrays on the compute device; the device must be open."""

from __future__ import annotations

import weakref
from typing import Any

import numpy as np
import taichi as ti
from taichi.lang import impl


def on_device(array: np.ndarray, *, vector: int = 0) -> Any:
    """A copy on the device; `vector` > 0 makes its last axis, of that length, one element."""
    array = np.ascontiguousarray(array)
    kinds = {"u": ti.u8, "i": ti.i64 if array.dtype.itemsize == 8 else ti.i32, "f": ti.f32}
    kind = kinds[array.dtype.kind]
    if array.dtype.kind == "f":
        array = array.astype(np.float32)
    shape = array.shape[:-1] if vector else array.shape
    # Taichi has no arrays of length 0; nothing reads the element that stands in.
    if 0 in shape:
        shape = tuple(max(length, 1) for length in shape)
        array = np.zeros((*shape, vector) if vector else shape, dtype=array.dtype)
    made = _made(kind, shape, vector)
    made.from_numpy(array)
    return made


def readable(array: Any, *, vector: int = 0) -> Any:
    """Where kernels find a contiguous array: in NumPy's own memory, or in a copy on the GPU.

    A tensor of PyTorch that lies on the device is taken as it is.
    """
    if computes_on_gpu() and isinstance(array, np.ndarray):
        return on_device(array, vector=vector)
    return array


def empty(kind: Any, count: int, *, vector: int = 0) -> Any:
    """A flat array of at least one element, zero."""
    shape = (max(count, 1),)
    return _made(kind, shape, vector)


def _made(kind: Any, shape: tuple[int, ...], vector: int) -> Any:
    """An array on the device that is given back when nothing refers to it any more."""
    if not vector:
        return ti.ndarray(kind, shape=shape)
    made = ti.Vector.ndarray(vector, kind, shape=shape)
    # Taichi 1.7 gives scalar arrays back when they are collected, but forgets those of vectors: a
    # worker that renders all day would grow by megabytes with every studio it opens.
    program = impl.get_runtime().prog
    weakref.finalize(made, _give_back, program, made.arr).atexit = False
    return made


def _give_back(program: Any, memory: Any) -> None:
    if impl.get_runtime().prog is program:
        program.delete_ndarray(memory)


def computes_on_gpu() -> bool:
    """Whether the open device is a GPU."""
    return impl.current_cfg().arch not in (ti.x64, ti.arm64)
