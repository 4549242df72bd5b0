"""Lines of light from points to a source: their directions, tangents and shadows.

With L = S - T from target to light, the curve where the plane with normal P cuts the skin has at T
a tangent in the plane and in the skin, hence along n_T x P. The paper does not say which sense it
takes; here it is the one on whose side the light is. The shorter way along the curve to where it
comes nearest to the light often sets out the other way, over the tip, see
`checks.plane_closed_form`. Where light and normal leave no plane, the straight line takes the place
of the tangent. Source: SimTac, "Offline light field generation".
"""

from __future__ import annotations

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor
from workbench.core.result.results import MembraneMesh, Skin

DEGENERATE_SINE = 1e-3
"""Sine of the angle of L and n below which their plane is not defined in single precision."""
SKIN_OFFSET_MM = 5e-3
"""Shadow rays start this far inside the skin [mm]; single precision resolves 4e-6 at 50 mm."""
ON_AXIS_MM = 1e-9


def toward(
    light_mm: np.ndarray, points_mm: np.ndarray, *, at: str = "optics.ring.radius_mm"
) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors from points to a light, shape (N, 3), and their distances [mm], shape (N,).

    Raises:
        DesignError: If the light lies on a point.
    """
    line = light_mm - points_mm
    distance = np.linalg.norm(line, axis=1)
    if distance.size and distance.min() < SKIN_OFFSET_MM:
        raise DesignError(
            f"a light is {distance.min():.3g} mm from the skin, less than {SKIN_OFFSET_MM:g} mm",
            hint="move it nearer to the axis",
            at=at,
        )
    return line / distance[:, None], distance


def tangential(direction: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Unit tangent of the light's path at the target, toward the light: t = L - (L . n) n."""
    tangent = direction - np.einsum("ij,ij->i", direction, normals)[:, None] * normals
    sine = np.linalg.norm(tangent, axis=1)
    defined = sine > DEGENERATE_SINE
    return np.where(defined[:, None], tangent / np.where(defined, sine, 1.0)[:, None], direction)


def normal_at(skin: Skin, place_mm: np.ndarray) -> np.ndarray:
    """Normal of the skin at the vertex nearest to a place [mm], shape (3,)."""
    nearest = int(np.argmin(np.linalg.norm(skin.points_mm - place_mm, axis=1)))
    return skin.normals[nearest]


def from_axis(place_mm: np.ndarray) -> np.ndarray:
    """Unit way from the sensor's axis to a place [mm], shape (3,); 0 for a place on the axis."""
    way = place_mm * [1.0, 1.0, 0.0]
    length_mm = float(np.linalg.norm(way))
    return way / length_mm if length_mm > ON_AXIS_MM else np.zeros(3)


def tangential_from(
    direction: np.ndarray, normals: np.ndarray, source_normal: np.ndarray
) -> np.ndarray:
    """Tangents at each target, shape (N, 3): along n_T x (n_S x (T - S)), toward the light.

    Args:
        direction: Unit vectors from the targets to the light, shape (N, 3).
        normals: Unit normals of the targets, shape (N, 3).
        source_normal: n_S, shape (3,); of length 1, or 0 where it is not defined.
    """
    plane = np.cross(source_normal, -direction)
    tangent = np.cross(normals, plane)
    sine = np.linalg.norm(tangent, axis=1)
    defined = sine > DEGENERATE_SINE
    sense = np.where(np.einsum("ij,ij->i", tangent, direction) < 0.0, -1.0, 1.0)
    unit = tangent * (sense / np.where(defined, sine, 1.0))[:, None]
    return np.where(defined[:, None], unit, direction)


def unshadowed(mesh: MembraneMesh, led_mm: np.ndarray, monitor: Monitor) -> np.ndarray:
    """1 where the undeformed skin lets an LED see a vertex, else 0, shape (L, V), float32.

    Only the seen skin is opaque: light passes the cavity wall and, without pins, the bonded face.
    """
    from geometry.surface.rays import RayCaster

    skin = mesh.seen
    caster = RayCaster(skin.points_mm, skin.faces)
    start = skin.points_mm - SKIN_OFFSET_MM * skin.normals
    lit = np.empty((len(led_mm), len(start)), dtype=np.float32)
    for number, light in enumerate(led_mm):
        monitor(number / len(led_mm), f"shadows of LED {number + 1} of {len(led_mm)}")
        line, distance = toward(light, start)
        lit[number] = ~caster.occluded(start, line, distance)
    return lit
