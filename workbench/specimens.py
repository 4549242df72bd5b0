"""The default finger, built once per process: what validation and benchmarks start from."""

from __future__ import annotations

import functools

from workbench.core.design import Layers, Meshing
from workbench.core.monitor import silent
from workbench.core.results import MaterialPoints, MembraneMesh, Solid
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


@functools.cache
def finger_points(grid_mm: float = 0.5) -> MaterialPoints:
    """Material points of the default finger."""
    return lattice(finger_solid(), grid_mm, monitor=silent)
