"""Mass, centre and inertia of bodies, alone and together, in SI units."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from workbench.core.base.errors import GeometryError

M_OF_MM = 1e-3
KG_OF_G_CM3_MM3 = 1e-6
"""Mass [kg] of 1 mm3 at 1 g/cm3."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Inertia:
    """Of a rigid body, in the sensor's axes."""

    mass_kg: float
    centre_m: np.ndarray
    """Centre of mass, shape (3,)."""
    tensor_kgm2: np.ndarray
    """About the centre of mass, shape (3, 3)."""


def of_body(points_mm: np.ndarray, faces: np.ndarray, density_g_cm3: float) -> Inertia:
    """Inertia of the solid inside a closed surface.

    Args:
        points_mm: Vertices, shape (N, 3).
        faces: Triangles, counter-clockwise from outside, shape (M, 3).
        density_g_cm3: Of the material.

    Raises:
        GeometryError: If the surface encloses no volume.
    """
    import trimesh

    body = trimesh.Trimesh(points_mm, faces, process=False)
    body.density = density_g_cm3 * KG_OF_G_CM3_MM3
    found = body.mass_properties
    if not found.mass > 0.0:
        raise GeometryError(
            f"a surface of {len(faces)} triangles encloses {body.volume:.3g} mm3, no volume that "
            "could have a mass",
            hint="close the surface and turn its faces outwards",
        )
    return Inertia(
        mass_kg=float(found.mass),
        centre_m=np.asarray(found.center_mass) * M_OF_MM,
        tensor_kgm2=np.asarray(found.inertia) * M_OF_MM**2,
    )


def together(bodies: Iterable[Inertia]) -> Inertia:
    """Inertia of bodies fixed to each other: Steiner's theorem about the common centre."""
    parts = list(bodies)
    mass_kg = sum(part.mass_kg for part in parts)
    centre_m = sum(part.mass_kg * part.centre_m for part in parts) / mass_kg
    tensor = np.zeros((3, 3))
    for part in parts:
        arm = part.centre_m - centre_m
        tensor += part.tensor_kgm2 + part.mass_kg * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return Inertia(mass_kg=mass_kg, centre_m=np.asarray(centre_m), tensor_kgm2=tensor)
