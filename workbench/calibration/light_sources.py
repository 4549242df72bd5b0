"""The lights that a calibration fits one by one: those of the design, or candidates around it.

Where the owner does not know the LEDs, candidates stand around the body: in the clear support at
its base and beside the roof or plate that the membrane lies on, and in the cavity at its base and
half way up. Fitting finds which of them shine.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from sim.optics.camera.inside_skin import wall_radius
from sim.optics.light.places import check_lights
from workbench.core.base.errors import DesignError
from workbench.core.design.leds import led_places
from workbench.core.design.lighting import Lamp, LampKind, LedMount, LedRing
from workbench.core.design.optics import Optics
from workbench.core.result.results import MembraneMesh

AROUND = 12
"""Candidates on each circle."""
SIZE_MM = 1.0
"""Emitting disc of a candidate [mm]."""
WHITE = "#ffffff"
NO_RING = LedRing(count=0)
UP = np.array([0.0, 0.0, 1.0])
CIRCLES = (
    (LedMount.SHELL, 0.97, (-1.0, 0.0)),
    (LedMount.SHELL, 0.02, (0.0, 1.0)),
    (LedMount.CAVITY, 0.02, (0.0, 1.0)),
    (LedMount.CAVITY, 0.55, (-0.7, 0.7)),
)
"""Mount, height over that of the support or cavity, and outward and upward part of the axis."""
OVER_BASE = 0.5
"""Height over that of the support from which a candidate is not at its base [1]."""
PLATE_EDGE = 0.08
"""Twice the distance of a candidate from the edge of a plate, over the plate's radius [1]."""
JUST_ABOVE_MM = 0.2
OF_CAVITY = 0.85
"""Radius of a candidate in the cavity over that of the cavity there [1]."""


def single_lights(optics: Optics) -> list[Lamp]:
    """The design's LEDs and lamps one by one, white, of power 1: the ring's as lamps."""
    ring = optics.ring
    places, axes = led_places(ring)
    leds = [
        Lamp(
            kind=LampKind.POINT,
            position_mm=_three(place),
            axis=_three(axis),
            size_mm=ring.size_mm,
            emission_exponent=ring.emission_exponent,
            cone_deg=ring.cone_deg,
            mount=ring.mount,
            colour=WHITE,
        )
        for place, axis in zip(places, axes, strict=True)
    ]
    lamps = [dataclasses.replace(lamp, power=1.0, colour=WHITE) for lamp in optics.lamps]
    return leds + lamps


def candidates(mesh: MembraneMesh) -> list[Lamp]:
    """Lights wherever LEDs are usually put, as far as the body has room there."""
    found = []
    for mount, share, (outward, upward) in CIRCLES:
        skin = mesh.inner if mount is LedMount.SHELL else mesh.cavity
        low, high = float(mesh.cavity.points_mm[:, 2].min()), float(skin.points_mm[:, 2].max())
        height_mm = low + max(share * (high - low), 0.3)
        for turn in 2.0 * np.pi * np.arange(AROUND) / AROUND:
            around = np.array([np.cos(turn), np.sin(turn), 0.0])
            lamp = _candidate(mesh, mount, around, height_mm, (outward, upward))
            if lamp is not None:
                found.append(lamp)
    return found


def _candidate(
    mesh: MembraneMesh,
    mount: LedMount,
    around: np.ndarray,
    height_mm: float,
    axis: tuple[float, float],
) -> Lamp | None:
    """A light at an azimuth and height; None where there is no room."""
    probe = around + height_mm * UP
    cavity = wall_radius(mesh.cavity, probe)
    if mount is LedMount.SHELL:
        if height_mm > OVER_BASE * plate_mm(mesh) and np.isfinite(wall_radius(mesh.inner, probe)):
            # High up only the edge of a plate takes LEDs, not the dome of a finger.
            return None
        inner = _support_mm(mesh, around, height_mm)
        # A plate is solid from edge to edge: the lights stand at its edge.
        solid_mm = inner - cavity if np.isfinite(cavity) else PLATE_EDGE * inner
        radius_mm = inner - 0.5 * solid_mm
    else:
        radius_mm = OF_CAVITY * cavity
    if not np.isfinite(radius_mm):
        return None
    place = radius_mm * around + height_mm * UP
    lamp = Lamp(
        kind=LampKind.POINT,
        position_mm=_three(place),
        axis=_three(axis[0] * around + axis[1] * UP),
        size_mm=SIZE_MM,
        mount=mount,
        colour=WHITE,
    )
    try:
        check_lights(mesh, NO_RING, (lamp,))
    except DesignError:
        return None
    return lamp


def _support_mm(mesh: MembraneMesh, around: np.ndarray, height_mm: float) -> float:
    """Outer radius of the support at an azimuth and height [mm]; inf without any.

    Where the membrane lies on top of a plate, the plate is as wide as the membrane.
    """
    inner = wall_radius(mesh.inner, around + height_mm * UP)
    if np.isfinite(inner):
        return inner
    return wall_radius(mesh.outer, around + (plate_mm(mesh) + JUST_ABOVE_MM) * UP)


def plate_mm(mesh: MembraneMesh) -> float:
    """Height of the support's top [mm]."""
    return float(mesh.inner.points_mm[:, 2].max())


def _three(vector: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in vector)
    return x, y, z
