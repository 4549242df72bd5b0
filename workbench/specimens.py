"""The default finger, built once per process: what validation and benchmarks start from."""

from __future__ import annotations

import functools

from workbench.core.design import Layers, Meshing
from workbench.core.errors import MeshingError
from workbench.core.monitor import silent
from workbench.core.results import MaterialPoints, MembraneMesh, Solid, VolumeMesh
from workbench.stages import build, lattice, mesh


@functools.cache
def finger_solid() -> Solid:
    """The default finger."""
    from designs.family import resolve_shape

    return build("finger", resolve_shape("finger", {}), Layers(), monitor=silent)


@functools.cache
def finger_mesh() -> MembraneMesh:
    """The default finger at 0.4 mm."""
    return mesh(finger_solid(), Meshing(), monitor=silent)


def finger_hexes() -> VolumeMesh:
    """Its hexahedra.

    Raises:
        MeshingError: If there are none.
    """
    hexes = finger_mesh().hexes
    if hexes is None:
        raise MeshingError("the finger has no hexahedra", hint=finger_mesh().notice, at="shape")
    return hexes


@functools.cache
def finger_points(grid_mm: float = 0.5) -> MaterialPoints:
    """Material points of the default finger."""
    return lattice(finger_solid(), grid_mm, monitor=silent)
