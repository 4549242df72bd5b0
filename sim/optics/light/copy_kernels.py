"""The first entries of device arrays, copied on the device into tensors or arrays as long."""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false

import taichi as ti

from sim.optics.light.kernel_types import Floats, Integers, Vectors


@ti.kernel
def copy_numbers(values: Floats, found: Floats):
    """Of float32."""
    for at in range(found.shape[0]):
        found[at] = values[at]


@ti.kernel
def copy_integers(values: Integers, found: Integers):
    """Of int32."""
    for at in range(found.shape[0]):
        found[at] = values[at]


@ti.kernel
def copy_vectors(values: Vectors, found: Vectors):
    """Of three float32 each."""
    for at in range(found.shape[0]):
        found[at] = values[at]
