"""Dents by geometry alone, at random: many more places, depths and turns than can be solved.

Their skin gives way to a rigid object without elasticity, and without a force: they teach what the
light makes of a shape, presses what shapes elastomers take. Now and then there are two.
"""

from __future__ import annotations

import numpy as np

from geometry.objects.indenters import primitive_mesh
from sim.optics.studio.geometric_dent import geometric_dent
from workbench.core.base.errors import WorkbenchError
from workbench.core.design.turning import turn_matrix
from workbench.core.result.results import Skin
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.dataset.variation import Drawn
from workbench.learning.readers.states import State

LEAST_MM, DEEPEST = 0.05, 1.2
"""Depth of a dent: from so much to so many depths of the solved presses."""
TILT_DEG = 20.0
"""Largest tilt of an object about either axis across the way of the press."""
TWO = 0.15
"""Share of views with two dents."""
TRIES = 8


def dent_state(
    recipe: Recipe, skin: Skin, targets_mm: np.ndarray, rng: np.random.Generator
) -> State:
    """Dents at random.

    Args:
        recipe: Its objects and their sizes are pressed in.
        skin: Undeformed, of V vertices.
        targets_mm: Places to choose from, shape (n, 3).
        rng: Chooses.
    """
    moved = np.zeros((len(skin.points_mm), 3))
    names: list[str] = []
    for _ in range(1 + int(rng.random() < TWO)):
        name, another = _dent(recipe, skin, targets_mm, rng)
        deeper = np.linalg.norm(another, axis=1) > np.linalg.norm(moved, axis=1)
        moved[deeper] = another[deeper]
        names.append(name)
    still = np.zeros_like(moved)
    return State(displacement_mm=moved, force_N=still, solved=False, name=" and ".join(names))


def _dent(
    recipe: Recipe, skin: Skin, targets_mm: np.ndarray, rng: np.random.Generator
) -> tuple[str, np.ndarray]:
    """An object's kind, and the displacement under it, (V, 3) [mm]."""
    low_mm, high_mm = recipe.vary.size_mm or (recipe.size_mm, recipe.size_mm)
    for _ in range(TRIES):
        kind = recipe.indenters[rng.integers(len(recipe.indenters))]
        size_mm = float(np.exp(rng.uniform(np.log(low_mm), np.log(high_mm))))
        drawn = Drawn(size_mm=size_mm, spin_deg=float(rng.uniform(-180.0, 180.0)))
        points_mm, faces = primitive_mesh(recipe.indenter(kind, drawn))
        about_x, about_y = rng.normal(0.0, TILT_DEG / 2.0, 2).clip(-TILT_DEG, TILT_DEG)
        points_mm = points_mm @ turn_matrix((float(about_x), float(about_y), 0.0)).T
        target_mm = targets_mm[rng.integers(len(targets_mm))]
        depth_mm = float(rng.uniform(LEAST_MM, DEEPEST * recipe.depth_mm))
        try:
            moved = geometric_dent(skin, points_mm, faces, target_mm=target_mm, depth_mm=depth_mm)
        except WorkbenchError:
            continue
        if moved.any():
            return f"{kind.value} {size_mm:.1f} mm", moved
    return "untouched", np.zeros((len(skin.points_mm), 3))
