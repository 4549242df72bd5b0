"""Held-out presses of the finger solved anew by coarse finite elements, scored as others are."""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np

from sim.forces.network.spec import Target
from workbench.core.press.fem import DRAFT_MM, FemSettings
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.dataset.recipes import recipe_from_toml
from workbench.learning.evaluation.scoring import Scored, Way, scores_of
from workbench.learning.evaluation.sources import Source, open_source
from workbench.proof.validation.fem.fem_presses import finger

COARSE = "coarse"
"""Name of their scores beside that of predicting nothing."""


def recipe_of(source: Source) -> Recipe:
    """The recipe of a data set or a held-out set."""
    import tomli_w

    return recipe_from_toml(tomli_w.dumps(source.manifest["recipe"]), source=source.key)


@functools.cache
def _opened(data: Path) -> Source:
    return open_source(data)


def coarse_scores(data: Path, name: str) -> list[Scored]:
    """Scores of a case's frames on the skin of its set; none where that is no default finger's.

    Args:
        data: The held-out set.
        name: Of the case.

    Raises:
        StoreError: If the set is damaged.
        SolveError: If the press does not converge.
    """
    from sim.fem.press import solve_press
    from sim.forces.transfer import transferred

    source = _opened(data)
    recipe = recipe_of(source)
    coarse, fine = finger(DRAFT_MM), finger(recipe.hex_mm)
    if not _same_skin(fine, source):
        return []
    case = next(case for case in source.cases() if case.id == name)
    press = PressCase(
        indenter=recipe.indenter(case.indenter, case.drawn),
        press=case.press,
        fem=FemSettings(hex_mm=DRAFT_MM, error=False),
    )
    found = transferred(solve_press(coarse, recipe.material(case.drawn), press), coarse, fine)
    scored = []
    for frame in source.frames(case):
        force_N = np.asarray(found.contact_force_N[frame])
        fields = {COARSE: force_N, Way.ZERO: np.zeros_like(force_N)}
        scores = scores_of(source.sample(case, frame), Target.FORCE, fields, source.skin)
        scored.append(Scored(case=case, frame=frame, scores=scores))
    return scored


def _same_skin(mesh: MembraneMesh, source: Source) -> bool:
    """Whether a mesh's outer skin is that of the set, vertex by vertex."""
    here_mm, there_mm = mesh.outer.points_mm, source.skin.points_mm
    return here_mm.shape == there_mm.shape and bool(np.allclose(here_mm, there_mm, atol=1e-3))
