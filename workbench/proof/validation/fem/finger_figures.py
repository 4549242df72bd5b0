"""Makes the record of the finger at 45 degrees: `FINGER` of `finger_record`.

`python -m workbench.proof.validation.fem.finger_figures [JOBS]` takes 10 minutes of one core, most
of it the finest meshes. All cells are of one size, whose square the error of a force falls with;
meshes that are finer under the contact follow no power of it. A limit is Richardson's through the
two finest meshes; its uncertainty is what it lies beyond the finest, or from the limit of the two
coarsest, whichever is more.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import numpy as np

from workbench.core.press.indenter import BALL, IndenterKind
from workbench.proof.validation.contact.finger_record import FINGER
from workbench.proof.validation.fem.fem_presses import FRAMES, Case, solved

KINDS = (BALL, IndenterKind("cylinder_end"))
EDGES_MM = (0.9, 0.45, 0.3)
"""Of the meshes that the limits are extrapolated from."""
PATCH_MM = 9.0
"""Enough for totals: the ball's force is 0.13 % above that on 12 mm [mm]."""
SHEAR_MM = (0.0, 0.5)
DEPTHS_MM = (0.5, 1.0)


def figures(jobs: int = 1) -> dict[str, Any]:
    """All of them, for JSON.

    Args:
        jobs: Processes that solve presses.
    """
    meshes = [_case(kind, edge_mm) for kind in KINDS for edge_mm in EDGES_MM]
    finest_mm = min(EDGES_MM)
    plain = _case(BALL, finest_mm, friction=0.0)
    sheared = _case(BALL, finest_mm, shear_mm=SHEAR_MM)
    cases = [sheared, plain, *reversed(meshes)]
    with ProcessPoolExecutor(max_workers=jobs, mp_context=get_context("spawn")) as pool:
        found = dict(zip(cases, pool.map(forces_of, cases), strict=True))
    return {
        "press": "ball of 6 mm, or end of a cylinder of 6 mm with an edge of 0.45 mm, into the tip "
        "of the default finger at 45 degrees, friction 0.3, ten steps of 0.1 mm; forces in N",
        "patch_mm": PATCH_MM,
        "frictionless_N": found[plain]["1"],
        "sheared_N": found[sheared]["along_v"],
        "limits": {
            kind.value: {
                f"{depth_mm:g}": extrapolated(
                    [found[_case(kind, edge_mm)][f"{depth_mm:g}"] for edge_mm in EDGES_MM]
                )
                for depth_mm in DEPTHS_MM
            }
            for kind in KINDS
        },
    }


def _case(
    kind: IndenterKind,
    edge_mm: float,
    *,
    friction: float = 0.3,
    shear_mm: tuple[float, float] = (0.0, 0.0),
) -> Case:
    return Case(
        kind=kind,
        hex_mm=edge_mm,
        halvings=0,
        radius_mm=PATCH_MM,
        friction=friction,
        shear_mm=shear_mm,
    )


def forces_of(case: Case) -> dict[str, float]:
    """Normal forces by depth, and the last force against a shear along V [N]."""
    found = solved(case)
    by_depth = {f"{d:g}": float(found.normal_N[round(d * FRAMES) - 1]) for d in DEPTHS_MM}
    along_v = -float(found.reaction_N[-1] @ np.cross(found.normal, found.tangent_u))
    print(f"{case}: {by_depth}", file=sys.stderr, flush=True)
    return {name: round(force_N, 6) for name, force_N in (by_depth | {"along_v": along_v}).items()}


def extrapolated(forces_N: Sequence[float]) -> dict[str, Any]:
    """The limit of forces on the meshes of `EDGES_MM`, and how well it is known."""
    force_N = _at_edge_0(EDGES_MM[-2:], forces_N[-2:])
    before_N = _at_edge_0(EDGES_MM[-3:-1], forces_N[-3:-1])
    off_N = max(abs(force_N - forces_N[-1]), abs(force_N - before_N))
    return {
        "edges_mm": list(EDGES_MM),
        "forces_N": list(forces_N),
        "force_N": round(force_N, 6),
        "uncertainty_N": round(off_N, 6),
    }


def _at_edge_0(edges_mm: Sequence[float], forces_N: Sequence[float]) -> float:
    """F0 of F(h) = F0 + c h^2 through two meshes."""
    (coarse_mm, fine_mm), (coarse_N, fine_N) = edges_mm, forces_N
    return fine_N - fine_mm**2 / (coarse_mm**2 - fine_mm**2) * (coarse_N - fine_N)


def main(words: Sequence[str]) -> int:
    """Make the record."""
    jobs = int(words[0]) if words else 1
    FINGER.make(lambda: figures(jobs))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
