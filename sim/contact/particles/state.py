"""The points of the published method (`particles`) on the device, and their substeps."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import taichi as ti

from sim.contact.particles import kernels
from sim.contact.particles.cloud import Cloud
from sim.material import elastic_solid
from workbench.core.design.design import Elastomer

COURANT = 0.3
"""Cells that a pressure wave crosses in a substep."""
OBJECT_DENSITY = 8.0
"""Density of the object over that of the elastomer, as published."""
TABLE = 50
"""Substeps whose poses are handed to the device at once."""


class State:
    """The points on the device; lengths in cells from the grid's lowest node."""

    def __init__(self, cloud: Cloud, material: Elastomer) -> None:
        self.cloud = cloud
        self.substeps = 0
        solid = elastic_solid(material)
        count = len(cloud.place_mm)
        stiffest_MPa = solid.lame_MPa + 2.0 * solid.shear_MPa
        self.stress_scale = COURANT**2 / stiffest_MPa
        """dt^2 / (density dx^2) [1/MPa]."""
        self.unit_N = cloud.grid_mm**2 / (8.0 * self.stress_scale)
        """Force of one unit of momentum per substep [N]."""
        self._points = kernels.Points(
            places=_array(self.cells(cloud.place_mm), ti.f32),
            speeds=_array(np.zeros(3 * count), ti.f32),
            affine=_array(np.zeros(9 * count), ti.f32),
            gradients=_array(np.tile(np.eye(3), (count, 1, 1)), ti.f32),
            masses=_array(cloud.fraction, ti.f32),
            moduli=_array(np.tile([solid.shear_MPa, solid.bulk_MPa], (count, 1)), ti.f32),
            kinds=_array(cloud.kind, ti.i32),
        )
        self._body = kernels.Body(
            offsets=_array(cloud.body_mm / cloud.grid_mm, ti.f32),
            poses=ti.ndarray(ti.f32, 12 * (TABLE + 1)),
            object_mass=OBJECT_DENSITY,
        )
        _, nodes_y, nodes_z = cloud.nodes
        self._grid = kernels.Grid(
            momentum=ti.ndarray(ti.i64, 4 * math.prod(cloud.nodes)),
            flow=ti.ndarray(ti.f32, 3 * math.prod(cloud.nodes)),
            nodes_y=nodes_y,
            nodes_z=nodes_z,
        )
        self._sums = ti.ndarray(ti.i64, 6 * kernels.GROUPS)

    def cells(self, place_mm: np.ndarray) -> np.ndarray:
        """Places in cells from the lowest node."""
        return place_mm / self.cloud.grid_mm - self.cloud.low

    def advance(self, origins_mm: np.ndarray, turned: np.ndarray) -> None:
        """Follow poses, (n + 1, 3) and (n + 1, 3, 3), n at most `TABLE`, the first is now."""
        table = np.zeros((TABLE + 1, 12), np.float32)
        rows = [self.cells(origins_mm), turned.reshape(-1, 9)]
        table[: len(origins_mm)] = np.concatenate(rows, axis=1)
        self._body["poses"].from_numpy(table.ravel())
        for step in range(len(origins_mm) - 1):
            kernels.substep(
                self._points, self._body, self._grid, self._sums, step, self.stress_scale
            )
        self.substeps += len(origins_mm) - 1

    def start_sums(self) -> None:
        """Begin to sum what prescribed points gain."""
        self._sums.fill(0)

    def gained(self, substeps: int) -> np.ndarray:
        """Mean force [N] and moment about the lowest node [N mm] by group, shape (3, 6)."""
        sums = self._sums.to_numpy().reshape(kernels.GROUPS, 6).astype(np.float64)
        sums /= kernels.FIXED_POINT
        sums *= self.unit_N / substeps
        sums[:, 3:] *= self.cloud.grid_mm
        return sums

    def places_mm(self) -> np.ndarray:
        """Where the membrane's points are [mm], shape (P, 3)."""
        cells = self._points["places"].to_numpy().reshape(-1, 3).astype(np.float64)
        return (cells + self.cloud.low) * self.cloud.grid_mm


def _array(values: np.ndarray, kind: Any) -> Any:
    host = np.float32 if kind is ti.f32 else np.int32
    flat = np.ascontiguousarray(values, dtype=host).ravel()
    array = ti.ndarray(kind, flat.size)
    array.from_numpy(flat)
    return array
