"""The light field: what arrives at each vertex of the undeformed skin from each LED.

Three models, none of which knows the camera, the coating or the press, so that changing those
never bakes again:

    linear        a straight line, the same strength everywhere (the paper's linear light field)
    plane_target  along the skin, in the plane of the LED, the target and the target's normal
                  (the paper's text); the same strength everywhere
    direct        a straight line with 1/r^2, the LED's cosine and cast shadows

`plane_target` in closed form: the curve where the plane with normal P = n x L cuts the skin has at
the target a tangent in the plane and in the skin, hence along n x P; of its two senses the one
toward the LED is the part of L tangential to the skin, (L - (L . n) n) / |...|. On convex and
non-convex skins alike this is the tangent at the target; no mesh is cut. Where L is along n there
is no plane, and the straight line takes its place.

Left out: refraction of the light's own path, and light scattered by the skin.
Source: SimTac, "Offline light field generation".
"""

from __future__ import annotations

import numpy as np

from sim.optics.lights import check_lights, place_leds
from workbench.core.errors import DesignError
from workbench.core.light import LightField
from workbench.core.lighting import LedRing, LightModel
from workbench.core.monitor import Monitor, silent
from workbench.core.results import MembraneMesh

DEGENERATE_SINE = 1e-3
"""Sine of the angle of L and n below which their plane is not defined in single precision."""
SKIN_OFFSET_MM = 5e-3
"""Shadow rays start this far inside the skin [mm]; single precision resolves 4e-6 at 50 mm."""


def bake_light(
    mesh: MembraneMesh, ring: LedRing, *, model: LightModel, monitor: Monitor = silent
) -> LightField:
    """Light field of an LED ring on the skin that the camera sees.

    Args:
        mesh: The skins; light meets the seen one from inside.
        ring: The LEDs.
        model: How light travels.
        monitor: Progress and cancellation.

    Raises:
        DesignError: If an LED is misplaced, emits nothing, or touches the skin.
    """
    check_lights(mesh, ring)
    leds = place_leds(ring)
    points, normals = mesh.seen.points_mm, mesh.seen.normals
    direction = np.empty((ring.count, len(points), 3), dtype=np.float32)
    irradiance = np.ones((ring.count, len(points)), dtype=np.float32)
    for number in range(ring.count):
        monitor(number / ring.count, f"light of LED {number + 1} of {ring.count}")
        straight, distance = toward(leds.position_mm[number], points)
        direction[number] = straight
        if model is LightModel.PLANE_TARGET:
            direction[number] = tangential(straight, normals)
        elif model is LightModel.DIRECT:
            irradiance[number] = emitted(
                straight, distance, axis=leds.axis[number], exponent=ring.emission_exponent
            )
    if model is LightModel.DIRECT:
        irradiance *= _unshadowed(mesh, leds.position_mm, monitor)
    monitor(1.0, "light field ready")
    return LightField(
        model=str(model),
        direction=direction,
        irradiance=irradiance,
        led_mm=leds.position_mm,
        led_axis=leds.axis,
        led_rgb=leds.rgb,
        led_exponent=leds.exponent,
        led_cone=leds.cone,
        led_size_mm=leds.size_mm,
    )


def toward(light_mm: np.ndarray, points_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors from points to a light, shape (N, 3), and their distances [mm], shape (N,).

    Raises:
        DesignError: If the light lies on a point.
    """
    line = light_mm - points_mm
    distance = np.linalg.norm(line, axis=1)
    if distance.size and distance.min() < SKIN_OFFSET_MM:
        raise DesignError(
            f"an LED is {distance.min():.3g} mm from the skin, less than {SKIN_OFFSET_MM:g} mm",
            hint="reduce the ring radius",
            at="optics.ring.radius_mm",
        )
    return line / distance[:, None], distance


def tangential(direction: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Unit tangent of the light's path at the target, toward the light: t = L - (L . n) n."""
    tangent = direction - np.einsum("ij,ij->i", direction, normals)[:, None] * normals
    sine = np.linalg.norm(tangent, axis=1)
    defined = sine > DEGENERATE_SINE
    return np.where(defined[:, None], tangent / np.where(defined, sine, 1.0)[:, None], direction)


def emitted(
    direction: np.ndarray, distance_mm: np.ndarray, *, axis: np.ndarray, exponent: float
) -> np.ndarray:
    """Perpendicular irradiance [1/mm2] per unit of power: I0 cos^m / r^2, I0 = (m + 1) / (2 pi).

    Args:
        direction: Unit vectors from the points to the LED, shape (N, 3).
        distance_mm: Their distances, shape (N,).
        axis: Unit emission axis of the LED, shape (3,).
        exponent: m; 0 shines evenly into the half space of the axis.
    """
    cosine = -(direction @ axis)
    lobe = np.where(cosine > 0.0, np.maximum(cosine, 0.0) ** exponent, 0.0)
    return (exponent + 1.0) / (2.0 * np.pi) * lobe / distance_mm**2


def _unshadowed(mesh: MembraneMesh, led_mm: np.ndarray, monitor: Monitor) -> np.ndarray:
    """1 where the undeformed skin lets an LED see a vertex, else 0, shape (L, V), float32.

    Only the seen skin is opaque: light passes the cavity wall and, without pins, the bonded face.
    """
    from geometry.rays import RayCaster

    skin = mesh.seen
    caster = RayCaster(skin.points_mm, skin.faces)
    start = skin.points_mm - SKIN_OFFSET_MM * skin.normals
    lit = np.empty((len(led_mm), len(start)), dtype=np.float32)
    for number, light in enumerate(led_mm):
        monitor(number / len(led_mm), f"shadows of LED {number + 1} of {len(led_mm)}")
        line, distance = toward(light, start)
        lit[number] = ~caster.occluded(start, line, distance)
    return lit
