"""The data card of trained weights: what they know, how they learned it, how good they are."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from sim.forces.network.spec import Target
from workbench.core.base.version import VERSION
from workbench.learning.dataset.cases import Split
from workbench.learning.training.beginning import Beginning
from workbench.learning.training.plan import Course
from workbench.learning.training.presses import INPUT, Presses, RestSkin

NAMED = 20
"""States that are named where they were left out."""


def data_card(
    presses: Presses,
    states: Sequence[int],
    target: Target,
    shown: Iterable[str] = (),
) -> dict[str, Any]:
    """What the weights were made of.

    Args:
        presses: All data.
        states: What was trained on.
        target: What is predicted.
        shown: Objects that weights which were tuned had seen before.
    """
    about = presses.about
    recipes = about["recipes"]
    recipe, design = recipes[0], recipes[0]["design"]
    material = design["material"]
    moved_mm = _largest_moves(presses, states)
    return {
        "target": target.value,
        "dataset": {
            "key": presses.key,
            "keys": list(about["keys"]),
            "sets": list(about["sets"]),
            "cases": len({state.case for state in presses.states}),
            "samples": len(presses.states),
            "per_split": _per_split(presses),
            "program": about["program"],
            "stages": dict(about["stages"]),
            "left_out": len(about["left_out"]),
            "left_out_names": list(about["left_out"][:NAMED]),
        },
        "hex_mm": recipe["hex_mm"],
        "grid_mm": recipe["grid_mm"],
        "solver_input": "mpm",
        "young_MPa": material["young_MPa"],
        "poisson": material["poisson"],
        "friction": material["friction"],
        "kinetic_friction": material.get("kinetic_friction", material["friction"]),
        "law": material["law"],
        "indenters": sorted({*shown, *(presses.states[number].indenter for number in states)}),
        "size_mm": sorted({size for each in recipes for size in _sizes_mm(each)}),
        "sizes_between": any("size_mm" in each.get("vary", {}) for each in recipes),
        "spun": any("spin_deg" in each.get("vary", {}) for each in recipes),
        "edge_radius_mm": max(float(each["edge_radius_mm"]) for each in recipes),
        "depth_mm": max(presses.states[number].depth_mm for number in states),
        "shear_mm": max(_shear_mm(each) for each in recipes),
        "membranes": [_membrane(skin) for skin in presses.skins],
        "displacement_p95_mm": float(np.percentile(moved_mm, 95.0)),
        "max_displacement_mm": float(moved_mm.max()),
    }


def _membrane(skin: RestSkin) -> dict[str, Any]:
    points_mm = skin.points_mm
    return {
        "design": dict(skin.design),
        "vertices": len(points_mm),
        "spacing_mm": skin.spacing_mm,
        "mesh_key": skin.mesh,
        "bounds_mm": [points_mm.min(axis=0).tolist(), points_mm.max(axis=0).tolist()],
        "area_mm2": _area_mm2(points_mm, skin.faces),
    }


def training_card(begun: Beginning, course: Course, *, cases: int) -> dict[str, Any]:
    """How the weights were made.

    Args:
        begun: What the training began with.
        course: What came of it.
        cases: How many the training samples are of.
    """
    plan, settings = begun.plan, begun.plan.settings
    return {
        "preset": settings.name,
        "seed": plan.seed,
        "epochs": len(course.rows),
        "epochs_planned": settings.epochs,
        "finished": course.finished,
        "best_epoch": course.best_epoch,
        "cases": cases,
        "samples": begun.samples,
        "parameters": begun.parameters,
        "seconds": course.seconds,
        "device": begun.resources.device,
        "rate": settings.rate,
        "peak_heed": settings.peak_heed,
        "batch": settings.batch,
        "turns": "any" if begun.patch_spacings else settings.turns,
        "patch_spacings": begun.patch_spacings,
        "tuned_from": plan.base_name,
        "program": VERSION,
    }


def _per_split(presses: Presses) -> dict[str, dict[str, int]]:
    return {
        split.value: {
            "cases": len(presses.cases(split)),
            "samples": len(presses.of_split(split)),
        }
        for split in Split
    }


def _largest_moves(presses: Presses, states: Sequence[int]) -> np.ndarray:
    """Largest displacement of each state's input [mm], shape (S,)."""
    field = presses.parts[INPUT]
    sizes = np.linalg.norm(field.values, axis=1)
    spans = [sizes[field.starts[n] : field.starts[n + 1]] for n in states]
    return np.array([float(own.max(initial=0.0)) for own in spans])


def _sizes_mm(recipe: Mapping[str, Any]) -> list[float]:
    """The size of a recipe's objects [mm], or the ends of the range that they are drawn from."""
    drawn = recipe.get("vary", {}).get("size_mm")
    return [float(size) for size in drawn or [recipe["size_mm"]]]


def _shear_mm(recipe: Mapping[str, Any]) -> float:
    return float(recipe["shear_mm"]) if recipe["shear_directions"] else 0.0


def _area_mm2(points_mm: np.ndarray, faces: np.ndarray) -> float:
    corners = points_mm[faces]
    crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(0.5 * np.linalg.norm(crossed, axis=1).sum())
