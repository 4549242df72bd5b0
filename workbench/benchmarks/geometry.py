"""Geometry: body and meshes of the default finger; body, mesh and mould of every family."""

from __future__ import annotations

from workbench.benchmarks.timing import timed_row
from workbench.core.design import Layers, Meshing, MouldOptions
from workbench.core.monitor import silent
from workbench.core.results import MembraneMesh
from workbench.rows import Row
from workbench.specimens import finger_solid
from workbench.stages import build, lattice, mesh, mould
from workbench.validation.meshes import default_solid, family_names

CASE = "default finger"
HEX_BUILD_LIMIT_S = 1.0
BUILD_LIMIT_S = 3.0
"""Where every sucker or pin is a boolean of its own."""


def rows() -> list[Row]:
    """All rows of the room."""
    from designs.family import resolve_shape

    shape = resolve_shape("finger", {})
    finger = [
        timed_row("build", CASE, lambda: build("finger", shape, Layers(), monitor=silent), 0.25),
        timed_row("mesh", "0.4 mm", lambda: mesh(finger_solid(), Meshing(), monitor=silent), 3.0),
        timed_row("lattice", "0.5 mm", lambda: lattice(finger_solid(), 0.5, monitor=silent), 2.0),
    ]
    return [*finger, *_family_rows()]


def _family_rows() -> list[Row]:
    """Build every family's default shape, make its mould, and mesh those that hexahedra suit."""
    from designs.family import resolve_shape

    found: list[Row] = []
    for name in family_names():

        def rebuilt(name: str = name) -> object:
            return build(name, resolve_shape(name, {}), Layers(), monitor=silent)

        def meshed(name: str = name) -> MembraneMesh:
            return mesh(default_solid(name), Meshing(), monitor=silent)

        def moulded(name: str = name) -> object:
            return mould(default_solid(name), MouldOptions(), monitor=silent)

        structured = meshed().hexes is not None
        limit_s = HEX_BUILD_LIMIT_S if structured else BUILD_LIMIT_S
        found.append(timed_row(f"build_{name}", "default shape", rebuilt, limit_s))
        found.append(timed_row(f"mould_{name}", "default shape", moulded, 5.0))
        if structured:
            found.append(timed_row(f"hex_{name}", "default shape, 0.4 mm", meshed, 3.0))
    return found
