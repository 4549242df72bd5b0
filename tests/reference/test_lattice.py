"""Lattice fractions against boxes and spheres whose filling is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from geometry.surface.primitives import rounded_box, sphere
from geometry.volume import checks
from geometry.volume.lattice import material_points
from workbench.core.base.monitor import silent
from workbench.core.result.results import LabelledSurface, Solid


def surface(mesh: tuple[np.ndarray, np.ndarray], shift: tuple[float, ...]) -> LabelledSurface:
    points, faces = mesh
    return LabelledSurface(
        points_mm=points + np.array(shift), faces=faces, labels=np.ones(len(faces), np.uint8)
    )


def test_box_on_cell_borders_fills_whole_cells() -> None:
    """A 2 mm cube from -0.5 to 1.5 on a 1 mm lattice: cells 0 and 1 on each axis, all full."""
    points = material_points(surface(rounded_box(1.0, 0.0), (0.5, 0.5, 0.5)), 1.0)
    assert points.cells.tolist() == [[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    assert (points.fractions == 1.0).all()
    assert points.volume_mm3 == pytest.approx(8.0)


def test_bits_name_the_sub_cells() -> None:
    """A 0.5 mm cube in the +x, -y, +z corner of cell 0 fills p = 4 + 0 + 1 alone."""
    points = material_points(surface(rounded_box(0.25, 0.0), (0.25, -0.25, 0.25)), 1.0)
    assert points.cells.tolist() == [[0, 0, 0]]
    assert points.fractions[0].tolist() == [0, 0, 0, 0, 0, 1, 0, 0]


@pytest.mark.parametrize("height", [1e-4, 0.013, 0.37, 1.0 / 3.0])
def test_fractions_are_exact_along_z(height: float) -> None:
    """A slab from z = -0.5 up to `height`: full below, height / 0.5 in the sub-cell it ends in."""
    points, faces = rounded_box(0.5, 0.0)
    points[:, 2] = np.where(points[:, 2] > 0.0, height, -0.5)
    filled = material_points(surface((points, faces), (0.0, 0.0, 0.0)), 1.0)
    assert filled.fractions[0].reshape(4, 2)[:, 0] == pytest.approx(1.0)
    # Stored in float32.
    assert filled.fractions[0].reshape(4, 2)[:, 1] == pytest.approx(height / 0.5, abs=1e-6)


def test_sphere_volume_and_symmetry() -> None:
    """The volume of the mesh; fractions mirror with the body."""
    ball = surface(sphere(3.0), (0.0, 0.0, 0.0))
    points = material_points(ball, 0.5)
    # Error between rays: 0.0625 mm spacing on a 3 mm ball.
    assert checks.lattice_volume_ratio(points, ball) == pytest.approx(1.0, abs=1e-3)
    table = {tuple(c): f for c, f in zip(points.cells.tolist(), points.fractions, strict=True)}
    for cell, fractions in table.items():
        mirrored = table[(cell[0], cell[1], -cell[2])]
        assert fractions.reshape(4, 2) == pytest.approx(mirrored.reshape(4, 2)[:, ::-1], abs=1e-5)


def test_edges_and_corners_on_rays_do_not_leak() -> None:
    """Faces, edges and corners of a cube exactly on the rays at odd sixteenths: volume to 1e-9."""
    # Rays of a 1 mm lattice lie at (r + 1/2) / 8, so these walls hold rays, half open.
    points = material_points(surface(rounded_box(0.5, 0.0), (0.0625, 0.0625, 0.1)), 1.0)
    assert points.volume_mm3 == pytest.approx(1.0, abs=1e-6)


def test_finger_volume_within_two_per_mille(finger: Solid) -> None:
    """Volume of the closed surface, cells sorted, answer repeatable, progress reported."""
    seen: list[float] = []
    points = material_points(finger.membrane, 0.5, lambda fraction, note="": seen.append(fraction))
    assert checks.lattice_volume_ratio(points, finger.membrane) == pytest.approx(1.0, abs=2e-3)
    order = np.lexsort(points.cells.T[::-1])
    assert np.array_equal(order, np.arange(len(order)))
    again = material_points(finger.membrane, 0.5, silent)
    assert np.array_equal(points.cells, again.cells)
    assert np.array_equal(points.fractions, again.fractions)
    assert seen == sorted(seen)
    assert len(seen) > 2


def test_base_cells_are_half_full(finger: Solid) -> None:
    """Cell k = 0 reaches from -0.25 to 0.25 mm: its lower sub-cells are empty."""
    points = material_points(finger.membrane, 0.5)
    base = points.fractions[points.cells[:, 2] == 0].reshape(-1, 4, 2)
    assert points.cells[:, 2].min() == 0
    assert not base[:, :, 0].any()
    area_mm2 = float(base[:, :, 1].sum(dtype=np.float64)) * 0.25**2
    # Ring pi (15^2 - 13^2), sampled at 1/16 mm.
    assert area_mm2 == pytest.approx(math.pi * 56.0, rel=5e-3)
