"""Walls as balls inside a part: closed forms, feather edges left out, thin ribs found."""

from __future__ import annotations

import numpy as np
import pytest

from geometry.body import csg
from geometry.body.csg_mesh import arrays, evaluate
from geometry.mould.mould_checks import MOULD_LIMITS
from geometry.mould.print_checks import wall_check
from geometry.mould.walls import thinnest_wall
from geometry.surface.primitives import sphere
from workbench.core.result.fabrication import Severity

Mesh = tuple[np.ndarray, np.ndarray]


def made(node: csg.Node) -> Mesh:
    """Points and faces of a description."""
    return arrays(evaluate(node))


def block(*size_mm: float) -> csg.Box:
    """A box in the middle of things."""
    x, y, z = (value / 2 for value in size_mm)
    return csg.Box(low_mm=(-x, -y, -z), high_mm=(x, y, z))


def prism(*corners: tuple[float, float]) -> csg.Prism:
    """A section in x and y, 12 mm long."""
    return csg.Prism(polygon_mm=np.array(corners), low_mm=0.0, high_mm=12.0)


@pytest.mark.parametrize("wall_mm", [0.021, 0.3, 1.7])
def test_a_plate_is_as_thin_as_it_is(wall_mm: float) -> None:
    """Its faces look apart everywhere; its edges, all of 90 degrees, are no walls."""
    found = thinnest_wall(*made(block(20.0, 12.0, wall_mm)))
    assert found.value == pytest.approx(wall_mm, rel=1e-6)
    assert found.place_mm[2] == pytest.approx(0.0, abs=1e-6)


def test_a_tube_is_as_thin_as_its_wall() -> None:
    """Radius 10 and 9.4 mm: 0.6, less chords of 0.02 mm."""
    tube = csg.without(csg.cylinder(10.0, 0.0, 20.0), [csg.cylinder(9.4, -1.0, 21.0)])
    assert thinnest_wall(*made(tube)).value == pytest.approx(0.6, abs=0.025)


def test_a_shell_of_a_sphere_is_as_thin_as_its_wall() -> None:
    """Radius 10 and 9.2 mm: 0.8, less the sag of the triangles."""
    meshes = [sphere(radius) for radius in (10.0, 9.2)]
    shells = [csg.Body(points_mm=points, faces=faces) for points, faces in meshes]
    shell = csg.without(shells[0], shells[1:])
    assert thinnest_wall(*made(shell)).value == pytest.approx(0.8, abs=0.03)


def test_the_ball_is_larger_than_a_way_beside_a_blunt_end() -> None:
    """Sides at 30 degrees, cut off where they are 1 mm apart: the smallest ball between them that
    does not touch the blunt end stands s from where they would meet, s - s tan 15 = 1 / tan 30;
    its diameter is 2 s tan 15 degrees."""
    wide, half = np.tan(np.radians([30.0, 15.0]))
    cut = 1.0 / wide
    body = prism((cut, 0.0), (12.0, 0.0), (12.0, 12.0 * wide), (cut, 1.0))
    s_mm = cut / (1.0 - half)
    assert thinnest_wall(*made(body)).value == pytest.approx(2.0 * s_mm * half, rel=0.03)


@pytest.mark.parametrize("angle_deg", [10.0, 25.0, 40.0])
def test_a_feather_edge_is_left_out(angle_deg: float) -> None:
    """A wedge runs out at its edge, and has no wall there."""
    tangent = np.tan(np.radians(angle_deg))
    wedge = prism((0.0, 0.0), (10.0, 0.0), (10.0, 10.0 * tangent))
    assert thinnest_wall(*made(wedge)).value > 1.0


def test_a_thin_rib_is_found_beside_a_feather_edge() -> None:
    """0.25 x 3 x 4 mm on a block of 30 x 30 mm, whose one side is a feather edge."""
    wedge = prism((15.0, 0.0), (25.0, 0.0), (15.0, 3.0))
    rib = csg.Box(low_mm=(0.0, 5.0, 10.0), high_mm=(0.25, 8.0, 16.0))
    body = csg.together(csg.Box(low_mm=(-15, 0, 0), high_mm=(15, 30, 12)), [wedge, rib])
    found = thinnest_wall(*made(body))
    assert found.value == pytest.approx(0.25, rel=1e-6)
    assert found.place_mm[2] > 12.0


@pytest.mark.parametrize(
    ("wall_mm", "feature_mm", "severity"),
    [
        (2.1, 0.4, Severity.GOOD),
        (1.9, 0.4, Severity.WARNING),
        (0.41, 0.4, Severity.WARNING),
        (0.39, 0.4, Severity.BAD),
        (0.021, 0.05, Severity.BAD),
        (0.39, 0.05, Severity.BAD),
        (0.7, 0.8, Severity.BAD),
    ],
)
def test_walls_that_no_printer_makes_are_bad(
    wall_mm: float, feature_mm: float, severity: Severity
) -> None:
    """Below 0.4 mm, or below what the printer does, red; up to 2 mm, which bends, amber."""
    from geometry.mould.castability import Worst

    wall = Worst(wall_mm, (0.0, 0.0, 0.0))
    assert wall_check("half_a", wall, MOULD_LIMITS, feature_mm).severity is severity
