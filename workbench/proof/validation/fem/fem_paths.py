"""Finite elements against themselves along paths: mirrored, divided, turned and taken back."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from workbench.core.press.indenter import IndenterKind
from workbench.proof.row import Row, bounded, compared
from workbench.proof.validation.fem.fem_presses import FRAMES, MIRROR, Case, finger, solved

END = 2 * FRAMES - 1
"""Frame at the end of the shear or twist."""
SHEAR_MM = 0.5
TWIST_DEG = 20.0
FRICTION = 0.3
NAME = "finger tip at 45 degrees, 1 mm deep, 0.9 mm hexahedra"
RIGHT = Case(shear_mm=(0.0, SHEAR_MM))
LEFT = Case(shear_mm=(0.0, -SHEAR_MM), mirrored=True)
CUBE = Case(kind=IndenterKind("cube"), shear_mm=(0.0, SHEAR_MM))
CUBE_LEFT = Case(kind=IndenterKind("cube"), shear_mm=(0.0, -SHEAR_MM), mirrored=True)
TWISTED = Case(kind=IndenterKind("cylinder_end"), twist_deg=TWIST_DEG)
BACK = Case(kind=IndenterKind("cylinder_end"), twist_deg=-TWIST_DEG)
FINE_STEPS = Case(shear_mm=(0.0, SHEAR_MM), increment_mm=0.025)
RELEASED = Case(shear_mm=(0.0, SHEAR_MM), released=True)
"""A case of its own: cells are halved along the whole path, also where it leaves."""
MIRROR_LIMIT = 1e-5
"""Both are solved to 1e-6 of the largest nodal load."""
TURNED_LIMIT = 1e-3
"""The mesh is not symmetric about the plane through the axis to better than this."""


def rows() -> list[Row]:
    """All rows of these."""
    return [*_mirrors(), *_increments(), *_released(), *_twisted(), _cone()]


def _mirrors() -> Iterator[Row]:
    for name, case, other in (("sphere", RIGHT, LEFT), ("cube", CUBE, CUBE_LEFT)):
        for what, field in (("displacement", "displacement_mm"), ("force", "contact_force_N")):
            yield bounded(
                "mirror",
                f"{name}, {NAME}, sheared {SHEAR_MM:g} mm to one side, and its mirror image to the "
                f"other: largest difference of the mirrored {what} of a vertex over the largest "
                "one; null: not mirrored",
                lambda case=case, other=other, field=field: _mirror_error(case, other, field),
                unit="1",
                limit=MIRROR_LIMIT,
                null=lambda case=case, other=other, field=field: _unmirrored(case, other, field),
            )


def _mirror_error(case: Case, other: Case, field: str) -> float:
    here, there = _at_end(case, field), _at_end(other, field)
    return float(np.abs(here - there * MIRROR).max() / np.abs(here).max())


def _unmirrored(case: Case, other: Case, field: str) -> float:
    here, there = _at_end(case, field), _at_end(other, field)
    return float(np.abs(here - there).max() / np.abs(here).max())


def _at_end(case: Case, field: str) -> np.ndarray:
    """A field at the end of the shear, shape (V, 3)."""
    return getattr(solved(case), field)[END].astype(np.float64)


def _increments() -> Iterator[Row]:
    for what, frame in (
        ("normal force of the press", FRAMES - 1),
        ("normal force after the shear", END),
    ):
        yield compared(
            "increments",
            f"{NAME}: {what}, increments of 0.1 mm against 0.025 mm, friction {FRICTION:g}; null: "
            "without friction",
            lambda frame=frame: float(solved(RIGHT).normal_N[frame]),
            lambda frame=frame: float(solved(FINE_STEPS).normal_N[frame]),
            unit="N",
            limit=5e-3,
            null=lambda: float(solved(Case(friction=0.0)).normal_N[-1]),
        )
    yield compared(
        "increments",
        f"{NAME}: tangential force after the shear of {SHEAR_MM:g} mm; null: none",
        lambda: float(solved(RIGHT).tangential_N[END]),
        lambda: float(solved(FINE_STEPS).tangential_N[END]),
        unit="N",
        limit=5e-3,
        null=0.0,
    )


def _released() -> Iterator[Row]:
    yield bounded(
        "release",
        f"{NAME}, sheared {SHEAR_MM:g} mm and released: largest displacement left over the depth; "
        "null: before the release",
        lambda: float(np.abs(solved(RELEASED).displacement_mm[-1]).max()),
        unit="1",
        limit=1e-6,
        null=lambda: float(np.abs(_at_end(RELEASED, "displacement_mm")).max()),
    )
    yield bounded(
        "release",
        f"{NAME}, sheared {SHEAR_MM:g} mm and released: force left",
        lambda: float(np.abs(solved(RELEASED).reaction_N[-1]).max()),
        unit="N",
        limit=1e-9,
        null=lambda: float(np.abs(solved(RELEASED).reaction_N[END]).max()),
    )


def _twisted() -> Iterator[Row]:
    case = f"end of a cylinder, {NAME}, twisted by {TWIST_DEG:g} degrees about the normal"
    yield bounded(
        "rotation",
        f"{case}: moment that resists the twist over mu F times the cylinder's radius",
        lambda: _moment_Nmm(TWISTED) / (FRICTION * float(solved(TWISTED).normal_N[-1]) * 3.0),
        unit="1",
        limit=0.3,
        sense="min",
        null=0.0,
    )
    yield bounded(
        "rotation",
        f"{case}: the same as a share of the moment with every point sliding around the axis",
        lambda: _moment_Nmm(TWISTED) / _most_moment_Nmm(TWISTED),
        unit="1",
        limit=1.0,
    )
    yield compared(
        "rotation",
        f"{case}: moment against that of the twist the other way, sign turned; null: not turned",
        lambda: _moment_Nmm(TWISTED),
        lambda: -_moment_Nmm(BACK),
        unit="N mm",
        limit=TURNED_LIMIT,
        null=lambda: _moment_Nmm(BACK),
    )


def _moment_Nmm(case: Case) -> float:
    """Moment about the outward normal against a right-handed twist, about the object's axis."""
    found = solved(case)
    return -float(found.moment_Nmm[-1] @ found.normal)


def _most_moment_Nmm(case: Case) -> float:
    """mu times the sum of pressure forces and their distances from the axis."""
    found = solved(case)
    force_N = found.contact_force_N[-1].astype(np.float64)
    place_mm = finger(case.hex_mm).outer.points_mm + found.displacement_mm[-1]
    arm_mm = place_mm - found.indenter_pose[-1, :3]
    arm_mm -= np.outer(arm_mm @ found.normal, found.normal)
    return FRICTION * float(np.linalg.norm(force_N, axis=1) @ np.linalg.norm(arm_mm, axis=1))


def _cone() -> Row:
    cases = (RIGHT, LEFT, CUBE, CUBE_LEFT, TWISTED, BACK, FINE_STEPS, RELEASED)
    return bounded(
        "friction_cone",
        f"largest tangential traction over mu times the normal one in all frames of "
        f"{len(cases)} paths with shear or twist; {NAME}",
        lambda: max(float(solved(case).friction_ratio.max()) for case in cases) / FRICTION,
        unit="1",
        limit=1.0 + 1e-12,
    )
