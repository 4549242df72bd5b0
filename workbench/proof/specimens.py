"""The default finger, built once per process: what validation and benchmarks start from."""

from __future__ import annotations

import functools

from workbench.core.base.errors import MeshingError
from workbench.core.base.monitor import silent
from workbench.core.design.design import Layers, Meshing
from workbench.core.result.results import MaterialPoints, MembraneMesh, Solid, VolumeMesh
from workbench.pipeline.stages.build import BuildInputs, build
from workbench.pipeline.stages.lattice import LatticeInputs, lattice
from workbench.pipeline.stages.mesh import MeshInputs, mesh


@functools.cache
def finger_solid() -> Solid:
    """The default finger."""
    from designs.family import resolve_shape

    return build(
        BuildInputs(family="finger", shape=resolve_shape("finger", {}), layers=Layers()),
        monitor=silent,
    )


@functools.cache
def finger_mesh() -> MembraneMesh:
    """The default finger at 0.4 mm."""
    return mesh(MeshInputs(solid=finger_solid(), meshing=Meshing()), monitor=silent)


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
    return lattice(LatticeInputs(solid=finger_solid(), grid_mm=grid_mm), monitor=silent)
