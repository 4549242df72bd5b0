"""A force result carried from the mesh it was found on to the skin of the design.

Values per vertex are interpolated at the nearest point of the other skin. Forces, and pressure as
the force that it is, are spread (`spreading`), so that their totals are kept exactly. Fields that
the source does not know have no frames, and keep none.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from geometry.surface.surface import vertex_areas_mm2
from sim.forces.shares import shares_on
from sim.forces.spreading import Spreading, spreading
from workbench.core.result.force_field import ForceField
from workbench.core.result.results import MembraneMesh, Skin


def transferred(found: ForceField, source: MembraneMesh, target: MembraneMesh) -> ForceField:
    """A result on the skins of `source` as one on the skins of `target`."""
    if _same(source.outer, target.outer) and _same(source.inner, target.inner):
        return found
    here = shares_on(source.outer, target.outer.points_mm)
    inner = shares_on(source.inner, target.inner.points_mm)
    loaded = np.asarray(found.contact_force_N.any(axis=(0, 2)))
    if len(found.pressure_MPa):
        loaded |= found.pressure_MPa.any(axis=0)
    there = spreading(source.outer, target.outer, loaded)
    return dataclasses.replace(
        found,
        displacement_mm=here.interpolate(found.displacement_mm),
        contact_force_N=there.forces(found.contact_force_N),
        pressure_MPa=_pressure_MPa(there, found, source.outer, target.outer),
        cauchy_MPa=here.interpolate(found.cauchy_MPa),
        energy_MPa=here.interpolate(found.energy_MPa),
        slip_mm=here.interpolate(found.slip_mm),
        sliding=here.nearest(found.sliding),
        inner_mm=inner.interpolate(found.inner_mm),
    )


def _pressure_MPa(there: Spreading, found: ForceField, source: Skin, target: Skin) -> np.ndarray:
    """Pressure on the other skin that presses as much as it did, (K, V)."""
    if not len(found.pressure_MPa):
        return found.pressure_MPa
    pressing_N = there.forces(found.pressure_MPa * _areas_mm2(source))
    return (pressing_N / _areas_mm2(target)).astype(np.float32)


def _areas_mm2(skin: Skin) -> np.ndarray:
    return np.maximum(vertex_areas_mm2(skin.points_mm, skin.faces), 1e-12)


def _same(one: Skin, other: Skin) -> bool:
    return np.array_equal(one.points_mm, other.points_mm)
