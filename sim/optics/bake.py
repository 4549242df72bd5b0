"""The light field: what arrives at each vertex of the undeformed skin from each point of light.

No model knows the camera or the press, so that changing those never bakes again:

    linear        a straight line (the paper's linear light field)
    plane_target  along the skin, in the plane of light, target and the target's normal (its text)
    plane_source  along the skin, in the plane of light, target and the skin's normal at the light
                  (its released code)
    geodesic      along the shortest way on the skin (the paper's geodesic light field)
    direct        a straight line with 1/r^2, the LED's lobe and cast shadows
    table, hybrid traced photons, see `transport`
    photons       nothing: they are traced anew for each frame

The first four are of the same strength everywhere. The planes in closed form: with L = S - T from
target to light, the curve where the plane with normal P cuts the skin has at T a tangent in the
plane and in the skin, hence along n_T x P.

`plane_target` has P = n_T x L, so of the two senses the one toward the light is the part of L
tangential to the skin, (L - (L . n_T) n_T) / |...|. `plane_source` has P = n_S x (T - S), n_S being
the normal of the skin nearest to the light, and likewise the sense on whose side the light is. The
paper does not say which sense it takes; the shorter way along the curve to where it comes nearest
to the light often sets out the other way, over the tip, see `checks.plane_closed_form`. Where light
and normal leave no plane, and where no way on the skin leads to the light, the straight line takes
their place.

Left out of all but the traced ones: refraction of the light's own path, and light scattered by the
skin. Source: SimTac, "Offline light field generation".
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim.optics.geodesic import SkinWays
from sim.optics.lights import Leds, place_leds
from sim.optics.places import check_lights
from workbench.core.errors import DesignError
from workbench.core.light import LightField, Scattered
from workbench.core.lighting import TABULATED, Lamp, LedRing, LightModel
from workbench.core.monitor import Monitor, silent
from workbench.core.optics import Transport
from workbench.core.results import MembraneMesh, Skin

DEGENERATE_SINE = 1e-3
"""Sine of the angle of L and n below which their plane is not defined in single precision."""
SKIN_OFFSET_MM = 5e-3
"""Shadow rays start this far inside the skin [mm]; single precision resolves 4e-6 at 50 mm."""

Field = tuple[np.ndarray, np.ndarray, Scattered | None]


def bake_light(
    mesh: MembraneMesh,
    ring: LedRing,
    lamps: Sequence[Lamp] = (),
    *,
    model: LightModel,
    transport: Transport | None = None,
    monitor: Monitor = silent,
) -> LightField:
    """Light field of the ring and the lamps on the skin that the camera sees.

    Args:
        mesh: The skins; light meets the seen one from inside.
        ring: The LEDs.
        lamps: Further lights.
        model: How light travels.
        transport: What traced photons meet; for `table` and `hybrid`.
        monitor: Progress and cancellation.

    Raises:
        DesignError: If a light is misplaced, emits nothing, or touches the skin; or if `geodesic`
            finds no way on a damaged skin.
    """
    check_lights(mesh, ring, lamps)
    leds = place_leds(ring, lamps)
    if model in TABULATED:
        found = _traced(mesh, leds, transport, monitor)
    else:
        found = _analytic(mesh, leds, model, _fields(ring, lamps), monitor)
    monitor(1.0, "light field ready")
    return light_field(leds, model, *found)


def light_field(
    leds: Leds,
    model: LightModel,
    direction: np.ndarray,
    irradiance: np.ndarray,
    scattered: Scattered | None,
) -> LightField:
    """What arrives at the vertices, together with the points of light that it comes from."""
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
        scattered=scattered,
    )


def _traced(mesh: MembraneMesh, leds: Leds, transport: Transport | None, monitor: Monitor) -> Field:
    from sim.optics.transport.gather import gather_light

    if transport is None:
        raise ValueError("traced light needs to know what the photons meet")
    return gather_light(mesh, leds, transport, monitor=monitor)


def _fields(ring: LedRing, lamps: Sequence[Lamp]) -> list[str]:
    """Field of the design that places each point of light, for messages."""
    found = ["optics.ring.radius_mm"] * ring.count
    for number, lamp in enumerate(lamps, start=1):
        found += [f"optics.lamps[{number}].position_mm"] * lamp.points
    return found


def _analytic(
    mesh: MembraneMesh, leds: Leds, model: LightModel, fields: list[str], monitor: Monitor
) -> Field:
    """The models that trace nothing; `photons` gets its straight lines only."""
    skin, count = mesh.seen, len(leds.position_mm)
    direction = np.empty((count, len(skin.points_mm), 3), dtype=np.float32)
    irradiance = np.ones(direction.shape[:2], dtype=np.float32)
    ways = SkinWays(skin) if model is LightModel.GEODESIC else None
    for number, place in enumerate(leds.position_mm):
        monitor(number / count, f"light {number + 1} of {count}")
        straight, distance = toward(place, skin.points_mm, at=fields[number])
        direction[number] = straight
        if model is LightModel.PLANE_TARGET:
            direction[number] = tangential(straight, skin.normals)
        elif model is LightModel.PLANE_SOURCE:
            direction[number] = tangential_from(straight, skin.normals, normal_at(skin, place))
        elif ways is not None:
            along = ways.toward(ways.nearest_vertex(place))
            direction[number] = np.where(np.isfinite(along), along, straight)
        elif model is LightModel.DIRECT:
            irradiance[number] = emitted(
                straight,
                distance,
                axis=leds.axis[number],
                exponent=float(leds.exponent[number]),
                cone=float(leds.cone[number]),
            )
    if model is LightModel.DIRECT:
        irradiance *= _unshadowed(mesh, leds.position_mm, monitor)
    elif model is LightModel.PHOTONS:
        irradiance[:] = 0.0
    return direction, irradiance, None


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


def tangential_from(
    direction: np.ndarray, normals: np.ndarray, source_normal: np.ndarray
) -> np.ndarray:
    """`plane_source` at each target, shape (N, 3): along n_T x (n_S x (T - S)), toward the light.

    Args:
        direction: Unit vectors from the targets to the light, shape (N, 3).
        normals: Unit normals of the targets, shape (N, 3).
        source_normal: n_S, shape (3,).
    """
    plane = np.cross(source_normal, -direction)
    tangent = np.cross(normals, plane)
    sine = np.linalg.norm(tangent, axis=1)
    defined = sine > DEGENERATE_SINE
    sense = np.where(np.einsum("ij,ij->i", tangent, direction) < 0.0, -1.0, 1.0)
    unit = tangent * (sense / np.where(defined, sine, 1.0))[:, None]
    return np.where(defined[:, None], unit, direction)


def emitted(
    direction: np.ndarray,
    distance_mm: np.ndarray,
    *,
    axis: np.ndarray,
    exponent: float,
    cone: float = 0.0,
) -> np.ndarray:
    """Perpendicular irradiance [1/mm2] per unit of power, I0 cos^m / r^2 within the cone.

    I0 = (m + 1) / (2 pi (1 - cone^(m + 1))), so that the power is the same for every cone.

    Args:
        direction: Unit vectors from the points to the LED, shape (N, 3).
        distance_mm: Their distances, shape (N,).
        axis: Unit emission axis of the LED, shape (3,).
        exponent: m; 0 shines evenly into the cone.
        cone: Cosine of half the emission cone [1]; 0 is the half space of the axis.
    """
    cosine = -(direction @ axis)
    lobe = np.where(cosine > cone, np.maximum(cosine, 0.0) ** exponent, 0.0)
    share = 1.0 - cone ** (exponent + 1.0)
    return (exponent + 1.0) / (2.0 * np.pi * share) * lobe / distance_mm**2


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
