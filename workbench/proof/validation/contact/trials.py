"""Presses that try the contact engine: 14 objects on five families, three places, three motions.

Places are the family's own target and two more vertices of its outer skin, at thirds of the order
by distance from that target, away from the rim of the skin, where an object would stand half in
the air. Bodies are built by the CAD kernel once; `save` writes their skins and lattices for a
machine without it.
"""

from __future__ import annotations

import dataclasses
import enum
import functools
import itertools
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from workbench.core.base import codec
from workbench.core.base.monitor import silent
from workbench.core.design.design import Layers, Meshing
from workbench.core.press.indenter import SEEN, UNSEEN, Indenter, IndenterKind
from workbench.core.press.press import ContactSettings, Press
from workbench.core.result.results import MaterialPoints, MembraneMesh, Skin
from workbench.proof.validation.geometry.meshes import default_solid

FAMILIES = ("finger", "trunk", "paw", "thumb", "pad")
PLACES = 3
SIZE_MM = 6.0
DEPTH_SHARE = 0.4
"""Depth over the thickness of the wall at the target: 0.8 mm on 2 mm."""
SHEAR_MM = (0.5, 0.0)
TWIST_DEG = 20.0
FRAMES = 2
RIM_MM = 4.0
"""Least distance of a chosen place from the rim of the skin: an object's half width and 1 mm."""


class Motion(enum.StrEnum):
    """What the object does; shear and twist follow a press."""

    PRESS = "press"
    SHEAR = "shear"
    TWIST = "twist"


@dataclass(frozen=True, kw_only=True, slots=True)
class Trial:
    """One press."""

    family: str
    kind: IndenterKind
    place: int
    motion: Motion

    def __str__(self) -> str:
        return f"{self.family}, {self.kind}, place {self.place + 1}, {self.motion}"


@dataclass(frozen=True, kw_only=True, slots=True)
class Sensor:
    """A body ready to be pressed."""

    mesh: MembraneMesh
    points: MaterialPoints
    targets_mm: np.ndarray
    """Places on the outer skin [mm], shape (PLACES, 3)."""
    walls_mm: np.ndarray
    """Distance of each from the support [mm], shape (PLACES,)."""


def every_trial() -> list[Trial]:
    """All 630 of them, family by family."""
    return [
        Trial(family=family, kind=kind, place=place, motion=motion)
        for family, motion, place, kind in itertools.product(
            FAMILIES, Motion, range(PLACES), (*SEEN, *UNSEEN)
        )
    ]


def some_trials(count: int, seed: int) -> list[Trial]:
    """A random choice without repetition, in the order of `every_trial`; the same for a seed."""
    everything = every_trial()
    chosen = np.random.default_rng(seed).permutation(len(everything))[:count]
    return [everything[number] for number in sorted(chosen.tolist())]


def path_of(trial: Trial, sensor: Sensor) -> Press:
    """The press of a trial."""
    x, y, z = sensor.targets_mm[trial.place].tolist()
    return Press(
        target_mm=(x, y, z),
        depth_mm=round(DEPTH_SHARE * float(sensor.walls_mm[trial.place]), 3),
        shear_mm=SHEAR_MM if trial.motion is Motion.SHEAR else (0.0, 0.0),
        twist_deg=TWIST_DEG if trial.motion is Motion.TWIST else 0.0,
        frames=FRAMES,
    )


def object_of(trial: Trial) -> Indenter:
    """The object of a trial, with the default rounding of its edges."""
    return Indenter(kind=trial.kind, size_mm=SIZE_MM)


@functools.cache
def sensor(family: str) -> Sensor:
    """The default shape of a family, without hexahedra, which contact does not look at."""
    from workbench.pipeline.stages.lattice import LatticeInputs, lattice
    from workbench.pipeline.stages.mesh import MeshInputs, mesh

    solid = default_solid(family)
    meshes = mesh(MeshInputs(solid=solid, meshing=Meshing()), monitor=silent)
    points = lattice(LatticeInputs(solid=solid, grid_mm=ContactSettings().grid_mm), monitor=silent)
    return placed(family, dataclasses.replace(meshes, hexes=None, cavity=meshes.inner), points)


def placed(family: str, mesh: MembraneMesh, points: MaterialPoints) -> Sensor:
    """Choose the places on a sensor of a family."""
    from designs.family import family as find_family
    from designs.family import resolve_shape
    from geometry.surface.surface import closest_point

    own_mm = np.array(find_family(family).target(resolve_shape(family, {}), Layers()))
    rim_mm = mesh.outer.points_mm[rim(mesh.outer)]
    order = np.argsort(np.linalg.norm(mesh.outer.points_mm - own_mm, axis=1), kind="stable")
    ordered = mesh.outer.points_mm[order]
    inside = [p for p in ordered if np.linalg.norm(rim_mm - p, axis=1).min(initial=99.0) > RIM_MM]
    others = [inside[len(inside) * third // PLACES] for third in range(1, PLACES)]
    targets_mm = np.stack([own_mm, *others])
    _, walls_mm, _ = closest_point(mesh.inner.points_mm, mesh.inner.faces, targets_mm)
    return Sensor(mesh=mesh, points=points, targets_mm=targets_mm, walls_mm=walls_mm)


def rim(skin: Skin) -> np.ndarray:
    """Vertices of edges that belong to one triangle."""
    edges = np.sort(np.concatenate([skin.faces[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))]))
    unique, counts = np.unique(edges, axis=0, return_counts=True)
    return np.unique(unique[counts == 1])


def save(path: Path) -> None:
    """Write all sensors to one file (.npz)."""
    bodies = {family: (sensor(family).mesh, sensor(family).points) for family in FAMILIES}
    arrays, tree = codec.pack(bodies)
    text = np.frombuffer(json.dumps(tree).encode(), np.uint8)
    np.savez_compressed(path, **{"__tree__": text, **arrays})  # pyright: ignore[reportArgumentType]


def load(path: Path) -> dict[str, Sensor]:
    """Read what `save` wrote."""
    with np.load(path) as file:
        arrays = dict(file)
    tree = json.loads(arrays.pop("__tree__").tobytes())
    bodies = codec.unpack(arrays, tree)
    return {family: placed(family, *body) for family, body in bodies.items()}
