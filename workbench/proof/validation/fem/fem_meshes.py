"""Finite elements against themselves on larger cut-outs and finer meshes of the finger."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from workbench.core.press.indenter import IndenterKind
from workbench.proof.row import Row, bounded, compared, stated
from workbench.proof.validation.fem.fem_presses import Case, solved

RADIUS_MM, WHOLE_MM = 12.0, 20.0
DISPLACEMENT_LIMIT_MM = 3e-3
"""What `FIELD_RADIUS_MM` promises, for the skin that moves by `MOVED_MM`."""
MOVED_MM = 0.1
FORCE_LIMIT = 5e-3
PATCH_MM = 7.0
"""Radius of the patch on which the figures below were found [mm]."""
PROTOTYPE_N = {0.9: 1.424, 0.45: 1.308}
"""Normal force [N] by edge of the hexahedra, of another program: a prototype with mean-dilatation
hexahedra, hard contact, and a mesher of its own, which is not kept."""
FINEST_MM = 0.3
FINEST_PROTOTYPE_N = {FINEST_MM: 1.291}
CALCULIX_N = 1.276
"""C3D8I of CalculiX on the prototype's patch of `FINEST_MM`, friction 0.3."""
REFINEMENT_LIMIT = 0.015
"""Meshes of one spacing by two meshers differ by up to a percent; from 0.9 to 0.3 mm it is ten."""
CASE = "sphere, finger tip at 45 degrees, 1 mm deep"


def rows() -> list[Row]:
    """All rows of these but the finest mesh."""
    return [*_submodels(), *_refinements(PROTOTYPE_N)]


def fine_rows() -> list[Row]:
    """The finest mesh, which takes minutes."""
    edge_mm = FINEST_MM
    return [
        *_refinements(FINEST_PROTOTYPE_N),
        compared(
            "refinement_calculix",
            f"{CASE}, {edge_mm:g} mm, patch of {PATCH_MM:g} mm: against C3D8I of CalculiX on the "
            "same patch; null: the published 0.9 mm mesh",
            lambda: _patch_force_N(edge_mm),
            CALCULIX_N,
            unit="N",
            limit=0.03,
            null=lambda: _patch_force_N(0.9),
        ),
    ]


def _submodels() -> Iterator[Row]:
    for kind in (IndenterKind("sphere"), IndenterKind("cube")):
        cut = Case(kind=kind, radius_mm=RADIUS_MM)
        whole = Case(kind=kind, radius_mm=WHOLE_MM)
        case = f"{kind}, finger, 0.9 mm hexahedra, within {RADIUS_MM:g} mm against {WHOLE_MM:g} mm"
        yield bounded(
            "submodel",
            f"{case}: mean error of the displacement where it is {MOVED_MM:g} mm or more; null: "
            "no displacement",
            lambda cut=cut, whole=whole: _errors(cut, whole, "displacement_mm", MOVED_MM)[0],
            unit="mm",
            limit=DISPLACEMENT_LIMIT_MM,
            null=lambda cut=cut, whole=whole: _errors(cut, whole, "displacement_mm", MOVED_MM)[1],
        )
        yield stated(
            "submodel_worst",
            f"{case}: largest error of the displacement anywhere, the held rim included; null: "
            "largest displacement",
            lambda cut=cut, whole=whole: _worst_mm(cut, whole),
            unit="mm",
            null=lambda whole=whole: float(
                np.linalg.norm(solved(whole).displacement_mm[-1], axis=1).max()
            ),
        )
        yield bounded(
            "submodel",
            f"{case}: mean error over mean contact force of the vertices in contact; null: no "
            "force",
            lambda cut=cut, whole=whole: _share(_errors(cut, whole, "contact_force_N", 0.0)),
            unit="1",
            limit=FORCE_LIMIT,
            null=1.0,
        )
        yield compared(
            "submodel",
            f"{case}: normal force; null: within 5 mm",
            lambda cut=cut: float(solved(cut).normal_N[-1]),
            lambda whole=whole: float(solved(whole).normal_N[-1]),
            unit="N",
            limit=1e-3,
            null=lambda kind=kind: float(solved(Case(kind=kind, radius_mm=5.0)).normal_N[-1]),
        )


def _errors(cut: Case, whole: Case, field: str, least: float) -> tuple[float, float]:
    """Mean distance of two fields, and mean size of the second, where that exceeds `least`."""
    here, there = (getattr(solved(case), field)[-1].astype(np.float64) for case in (cut, whole))
    size = np.linalg.norm(there, axis=1)
    chosen = size > least
    return float(np.linalg.norm(here - there, axis=1)[chosen].mean()), float(size[chosen].mean())


def _share(errors: tuple[float, float]) -> float:
    return errors[0] / errors[1]


def _worst_mm(cut: Case, whole: Case) -> float:
    here, there = (solved(case).displacement_mm[-1].astype(np.float64) for case in (cut, whole))
    return float(np.linalg.norm(here - there, axis=1).max())


def _refinements(known_N: dict[float, float]) -> Iterator[Row]:
    for edge_mm, force_N in known_N.items():
        yield compared(
            "refinement",
            f"{CASE}, {edge_mm:g} mm hexahedra, patch of {PATCH_MM:g} mm: against a "
            "prototype's figure; null: without friction, 0.9 mm",
            lambda edge_mm=edge_mm: _patch_force_N(edge_mm),
            force_N,
            unit="N",
            limit=REFINEMENT_LIMIT,
            null=lambda: _patch_force_N(0.9, friction=0.0),
        )


def _patch_force_N(edge_mm: float, *, friction: float = 0.3) -> float:
    case = Case(hex_mm=edge_mm, halvings=0, radius_mm=PATCH_MM, friction=friction)
    return float(solved(case).normal_N[-1])
