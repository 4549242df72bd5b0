"""Which elastomer is where: the moduli of cells and of surface points."""

from __future__ import annotations

import numpy as np

from geometry.surface.surface import closest_point
from sim.material import moduli_MPa
from workbench.core.design.design import Elastomer
from workbench.core.design.inclusion import Inclusion, Where
from workbench.core.result.results import Skin


def stiffest_MPa(material: Elastomer) -> float:
    """Largest Young's modulus in the membrane."""
    return max(material.young_MPa, *(part.young_MPa for part in material.inclusions), 0.0)


def part_of(material: Elastomer, outer: Skin, places_mm: np.ndarray) -> np.ndarray:
    """Number of the inclusion that holds each place (N, 3), -1 for the elastomer itself, (N,)."""
    part = np.full(len(places_mm), -1)
    for number, inclusion in enumerate(material.inclusions):
        part[_inside(inclusion, outer, places_mm)] = number
    return part


def young_MPa_at(material: Elastomer, outer: Skin, places_mm: np.ndarray) -> np.ndarray:
    """Young's modulus at places, (N, 3), shape (N,)."""
    return _constants(material)[part_of(material, outer, places_mm), 0]


def moduli_MPa_at(material: Elastomer, outer: Skin, places_mm: np.ndarray) -> np.ndarray:
    """Shear and bulk modulus at places, (N, 3), shape (N, 2)."""
    shear_bulk = np.array([moduli_MPa(young, ratio) for young, ratio in _constants(material)])
    return shear_bulk[part_of(material, outer, places_mm)]


def _constants(material: Elastomer) -> np.ndarray:
    """Young's modulus and Poisson's ratio of each inclusion; the elastomer itself comes last."""
    parts = [(part.young_MPa, part.poisson) for part in material.inclusions]
    return np.array([*parts, (material.young_MPa, material.poisson)])


def _inside(inclusion: Inclusion, outer: Skin, places_mm: np.ndarray) -> np.ndarray:
    away = places_mm - np.asarray(inclusion.centre_mm)
    if inclusion.where is Where.BALL:
        return np.linalg.norm(away, axis=1) <= inclusion.radius_mm
    if inclusion.where is Where.BOX:
        return np.abs(away / inclusion.size_mm).max(axis=1) <= 0.5
    _, distance, _ = closest_point(outer.points_mm, outer.faces, places_mm)
    return distance <= inclusion.depth_mm
