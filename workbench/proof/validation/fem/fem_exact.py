"""Finite elements beside exact answers: patch test, derivatives of contact, Hertz's contact."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from workbench.core.design.design import Elastomer, Law
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.proof.row import Row, bounded, compared

if TYPE_CHECKING:
    from sim.fem.studies.hertz import HertzPress
    from sim.fem.studies.tangents import TangentErrors

PATCH_LIMIT = 1e-14
"""Machine precision is 2e-16; forces are sums of 64 terms."""
TANGENT_LIMIT = 1e-6
KINDS = (
    IndenterKind("sphere"),
    IndenterKind("cylinder_end"),
    IndenterKind("cylinder_side"),
    IndenterKind("cube"),
    IndenterKind("cone"),
    IndenterKind("torus"),
    IndenterKind("rhombus"),
)
"""All whose distance is in closed form, and two that are sampled."""
FORCE_LIMITS = {2: 0.1, 4: 0.05, 6: 0.025}
"""By cells in the contact radius: the limit is set on the finest mesh, doubled on each coarser."""
RADIUS_LIMIT = 0.03
LEAST_ORDER = 1.0
"""Displacements are piecewise trilinear, and the contact ends within a cell."""


def rows() -> list[Row]:
    """All rows of these."""
    return [*_patches(), *_tangents(), *_hertz()]


def _patches() -> list[Row]:
    from sim.fem.studies.patch import solve_patch

    found = []
    for law in Law:
        patch = functools.cache(functools.partial(solve_patch, law=law))
        case = f"27 irregular hexahedra, {law} law, strains to 0.35"
        found += [
            bounded(
                "patch_test",
                f"{case}: error of the displacement; null: where the solution began",
                lambda patch=patch: patch().displacement,
                unit="1",
                limit=PATCH_LIMIT,
                null=lambda patch=patch: patch().off,
            ),
            bounded(
                "patch_test",
                f"{case}: error of the force on a side; null: no force",
                lambda patch=patch: patch().force,
                unit="1",
                limit=PATCH_LIMIT,
                null=1.0,
            ),
        ]
    return found


@functools.cache
def _errors(kind: IndenterKind) -> TangentErrors:
    from sim.fem.studies.tangents import tangent_errors

    return tangent_errors(Indenter(kind=kind))


def _worst(part: str) -> float:
    """The largest of one error over all kinds."""
    return max(getattr(_errors(kind), part) for kind in KINDS)


def _tangents() -> list[Row]:
    names = f"worst of {len(KINDS)} objects ({', '.join(KINDS)})"
    found = [
        bounded(
            name,
            f"{what} against central differences at random points in contact, {names}; null: "
            "without the object's curvature",
            lambda part=part: _worst(part),
            unit="1",
            limit=TANGENT_LIMIT,
            null=lambda: _worst("uncurved"),
        )
        for name, part, what in (
            ("contact_tangent", "contact", "tangent of the normal traction"),
            ("friction_tangent", "friction", "tangent with friction, pressure and normal moving"),
            ("friction_tangent", "held", "tangent with friction, pressure and normal held"),
            ("contact_energy", "energy", "traction, pressure and normal held, and its potential"),
        )
    ]
    found.append(
        bounded(
            "friction_cone",
            f"largest tangential traction over mu times the normal one at random slips, {names}; "
            "null: friction that only sticks",
            lambda: _worst("cone"),
            unit="1",
            limit=1.0 + 1e-12,
            null=lambda: _worst("sticking"),
        )
    )
    return found


def _hertz() -> list[Row]:
    from sim.fem.studies import hertz

    material = Elastomer(law=Law.LINEAR, friction=0.0)
    force_N, radius_mm = hertz.exact_force_N(material), hertz.CONTACT_MM
    found = []
    for cells, force_limit in FORCE_LIMITS.items():
        case = f"ball R {hertz.RADIUS_MM:g} mm on a half-space, h = a / {cells}"
        found += [
            compared(
                "hertz_force",
                f"{case}; null: a flat punch as wide as the contact",
                lambda cells=cells: hertz.press_ball(cells).force_N,
                force_N,
                unit="N",
                limit=force_limit,
                null=hertz.flat_punch_N(material),
            ),
            compared(
                "hertz_radius",
                f"{case}: sqrt(5/2 <r^2>) of the pressure; null: where the plane cuts the ball",
                lambda cells=cells: hertz.press_ball(cells).moment_radius_mm,
                radius_mm,
                unit="mm",
                limit=RADIUS_LIMIT,
                null=hertz.overlap_radius_mm(),
            ),
        ]
    meshes = ", ".join(f"a / {cells}" for cells in FORCE_LIMITS)
    orders = (
        ("hertz_force_order", lambda press: press.force_N / force_N - 1.0),
        ("hertz_radius_order", lambda press: press.moment_radius_mm / radius_mm - 1.0),
    )
    return found + [
        bounded(
            name,
            f"power of h that the error falls with, least squares over {meshes}",
            functools.partial(_order, error),
            unit="1",
            limit=LEAST_ORDER,
            sense="min",
            null=0.0,
        )
        for name, error in orders
    ]


def _order(error: Callable[[HertzPress], float]) -> float:
    """Slope of the logarithm of the error over that of the cell's edge."""
    from sim.fem.studies.hertz import press_ball

    presses = [press_ball(cells) for cells in FORCE_LIMITS]
    sizes = np.log([press.edge_mm for press in presses])
    return float(np.polyfit(sizes, np.log([abs(error(press)) for press in presses]), 1)[0])
