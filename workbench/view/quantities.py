"""What can be shown of a press on the skin: one number per vertex and frame, with its unit.

    traction = sqrt(|f|^2 - (p A)^2) / A

with f the contact force of a vertex, p its pressure, A a third of the triangles around it; von
Mises stress as in `geometry.surface.stress`. The colour scale of a quantity is that of all frames
together. Results of earlier versions may lack a field: what cannot be shown has no values.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

import numpy as np

from geometry.surface import surface
from geometry.surface.stress import von_mises_MPa
from workbench.core.result.results import Skin
from workbench.view.force_sources import Forces

LONGEST_ARROW_MM = 6.0
"""Length of the arrow of the largest force of a press."""
ARROW_CELL_MM = 0.8
"""Forces within a cube of this edge are one arrow."""
LEAST_ARROW = 0.03
"""Arrows shorter than this share of the longest are left out."""
LEAST_TOP = 1e-12


class Quantity(enum.StrEnum):
    """Names for people."""

    DISPLACEMENT = "displacement"
    PRESSURE = "pressure"
    SHEAR = "shear traction"
    VON_MISES = "von Mises stress"
    ENERGY = "strain energy"
    SLIDING = "sliding"
    SLIP = "slip distance"


UNITS = {
    Quantity.DISPLACEMENT: "mm",
    Quantity.PRESSURE: "kPa",
    Quantity.SHEAR: "kPa",
    Quantity.VON_MISES: "kPa",
    Quantity.ENERGY: "mJ/cm³",
    Quantity.SLIDING: "0 sticks, 1 slides",
    Quantity.SLIP: "mm",
}
"""A silicone skin feels kilopascals; 1 kPa of strain energy is 1 mJ per cm3."""
KILO = 1000.0


@dataclass(frozen=True, kw_only=True, slots=True)
class Shown:
    """A quantity of a press, ready for colours."""

    quantity: Quantity
    values: np.ndarray
    """Finite values, shape (K, V), float32."""
    top: float
    """Largest of all frames; 1 where all are zero."""
    difference: bool = False
    """Whether it is how far two sources are apart."""
    known: bool = True
    """Whether the sources have it: a network predicts no stress."""

    @property
    def empty(self) -> bool:
        """Whether all values are zero."""
        return not self.values.any()

    @property
    def unit(self) -> str:
        """Unit of values and top."""
        return UNITS[self.quantity]

    @property
    def shares(self) -> np.ndarray:
        """Values over the top, shape (K, V)."""
        return self.values / self.top


def shown(skin: Skin, contact: Forces, quantity: Quantity, against: Forces | None = None) -> Shown:
    """A quantity on the outer skin in every frame; zero where the result has no such field.

    With `against`, another source of the same press, how far the two are apart: the length of the
    difference of displacements, else the size of the difference; zero where one of them has no such
    field.
    """
    values, known = _filled(skin, contact, quantity)
    if against is not None:
        others, both = _filled(skin, against, quantity)
        known = known and both
        values = np.abs(values - others) if known else np.zeros_like(values)
        if quantity is Quantity.DISPLACEMENT:
            apart = np.asarray(contact.displacement_mm) - np.asarray(against.displacement_mm)
            values = np.linalg.norm(apart, axis=2)
    values = np.maximum(values, 0.0)
    flag = quantity is Quantity.SLIDING or not values.any()
    top = 1.0 if flag else float(values.max())
    apart = against is not None
    return Shown(quantity=quantity, values=values, top=top, difference=apart, known=known)


def _filled(skin: Skin, contact: Forces, quantity: Quantity) -> tuple[np.ndarray, bool]:
    """Finite values of all frames and vertices, (K, V), float32, and whether the result has any."""
    frames, vertices = contact.displacement_mm.shape[:2]
    values = _values(skin, contact, quantity)
    known = values.shape == (frames, vertices)
    if not known:
        values = np.zeros((frames, vertices))
    plain = np.nan_to_num(np.asarray(values, np.float32), nan=0.0, posinf=0.0, neginf=0.0)
    return plain, known


def _values(skin: Skin, contact: Forces, quantity: Quantity) -> np.ndarray:
    match quantity:
        case Quantity.DISPLACEMENT:
            return np.linalg.norm(contact.displacement_mm, axis=2)
        case Quantity.PRESSURE:
            return KILO * np.asarray(contact.pressure_MPa)
        case Quantity.SHEAR:
            return KILO * shear_MPa(skin, contact)
        case Quantity.VON_MISES:
            return KILO * von_mises_MPa(np.asarray(contact.cauchy_MPa))
        case Quantity.ENERGY:
            return KILO * np.asarray(contact.energy_MPa)
        case Quantity.SLIDING:
            return np.asarray(contact.sliding, dtype=np.float32)
        case Quantity.SLIP:
            return np.asarray(contact.slip_mm)


def shear_MPa(skin: Skin, contact: Forces) -> np.ndarray:
    """Tangential contact force per undeformed area of the vertices [MPa], shape (K, V)."""
    forces, pressure = np.asarray(contact.contact_force_N), np.asarray(contact.pressure_MPa)
    if not len(forces) == len(pressure) == len(contact.displacement_mm):
        return np.zeros((0, 0))
    area_mm2 = vertex_areas_mm2(skin)
    squared = (forces**2).sum(axis=2) - (pressure * area_mm2) ** 2
    return np.sqrt(np.maximum(squared, 0.0)) / area_mm2


def vertex_areas_mm2(skin: Skin) -> np.ndarray:
    """A third of the triangles around each vertex [mm2], shape (V,), never zero."""
    return np.maximum(surface.vertex_areas_mm2(skin.points_mm, skin.faces), LEAST_TOP)


def largest_arrow_N(skin: Skin, contact: Forces) -> float:
    """Largest summed force of a cube in any frame [N]: the scale of `force_arrows`."""
    if len(contact.contact_force_N) != len(contact.displacement_mm):
        return 0.0
    return max(
        float(np.linalg.norm(_binned(skin, contact, frame)[1], axis=1).max(initial=0.0))
        for frame in range(len(contact.displacement_mm))
    )


def force_arrows(skin: Skin, contact: Forces, frame: int, *, top_N: float) -> np.ndarray:
    """Contact forces on the skin as arrows that end on it [mm], shape (N, 2, 3), thinned.

    Forces within a cube of `ARROW_CELL_MM` are added up and stand at their weighted middle.

    Args:
        skin: Undeformed outer skin.
        contact: The press.
        frame: Which frame, from 0.
        top_N: Force of the longest arrow; that of all frames is `largest_arrow_N`.
    """
    if top_N <= 0.0:
        return np.zeros((0, 2, 3))
    places, sums = _binned(skin, contact, frame)
    size = np.linalg.norm(sums, axis=1)
    kept = size > max(LEAST_ARROW * top_N, LEAST_TOP)
    tips = places[kept]
    return np.stack([tips - LONGEST_ARROW_MM / top_N * sums[kept], tips], axis=1)


def _binned(skin: Skin, contact: Forces, frame: int) -> tuple[np.ndarray, np.ndarray]:
    """Places [mm] and summed forces [N] of the cubes that carry any, each (N, 3)."""
    force = np.asarray(contact.contact_force_N[frame], dtype=np.float64)
    size = np.linalg.norm(force, axis=1)
    carrying = np.flatnonzero(np.isfinite(size) & (size > 0.0))
    force, size = force[carrying], size[carrying]
    rest_mm = np.asarray(skin.points_mm)[carrying]
    place_mm = rest_mm + np.asarray(contact.displacement_mm[frame])[carrying]
    cells = np.floor(rest_mm / ARROW_CELL_MM).astype(np.int64)
    _, cell = np.unique(cells, axis=0, return_inverse=True)
    cell = cell.reshape(-1)
    count = int(cell.max(initial=-1)) + 1
    sums, middles = np.zeros((count, 3)), np.zeros((count, 3))
    np.add.at(sums, cell, force)
    np.add.at(middles, cell, size[:, None] * place_mm)
    weight = np.bincount(cell, size, count)
    return middles / np.maximum(weight, LEAST_TOP)[:, None], sums
