"""Plain twin of the Taichi functions of traced light: what they do, photon by photon, in NumPy.

Tests hand both the same photons, hits and random numbers and compare every field after the event.
The equations and their sources are in `scatter_functions`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim.optics.light.bins import bin_shares
from sim.optics.transport.constants import (
    ABSORBED,
    FLYING,
    GRAZING,
    LATTICE,
    LEAKED,
    OFFSET_MM,
    STEEPEST,
    SURVIVAL,
)
from sim.optics.transport.scene import Scene
from workbench.core.result.light import AZIMUTHS, SINES

FLOOR = 1e-3
"""As in `coating_kernels`."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Photons:
    """P photons between two events."""

    origin: np.ndarray
    """Shape (P, 3)."""
    direction: np.ndarray
    """Shape (P, 3)."""
    flux: np.ndarray
    fresh: np.ndarray
    """Whether nothing but clear walls has turned it, shape (P,), bool."""
    crossed: np.ndarray
    """Whether it was bent into the solid or began there, shape (P,), bool."""
    fate: np.ndarray


@dataclass(frozen=True, kw_only=True, slots=True)
class Places:
    """Where P photons meet triangles; both normals point against the ray."""

    point: np.ndarray
    geometric: np.ndarray
    shading: np.ndarray
    outward: np.ndarray
    """Whether the ray goes out of the sensor, shape (P,), bool."""


def random4(numbers: np.ndarray, seed: int, event: int) -> np.ndarray:
    """Four numbers in [0, 1) for each photon, shape (P, 4): pcg4d of number, seed, event."""
    with np.errstate(over="ignore"):
        seeds = [np.full(len(numbers), value, dtype=np.uint32) for value in (seed, event)]
        x, y, z, w = [
            part.astype(np.uint32) * np.uint32(1664525) + np.uint32(1013904223)
            for part in (numbers & 0xFFFFFFF, numbers >> 28, *seeds)
        ]
        for turn in range(2):
            x = x + y * w
            y = y + z * x
            z = z + x * y
            w = w + y * z
            if turn == 0:
                x, y, z, w = (part ^ (part >> np.uint32(16)) for part in (x, y, z, w))
    return np.column_stack([x, y, z, w]) / 2.0**32


def lattice4(index: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """Points of the shifted lattice, shape (P, 4)."""
    steps = (index[:, None] * np.array(LATTICE, dtype=np.int64)) % (1 << 32) / 2.0**32
    return (steps + shift) % 1.0


def places_of(
    scene: Scene, direction: np.ndarray, face: np.ndarray, u: np.ndarray, v: np.ndarray
) -> Places:
    """The surface at hits: faces (P,), weights u and v of their second and third corners."""
    corners = scene.faces[face]
    a, b, c = (scene.points_mm[corners[:, k]].astype(np.float64) for k in range(3))
    weights = np.column_stack([1.0 - u - v, u, v])
    point = np.einsum("pk,pkd->pd", weights, np.stack([a, b, c], axis=1))
    geometric = _unit(np.cross(b - a, c - a))
    shading = _unit(np.einsum("pk,pkd->pd", weights, scene.normals[corners].astype(np.float64)))
    geometric = np.where((_dot(geometric, shading) < 0.0)[:, None], -geometric, geometric)
    outward = _dot(geometric, direction) >= 0.0
    sign = np.where(outward, -1.0, 1.0)[:, None]
    geometric, shading = sign * geometric, sign * shading
    behind = _dot(shading, direction) > -GRAZING
    shading = np.where(behind[:, None], geometric, shading)
    return Places(point=point, geometric=geometric, shading=shading, outward=outward)


def at_wall(photons: Photons, places: Places, choice: np.ndarray, index: float) -> Photons:
    """Reflect or refract at the smooth wall."""
    d, normal, facing = photons.direction, places.shading, places.geometric
    ratio = np.where(places.outward, 1.0 / index, index)
    cos_in = np.minimum(-_dot(normal, d), 1.0)
    squared = 1.0 - ratio**2 * (1.0 - cos_in**2)
    cos_out = np.sqrt(np.maximum(squared, 0.0))
    s = (ratio * cos_in - cos_out) / (ratio * cos_in + cos_out)
    p = (cos_in - ratio * cos_out) / (cos_in + ratio * cos_out)
    reflectance = np.where(squared > 0.0, 0.5 * (s**2 + p**2), 1.0)
    back = choice < reflectance
    mirrored = d + 2.0 * cos_in[:, None] * normal
    by_facet = d - 2.0 * _dot(d, facing)[:, None] * facing
    mirrored = np.where((_dot(mirrored, facing) < GRAZING)[:, None], by_facet, mirrored)
    bent = ratio[:, None] * d + (ratio * cos_in - cos_out)[:, None] * normal
    bends = (_dot(bent, facing) < -GRAZING) & (index != 1.0)
    onward = np.where(bends[:, None], bent, d)
    through_again = photons.crossed & (index != 1.0)
    side = np.where(back, 1.0, -1.0)[:, None]
    return replace(
        photons,
        origin=places.point + side * OFFSET_MM * facing,
        direction=_unit(np.where(back[:, None], mirrored, onward)),
        fresh=photons.fresh & np.where(back, ~places.outward, ~through_again),
        crossed=photons.crossed | (~back & (index != 1.0)),
    )


def at_coating(
    photons: Photons, places: Places, u: np.ndarray, scene: Scene
) -> tuple[Photons, np.ndarray, np.ndarray]:
    """Scatter at the coating; the flux absorbed and the flux cut off by roulette."""
    coating = scene.coating
    z = places.shading
    x, y = _across(z)
    toward = -photons.direction
    view = np.column_stack([_dot(toward, x), _dot(toward, y), _dot(toward, z)])
    matte = coating.albedo * (1.0 - coating.specular)
    glossy = _schlick(view[:, 2], coating.specular)
    chance = glossy / np.maximum(glossy + matte, 1e-9)
    shiny = u[:, 0] < chance
    half = _half_vector(view, coating.roughness, u[:, 1], u[:, 2])
    cos_half = _dot(view, half)
    mirrored = 2.0 * cos_half[:, None] * half - view
    masking = _masking(view[:, 2], mirrored[:, 2], coating.roughness)
    shine = _schlick(cos_half, coating.specular) * masking / np.maximum(chance, 1e-30)
    around, radius = 2.0 * np.pi * u[:, 2], np.sqrt(u[:, 1])
    spread = np.column_stack(
        [radius * np.cos(around), radius * np.sin(around), np.sqrt(1.0 - u[:, 1])]
    )
    local = np.where(shiny[:, None], mirrored, spread)
    weight = np.where(shiny, shine, matte / np.maximum(1.0 - chance, 1e-9))
    out = local[:, :1] * x + local[:, 1:2] * y + local[:, 2:] * z
    cos_out, cos_facet = _dot(out, z), _dot(out, places.geometric)
    lost = np.minimum(cos_out, cos_facet) <= GRAZING
    facet_in = np.maximum(_dot(toward, places.geometric), GRAZING)
    tilt = view[:, 2] / facet_in * cos_facet / np.where(lost, 1.0, cos_out)
    weight = np.where(lost, 0.0, weight * np.minimum(tilt, STEEPEST))
    survival = np.minimum(weight, SURVIVAL)
    survives = u[:, 3] < survival
    kept = np.where(survives, photons.flux * weight / np.where(survives, survival, 1.0), 0.0)
    after = replace(
        photons,
        origin=np.where(
            survives[:, None], places.point + OFFSET_MM * places.geometric, photons.origin
        ),
        direction=np.where(survives[:, None], _unit(out), photons.direction),
        flux=np.where(survives, kept, photons.flux),
        fresh=np.zeros(len(weight), dtype=bool),
        fate=np.where(survives, FLYING, ABSORBED),
    )
    return after, photons.flux * (1.0 - weight), photons.flux * weight - kept


def meet(
    photons: Photons,
    scene: Scene,
    face: np.ndarray,
    u: np.ndarray,
    v: np.ndarray,
    chances: np.ndarray,
) -> tuple[Photons, np.ndarray, np.ndarray]:
    """One event of every photon at its hit: photons after it, flux absorbed, flux cut off."""
    places = places_of(scene, photons.direction, face, u, v)
    wall = at_wall(photons, places, chances[:, 0], scene.refractive_index)
    skin, absorbed, cut = at_coating(photons, places, chances, scene)
    coated, from_outside = face < scene.skin_faces, ~places.outward
    inside = coated & places.outward
    skin = replace(
        skin,
        **{
            name: _where(inside, getattr(skin, name), getattr(photons, name))
            for name in ("origin", "direction", "flux", "fresh", "crossed")
        },
        fate=np.where(inside, skin.fate, np.where(from_outside, LEAKED, FLYING)),
    )
    fields = ("origin", "direction", "flux", "fresh", "crossed", "fate")
    after = {name: _where(coated, getattr(skin, name), getattr(wall, name)) for name in fields}
    return Photons(**after), np.where(inside, absorbed, 0.0), np.where(inside, cut, 0.0)


def expected_bins(toward: np.ndarray, frame: np.ndarray, received: np.ndarray) -> np.ndarray:
    """Mean of what one photon adds to each bin of a node, shape (SINES - 1, AZIMUTHS).

    Args:
        toward: Unit direction to where the light comes from, shape (3,).
        frame: Rows t, b, n, shape (3, 3).
        received: Perpendicular irradiance.
    """
    x, y, cosine = frame @ toward
    low, share = bin_shares(np.array([cosine]))
    bins = np.zeros((len(SINES) - 1, AZIMUTHS))
    turn = (np.arctan2(y, x) / (2.0 * np.pi) + 1.0) * AZIMUTHS
    left = int(np.floor(turn))
    for row, part in ((int(low[0]), 1.0 - share[0]), (int(low[0]) + 1, share[0])):
        bins[row, left % AZIMUTHS] += received * part * (1.0 - (turn - left))
        bins[row, (left + 1) % AZIMUTHS] += received * part * (turn - left)
    return bins


def _half_vector(view: np.ndarray, roughness: float, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    stretched = _unit(view * np.array([roughness, roughness, 1.0]))
    flat = stretched[:, 0] ** 2 + stretched[:, 1] ** 2
    level = np.column_stack([-stretched[:, 1], stretched[:, 0], np.zeros(len(view))])
    level /= np.sqrt(np.maximum(flat, 1e-30))[:, None]
    first = np.where((flat > 1e-9)[:, None], level, np.array([1.0, 0.0, 0.0]))
    second = np.cross(stretched, first)
    radius, around = np.sqrt(u), 2.0 * np.pi * v
    x, y = radius * np.cos(around), radius * np.sin(around)
    lean = 0.5 * (1.0 + stretched[:, 2])
    y = (1.0 - lean) * np.sqrt(np.maximum(1.0 - x**2, 0.0)) + lean * y
    z = np.sqrt(np.maximum(1.0 - x**2 - y**2, 0.0))
    found = x[:, None] * first + y[:, None] * second + z[:, None] * stretched
    found = found * np.array([roughness, roughness, 1.0])
    found[:, 2] = np.maximum(found[:, 2], 1e-6)
    return _unit(found)


def _masking(cos_in: np.ndarray, cos_out: np.ndarray, roughness: float) -> np.ndarray:
    """G2 / G1 of Smith's height-correlated masking."""
    here, there = np.maximum(cos_in, FLOOR), np.maximum(cos_out, FLOOR)
    root_in, root_out = (
        np.sqrt(roughness**2 + (1.0 - roughness**2) * cosine**2) for cosine in (here, there)
    )
    return there * (here + root_in) / (there * root_in + here * root_out)


def _schlick(cosine: np.ndarray, specular: float) -> np.ndarray:
    edge_on = min(50.0 * specular, 1.0)
    return specular + (edge_on - specular) * (1.0 - np.clip(cosine, 0.0, 1.0)) ** 5


def _across(normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    steep = np.abs(normal[:, :1]) > 0.9
    helper = np.where(steep, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]])
    x = _unit(np.cross(helper, normal))
    return x, np.cross(normal, x)


def _where(chosen: np.ndarray, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.where(chosen[:, None] if one.ndim == 2 else chosen, one, other)


def _dot(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    return np.einsum("ij,ij->i", left, right)


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-30)
