"""Large objects: sampled finely only where they meet the skin."""

import numpy as np
import pytest
import trimesh

from sim.contact.press import press_membrane
from sim.contact.region.placing import place_object
from sim.contact.studies.specimens import flat_block
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase

pytestmark = pytest.mark.usefixtures("taichi_device")
PRESS = Press(target_mm=(0.0, 0.0, 2.0), depth_mm=0.3, frames=1)


def ball(size_mm: float) -> Indenter:
    mesh = trimesh.creation.icosphere(subdivisions=6, radius=0.5 * size_mm)
    points, faces = np.asarray(mesh.vertices, float), np.asarray(mesh.faces, np.int32)
    return Indenter(
        kind=IndenterKind.MESH, size_mm=size_mm, mesh=IndenterMesh(points_mm=points, faces=faces)
    )


def test_large_mesh_is_sampled_at_two_fifths_of_a_cell_where_it_touches() -> None:
    """A ball of 120 mm would get 0.9 mm as a whole; its window, with the contact, gets 0.2 mm."""
    mesh, _ = flat_block(width_mm=12.0, height_mm=2.0, grid_mm=0.5)
    approach = place_object(mesh.outer, ball(120.0), PRESS, grid_mm=0.5)
    collider = approach.collider
    assert 1.0 / collider.size[3] == pytest.approx(0.2)
    assert np.prod(collider.samples.shape) < 1_500_000
    origin, rotation = approach.pose(1.0)
    distance, _ = collider.distance((mesh.outer.points_mm - origin) @ rotation)
    exact = np.linalg.norm(mesh.outer.points_mm - origin, axis=1) - 60.0
    # The faceted ball lies up to 0.02 mm inside the round one.
    assert np.abs(distance - exact)[exact < 0.1].max() < 0.03


@pytest.mark.slow
def test_large_mesh_presses_as_the_exact_ball() -> None:
    """A ball of 40 mm as a mesh and in closed form: forces agree to 3 %."""
    mesh, points = flat_block(width_mm=12.0, height_mm=2.0, grid_mm=0.5)
    settings = ContactSettings(active_radius_mm=9.0)
    forces = [
        press_membrane(
            mesh, points, Elastomer(), PressCase(indenter=each, press=PRESS, settings=settings)
        ).normal_N[-1]
        for each in (ball(40.0), Indenter(size_mm=40.0))
    ]
    assert forces[0] == pytest.approx(forces[1], rel=0.03)


@pytest.mark.parametrize(("friction", "limit_N"), [(0.0, 0.4833), (0.3, 0.5246)])
def test_nearly_incompressible_gel_settles_under_a_large_ball(
    friction: float, limit_N: float
) -> None:
    """A ball of 50 mm on gel of nu .49 comes to rest in a tenth of the substeps allowed.

    Its contact is counted from its lowest point: from its centre, single precision leaves forces
    that rattle by a thousandth of the load, and 6000 substeps were not enough.
    """
    mesh, points = flat_block(width_mm=25.25, length_mm=20.75, height_mm=4.0, grid_mm=1.0)
    contact = press_membrane(
        mesh,
        points,
        Elastomer(young_MPa=0.1, poisson=0.49, friction=friction),
        PressCase(
            indenter=Indenter(size_mm=100.0),
            press=Press(target_mm=(0.0, 0.0, 4.0), depth_mm=0.2266, frames=1),
            settings=ContactSettings(grid_mm=1.0, max_substeps=600),
        ),
    )
    # The limit is that of a disc about as large (`axisymmetric_limits.json`); the grid is coarse, a
    # quarter of the gel.
    assert contact.normal_N[-1] == pytest.approx(limit_N, rel=0.03)
