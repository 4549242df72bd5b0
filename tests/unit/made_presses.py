"""Made-up presses for tests of training: dents in a sheet, and forces by a known local law.

u is a dent of random place, width, depth and direction; the force at a vertex is E times how far it
lies from its neighbours' mean, f = E (u - mean u) where that is more than a tenth of its largest
value: local, zero on most of the sheet, linear in E, and turned as u is turned.
"""

from __future__ import annotations

import numpy as np

from sim.forces.network.spec import NetworkSpec
from sim.forces.training.settings import TrainingSettings
from workbench.learning.dataset.cases import Split
from workbench.learning.training.presses import Presses, RestSkin, SparseField, State

SPEC = NetworkSpec(name="tiny", planes=(4, 4, 6, 6, 6, 4, 4, 4), stem_planes=4, stem_edge=3)
SETTINGS = TrainingSettings(
    name="tiny", spec=SPEC, rate=5e-3, batch=4, epochs=3, clip=1.0, averaging=0.9, turns=2
)
EDGE = 12
"""Vertices along an edge of the sheet, 1 mm apart."""
SHARES = (Split.TRAIN, Split.TRAIN, Split.TRAIN, Split.VALIDATION, Split.TEST, Split.UNSEEN)


def sheet(edge: int = EDGE) -> tuple[np.ndarray, np.ndarray]:
    """Vertices [mm] and triangles of a sheet with a bulge."""
    x, y = (axis.ravel() for axis in np.meshgrid(*2 * [np.arange(edge, dtype=float)]))
    middle = 0.5 * (edge - 1)
    z = 2.0 - ((x - middle) ** 2 + (y - middle) ** 2) / 50.0
    corner = (np.arange(edge - 1)[:, None] * edge + np.arange(edge - 1)).ravel()
    faces = np.concatenate(
        [
            np.stack([corner, corner + 1, corner + edge + 1], axis=1),
            np.stack([corner, corner + edge + 1, corner + edge], axis=1),
        ]
    )
    return np.stack([x, y, z], axis=1), faces.astype(np.int32)


def force_of(displacement_mm: np.ndarray, *, young: float = 0.1) -> np.ndarray:
    """The known law on a sheet, shape (V, 3) from (V, 3)."""
    edge = round(len(displacement_mm) ** 0.5)
    grid = displacement_mm.reshape(edge, edge, 3)
    padded = np.pad(grid, ((1, 1), (1, 1), (0, 0)))
    around = padded[:-2, 1:-1] + padded[2:, 1:-1] + padded[1:-1, :-2] + padded[1:-1, 2:]
    force = young * (grid - around / 4.0)
    size = np.linalg.norm(force, axis=2, keepdims=True)
    return np.where(size > 0.1 * size.max(), force, 0.0).reshape(-1, 3)


def dent(points_mm: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Displacement of a dent that ends within the sheet, shape (V, 3)."""
    edge = round(len(points_mm) ** 0.5)
    middle, radius = rng.uniform(3.0, edge - 4.0, 2), rng.uniform(2.0, 3.0)
    away = np.linalg.norm(points_mm[:, :2] - middle, axis=1) / radius
    shape = np.clip(1.0 - away**2, 0.0, None) ** 2
    way = np.array([*rng.normal(0.0, 0.3, 2), -1.0])
    return rng.uniform(0.2, 1.0) * shape[:, None] * way


def made_presses(
    cases: int = 12,
    *,
    frames: int = 2,
    edges: tuple[int, ...] = (EDGE,),
    young: float = 0.1,
    seed: int = 0,
) -> Presses:
    """Cases in all splits, on sheets in turn; the contact solver is right but for a tenth."""
    sheets = [sheet(edge) for edge in edges]
    rng, states = np.random.default_rng(seed), []
    fields: dict[str, list[np.ndarray]] = {}
    for number in range(cases):
        # Cases of one sheet come one after the other, as those of a data set do.
        skin = number * len(sheets) // cases
        full_mm = dent(sheets[skin][0], rng)
        for frame in range(frames):
            moved_mm = full_mm * (frame + 1) / frames
            force_N = force_of(moved_mm, young=young)
            states.append(
                State(
                    case=f"dent{number}",
                    frame=frame,
                    pair=f"dent@{number}",
                    split=SHARES[number % len(SHARES)],
                    indenter="dent",
                    depth_mm=float(np.abs(moved_mm).max()),
                    skin=skin,
                )
            )
            found = {
                "mpm.displacement_mm": moved_mm,
                "mpm.contact_force_N": 0.9 * force_N,
                "fem.displacement_mm": 1.1 * moved_mm,
                "fem.contact_force_N": force_N,
                "fem.cauchy_MPa": np.concatenate([force_N, -force_N], axis=1),
            }
            for name, values in found.items():
                fields.setdefault(name, []).append(values)
    return Presses(
        skins=tuple(
            RestSkin(
                points_mm=points_mm, faces=faces, mesh=f"sheet{number}", design={"name": "sheet"}
            )
            for number, (points_mm, faces) in enumerate(sheets)
        ),
        states=tuple(states),
        parts={name: SparseField.of(own, own[0].shape[1]) for name, own in fields.items()},
        about=made_about(young),
    )


def made_about(young: float) -> dict[str, object]:
    """What the card asks for, of a recipe that nobody made."""
    material = {"young_MPa": young, "poisson": 0.45, "friction": 0.3, "law": "neo_hookean"}
    recipe = {
        "design": {"name": "sheet", "material": material},
        "hex_mm": 0.9,
        "grid_mm": 0.5,
        "size_mm": 6.0,
        "edge_radius_mm": 0.45,
        "shear_mm": 0.5,
        "shear_directions": 8,
    }
    return {
        "sets": ["made"],
        "keys": ["made"],
        "recipes": [recipe],
        "stages": {"press": 7},
        "program": "0",
        "read_by": "0",
        "left_out": [],
    }
