"""Geometry: body and meshes of the default finger; body, mesh and mould of every family."""

from __future__ import annotations

from workbench.core.base.monitor import silent
from workbench.core.design.design import Layers, Meshing, MouldOptions
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.stages.build import BuildInputs, build
from workbench.pipeline.stages.lattice import LatticeInputs, lattice
from workbench.pipeline.stages.mesh import MeshInputs, mesh
from workbench.pipeline.stages.mould import MouldInputs, mould
from workbench.proof.benchmarks.timing import timed_row
from workbench.proof.row import Row
from workbench.proof.specimens import finger_solid
from workbench.proof.validation.geometry.meshes import default_solid, family_names

CASE = "default finger"
HEX_BUILD_LIMIT_S = 1.0
BUILD_LIMIT_S = 3.0
"""Where every sucker or pin is a boolean of its own."""


def rows() -> list[Row]:
    """All rows of the room."""
    from designs.family import resolve_shape

    shape = resolve_shape("finger", {})
    finger = [
        timed_row(
            "build",
            CASE,
            lambda: build(
                BuildInputs(family="finger", shape=shape, layers=Layers()), monitor=silent
            ),
            0.25,
        ),
        timed_row(
            "mesh",
            "0.4 mm",
            lambda: mesh(MeshInputs(solid=finger_solid(), meshing=Meshing()), monitor=silent),
            3.0,
        ),
        timed_row(
            "lattice",
            "0.5 mm",
            lambda: lattice(LatticeInputs(solid=finger_solid(), grid_mm=0.5), monitor=silent),
            2.0,
        ),
    ]
    return [*finger, *_family_rows()]


def _family_rows() -> list[Row]:
    """Build every family's default shape, make its mould, and mesh those that hexahedra suit."""
    from designs.family import resolve_shape

    found: list[Row] = []
    for name in family_names():

        def rebuilt(name: str = name) -> object:
            return build(
                BuildInputs(family=name, shape=resolve_shape(name, {}), layers=Layers()),
                monitor=silent,
            )

        def meshed(name: str = name) -> MembraneMesh:
            return mesh(MeshInputs(solid=default_solid(name), meshing=Meshing()), monitor=silent)

        def moulded(name: str = name) -> object:
            return mould(
                MouldInputs(solid=default_solid(name), options=MouldOptions()), monitor=silent
            )

        structured = meshed().hexes is not None
        limit_s = HEX_BUILD_LIMIT_S if structured else BUILD_LIMIT_S
        found.append(timed_row(f"build_{name}", "default shape", rebuilt, limit_s))
        found.append(timed_row(f"mould_{name}", "default shape", moulded, 5.0))
        if structured:
            found.append(timed_row(f"hex_{name}", "default shape, 0.4 mm", meshed, 3.0))
    return found
