"""What light and camera depend on besides powers, and how well the designer knew it before.

Each unknown is an amount added to what the design says: the camera's place and turn, its field of
view and the lens's fall-off, the place of each LED outward, around and up, the lobe of the LEDs,
gloss and roughness of the coating. Its prior is a normal distribution about 0.

A value is bounded by what the body has room for: a light or a camera that would stand in another
layer is moved half as far, and half of that again.
"""

from __future__ import annotations

import dataclasses
import enum
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from sim.optics.light.places import check_camera, check_lights
from workbench.calibration.light_sources import NO_RING
from workbench.core.base.errors import DesignError
from workbench.core.base.units import radians
from workbench.core.design.camera import WIDEST_DEG, Camera
from workbench.core.design.design import SensorDesign
from workbench.core.design.lighting import Lamp
from workbench.core.design.optics import Coating
from workbench.core.result.results import MembraneMesh

HALVINGS = 4
"""Times that a step is halved to find room; then the light stays."""
ON_AXIS_MM = 0.1
"""Nearer to the axis, outward is along x."""
MOST_EXPONENT, LEAST_ROUGHNESS, MOST_SPECULAR = 20.0, 0.02, 0.95
UP = np.array([0.0, 0.0, 1.0])
Moved = TypeVar("Moved", Camera, Lamp)


class Kind(enum.StrEnum):
    """What an unknown changes."""

    CAMERA_PLACE = "camera_place"
    CAMERA_TURN = "camera_turn"
    FIELD_OF_VIEW = "field_of_view"
    FALLOFF = "falloff"
    LED_PLACE = "led_place"
    LOBE = "lobe"
    ROUGHNESS = "roughness"
    GLOSS = "gloss"

    @property
    def of_camera(self) -> bool:
        """Whether the light on the skin stays as it is."""
        return self.value.startswith(("camera", "field", "fall"))


@dataclass(frozen=True, kw_only=True, slots=True)
class Unknown:
    """One number that is fitted."""

    name: str
    unit: str
    kind: Kind
    prior_sd: float
    """Standard deviation of what was known before."""
    step: float
    """Of finite differences: some of the prior, so that differences stand out of the photons'
    noise."""
    wanted: float
    """What is worth knowing: determined is what twice the standard deviation is below."""
    axis: int = 0
    light: int = 0


@dataclass(frozen=True, kw_only=True, slots=True)
class Scene:
    """All that the unknowns change."""

    camera: Camera
    coating: Coating
    lights: tuple[Lamp, ...]

    def of(self, design: SensorDesign) -> SensorDesign:
        """The design with this camera and coating; its lights are given beside it."""
        optics = dataclasses.replace(design.optics, camera=self.camera, coating=self.coating)
        return dataclasses.replace(design, optics=optics)


def unknowns(scene: Scene, *, known: bool) -> list[Unknown]:
    """All that is fitted; places only of lights that are `known` to be the design's own."""
    axes, found = ("along x", "along y", "in height"), []
    for axis, where in enumerate(axes):
        name, kind = f"camera {where}", Kind.CAMERA_PLACE
        found.append(_unknown(name, "mm", kind, (0.5, 0.5, 0.1), axis=axis))
    for axis, about in enumerate("xyz"):
        name, kind = f"camera turned about {about}", Kind.CAMERA_TURN
        found.append(_unknown(name, "deg", kind, (1.0, 1.0, 0.2), axis=axis))
    width_deg = scene.camera.fov_x_deg
    sizes = 0.01 * width_deg, 0.01 * width_deg, 0.005 * width_deg
    found.append(_unknown("field of view", "deg", Kind.FIELD_OF_VIEW, sizes))
    found.append(_unknown("fall-off of the lens", "", Kind.FALLOFF, (0.2, 0.1, 0.05)))
    found.append(_unknown("lobe of the lights", "", Kind.LOBE, (0.5, 0.5, 0.1)))
    found.append(_unknown("log of the roughness", "", Kind.ROUGHNESS, (0.5, 0.3, 0.1)))
    found.append(_unknown("log of gloss over albedo", "", Kind.GLOSS, (1.0, 0.5, 0.2)))
    for light in range(len(scene.lights) if known else 0):
        for axis, where in enumerate(("outward", "around", "in height")):
            name, kind = f"light {light + 1} {where}", Kind.LED_PLACE
            found.append(_unknown(name, "mm", kind, (0.4, 0.3, 0.1), axis=axis, light=light))
    return found


def _unknown(
    name: str,
    unit: str,
    kind: Kind,
    sizes: tuple[float, float, float],
    *,
    axis: int = 0,
    light: int = 0,
) -> Unknown:
    prior_sd, step, wanted = sizes
    return Unknown(
        name=name,
        unit=unit,
        kind=kind,
        prior_sd=prior_sd,
        step=step,
        wanted=wanted,
        axis=axis,
        light=light,
    )


def moved_scene(
    scene: Scene, among: Sequence[Unknown], values: np.ndarray, mesh: MembraneMesh
) -> tuple[Scene, np.ndarray]:
    """The scene with unknowns at some values, and the values as far as there is room, (U,).

    Args:
        scene: At value 0 of all of them.
        among: The unknowns.
        values: One for each, in its unit, shape (U,).
        mesh: Of the design.
    """
    values = _inside(scene, among, np.array(values, dtype=np.float64))

    def camera(share: float) -> Camera:
        found = _camera(scene.camera, among, share * values)
        check_camera(mesh, found)
        return found

    seen, share = _with_room(camera, scene.camera)
    values[[u.kind.of_camera for u in among]] *= share
    lights = []
    for number, lamp in enumerate(scene.lights):
        of_it = [u.kind is Kind.LED_PLACE and u.light == number for u in among]
        base = _lobe(lamp, among, values)

        def light(share: float, base: Lamp = base, of_it: list[bool] = of_it) -> Lamp:
            found = _placed(base, among, np.where(of_it, share * values, 0.0))
            check_lights(mesh, NO_RING, (found,))
            return found

        placed, share = _with_room(light, base) if any(of_it) else (base, 1.0)
        values[of_it] *= share
        lights.append(placed)
    coating = _coating(scene.coating, among, values)
    return Scene(camera=seen, coating=coating, lights=tuple(lights)), values


def _with_room(make: Callable[[float], Moved], still: Moved) -> tuple[Moved, float]:
    """What fits of 1, 1/2, 1/4 ... of a move, and that share; `still` and 0 if nothing does."""
    for number in range(HALVINGS + 1):
        share = 0.5**number
        try:
            return make(share), share
        except DesignError:
            continue
    return still, 0.0


def _inside(scene: Scene, among: Sequence[Unknown], values: np.ndarray) -> np.ndarray:
    """Values within what lobe and coating may be."""
    exponents = [lamp.emission_exponent for lamp in scene.lights]
    coating, width_deg = scene.coating, scene.camera.fov_x_deg
    limits = {
        Kind.LOBE: (-min(exponents), MOST_EXPONENT - max(exponents)),
        Kind.ROUGHNESS: (np.log(LEAST_ROUGHNESS / coating.roughness), -np.log(coating.roughness)),
        Kind.GLOSS: (-np.inf, np.log(MOST_SPECULAR / max(coating.specular, 1e-3))),
        Kind.FALLOFF: (-0.5, 0.5),
        Kind.FIELD_OF_VIEW: (5.0 - width_deg, WIDEST_DEG[scene.camera.lens] - width_deg),
    }
    whole = -np.inf, np.inf
    low, high = np.array([limits.get(each.kind, whole) for each in among]).reshape(-1, 2).T
    return np.clip(values, low, high)


def _camera(camera: Camera, among: Sequence[Unknown], values: np.ndarray) -> Camera:
    from scipy.spatial.transform import Rotation

    moved, turned = np.array(camera.position_mm), np.zeros(3)
    width_deg, (k1, k2, k3) = camera.fov_x_deg, camera.sensor.falloff
    for each, value in zip(among, values, strict=True):
        if each.kind is Kind.CAMERA_PLACE:
            moved[each.axis] += value
        elif each.kind is Kind.CAMERA_TURN:
            turned[each.axis] += radians(value)
        elif each.kind is Kind.FIELD_OF_VIEW:
            width_deg += value
        elif each.kind is Kind.FALLOFF:
            k1 += value
    before = Rotation.from_quat(np.roll(camera.wxyz, -1))
    w, x, y, z = np.roll((Rotation.from_rotvec(turned) * before).as_quat(), 1)
    right, ahead, up = (float(value) for value in moved)
    return dataclasses.replace(
        camera,
        position_mm=(right, ahead, up),
        wxyz=(float(w), float(x), float(y), float(z)),
        fov_x_deg=float(width_deg),
        sensor=dataclasses.replace(camera.sensor, falloff=(float(k1), k2, k3)),
    )


def _lobe(lamp: Lamp, among: Sequence[Unknown], values: np.ndarray) -> Lamp:
    change = sum(v for u, v in zip(among, values, strict=True) if u.kind is Kind.LOBE)
    return dataclasses.replace(lamp, emission_exponent=float(lamp.emission_exponent + change))


def _placed(lamp: Lamp, among: Sequence[Unknown], values: np.ndarray) -> Lamp:
    place = np.array(lamp.position_mm)
    radius_mm = float(np.hypot(place[0], place[1]))
    outward = np.array([1.0, 0.0, 0.0])
    if radius_mm > ON_AXIS_MM:
        outward = np.array([place[0], place[1], 0.0]) / radius_mm
    directions = outward, np.cross(UP, outward), UP
    for each, value in zip(among, values, strict=True):
        if each.kind is Kind.LED_PLACE:
            place = place + value * directions[each.axis]
    x, y, z = (float(value) for value in place)
    return dataclasses.replace(lamp, position_mm=(x, y, z))


def _coating(coating: Coating, among: Sequence[Unknown], values: np.ndarray) -> Coating:
    roughness, gloss = coating.roughness, coating.specular
    for each, value in zip(among, values, strict=True):
        if each.kind is Kind.ROUGHNESS:
            roughness *= float(np.exp(value))
        elif each.kind is Kind.GLOSS:
            gloss *= float(np.exp(value))
    return dataclasses.replace(coating, roughness=min(roughness, 1.0), specular=gloss)
