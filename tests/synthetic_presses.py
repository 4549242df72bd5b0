"""A data set of made-up presses on a flat pad, written by the data sets' own code.

Forces of the finite elements are a round bump, those of the contact solver a wider one that is a
fifth too low; displacements likewise. Sheared frames carry a tangential share. So the contact
solver is wrong by a known shape, and a network has something to learn.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np

from tests.unit.test_dataset_cases import flat_skin
from workbench.core.press.indenter import IndenterKind
from workbench.core.result.results import Skin
from workbench.learning.dataset.begin import begin
from workbench.learning.dataset.cases import Case, cases_of
from workbench.learning.dataset.folder import DataSet
from workbench.learning.dataset.positions import Pattern
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.dataset.sample import Sample, Solved, to_bytes
from workbench.project.named_designs import load_design
from workbench.system.whole_files import write_atomically

KINDS = (IndenterKind.CROSS, IndenterKind.HEXAGON, IndenterKind.SPHERE, IndenterKind.FLOWER)
WIDTH_MM = {kind: 1.0 + 0.2 * number for number, kind in enumerate(KINDS)}
FORCE_N = 0.01
"""Nodal force at the middle of the deepest press."""


def pad_recipe(*, young_MPa: float = 0.145, cases: int = 40) -> Recipe:
    """Two depths and two frames of shear of four objects on the 25 places of the pad."""
    design = load_design("pad")
    material = dataclasses.replace(design.material, young_MPa=young_MPa)
    return Recipe(
        design=dataclasses.replace(design, material=material),
        pattern=Pattern.PAD,
        indenters=KINDS,
        depth_mm=0.4,
        depth_step_mm=0.2,
        shear_mm=0.2,
        shear_step_mm=0.1,
        shear_directions=4,
        images=False,
        cases=cases,
    )


def pad_skin(plan: Recipe, spacing_mm: float = 0.5) -> Skin:
    """A flat sheet at the height of the pad."""
    sheet = flat_skin(6.0, spacing_mm)
    height_mm = cases_of(plan)[0].position.target_mm[2]
    return dataclasses.replace(sheet, points_mm=sheet.points_mm + np.array([0.0, 0.0, height_mm]))


def made_up(folder: Path, *, young_MPa: float = 0.145, cases: int = 40) -> DataSet:
    """A whole data set."""
    plan = pad_recipe(young_MPa=young_MPa, cases=cases)
    skin = pad_skin(plan)
    data = begin(folder, plan.table, skin, cases_of(plan))
    for case in data.all_cases:
        for frame in range(case.frames):
            sample = made_up_sample(data, case, frame, young_MPa)
            write_atomically(data.path(case, frame), to_bytes(sample))
    return DataSet.open(folder)


def made_up_sample(data: DataSet, case: Case, frame: int, young_MPa: float = 0.145) -> Sample:
    """One state."""
    strength = case.depth_at(frame) / 0.4
    shear = np.array([*case.shear_at(frame), 0.0])
    away_mm = np.linalg.norm(data.skin.points_mm - case.position.target_mm, axis=1)
    width_mm = WIDTH_MM[case.indenter]
    push = np.array([0.0, 0.0, -1.0]) + shear
    stiff = young_MPa / 0.145

    def solved(widened: float, share: float) -> Solved:
        bump = np.exp(-0.5 * (away_mm / (widened * width_mm)) ** 2)
        bump = np.where(bump > 0.02, bump, 0.0)[:, None]
        force = share * stiff * FORCE_N * strength * bump * push
        return Solved(
            displacement_mm=(share * 0.4 * strength * np.sqrt(bump) * push).astype(np.float32),
            contact_force_N=force.astype(np.float32),
            sliding=np.zeros(len(away_mm), bool),
            reaction_N=-force.sum(axis=0),
            tangential_N=0.0,
            residual=1e-7,
            balance=1e-8,
            converged=True,
            seconds=0.1,
        )

    return Sample(
        case=case.id,
        frame=frame,
        recipe=data.key,
        indenter=case.indenter.value,
        depth_mm=case.depth_at(frame),
        shear_mm=case.shear_at(frame),
        pose=np.r_[case.position.target_mm, 1.0, 0.0, 0.0, 0.0],
        target_mm=np.array(case.position.target_mm),
        normal=np.array([0.0, 0.0, 1.0]),
        tangent_u=np.array([1.0, 0.0, 0.0]),
        mpm=solved(1.3, 0.8),
        fem=solved(1.0, 1.0),
    )
