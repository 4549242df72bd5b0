"""How light in all photographs changes with each unknown, powers and depths as they are.

Finite differences with the same photons:

    camera, fall-off    all lights together in their fitted colours, light on the skin as it is
    lobe, coating       all lights together, traced anew
    places              each light alone, three of them at a time, one in each colour

Where a contact is on the skin follows from its circle and the camera.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.calibration.ball_presses import BallPress, carried
from workbench.calibration.fitted_design import light_colour
from workbench.calibration.light_basis import Drawn, LightBasis, drawn, open_basis, plain_optics
from workbench.calibration.photo_rows import Image, Slopes
from workbench.calibration.powers import Powers, Targets
from workbench.calibration.seen.photo_set import Circle
from workbench.calibration.seen.seen_places import SeenPlaces
from workbench.calibration.unknowns import Kind, Scene, Unknown, moved_scene
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.design import SensorDesign
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.store import Store

TOGETHER = 2_000_000
"""Photons of a bake of all lights together."""
ROOM = 0.4
"""Of a step that there must be room for [1]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Task:
    """What is fitted to what."""

    design: SensorDesign
    mesh: MembraneMesh
    store: Store
    scene: Scene
    """At value 0 of all unknowns."""
    among: tuple[Unknown, ...]
    presses: tuple[BallPress, ...]
    """Of the fitted photographs, where they were solved, shape (J,)."""
    boxes: tuple[Circle, ...]
    """Whose samples are compared, shape (J,)."""
    targets: Targets
    """The photographs at these samples."""
    images: tuple[Image, ...]
    """The same as light."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Fit:
    """Light and camera at some values of the unknowns."""

    values: np.ndarray
    """Shape (U,)."""
    scene: Scene
    circles: tuple[Circle, ...]
    """Where the contacts are seen, shape (J,)."""
    basis: LightBasis
    powers: Powers


def placed(
    task: Task, scene: Scene, presses: Sequence[BallPress], circles: Sequence[Circle]
) -> list[tuple[BallPress, Circle]]:
    """Presses where the camera of a scene sees circles, with the boxes that are compared."""
    places = SeenPlaces(task.mesh, scene.of(task.design).optics)
    found = []
    for press, circle, box in zip(presses, circles, task.boxes, strict=True):
        place = places.place(circle, press.photo.name)
        found.append((carried(press, press.photo, place, task.mesh), box))
    return found


def points_mm(presses: Sequence[tuple[BallPress, Circle]]) -> np.ndarray:
    """Where the contacts are, shape (J, 3)."""
    return np.array([press.place.point_mm for press, _ in presses])


def slopes_of(task: Task, fit: Fit, monitor: Monitor) -> list[Slopes]:
    """Derivatives of the light of all images by each unknown, at fixed powers and depths."""
    presses = [
        _at_depth(press, depth)
        for press, depth in zip(task.presses, fit.powers.depths_mm, strict=True)
    ]
    still = placed(task, fit.scene, presses, fit.circles)
    common = [k for k, each in enumerate(task.among) if each.kind is not Kind.LED_PLACE]
    places = [k for k, each in enumerate(task.among) if each.kind is Kind.LED_PLACE]
    axes = sorted({task.among[k].axis for k in places})
    works = len(common) + 1 + (1 + len(axes) if axes else 0)
    found: dict[int, Slopes] = {}
    base = _together(task, fit.scene, fit, still, part(monitor, 0.0, 1.0 / works))
    for number, k in enumerate(common, start=1):
        span = part(monitor, number / works, (number + 1) / works)
        span(0.0, f"slope by {task.among[k].name}")
        scene, by = _nudged(task, fit, [k])
        seen = still
        if task.among[k].kind.of_camera:
            seen = placed(task, scene, presses, fit.circles)
        now = _together(task, scene, fit, seen, span)
        moved_mm = points_mm(seen) - points_mm(still)
        found[k] = _difference((now, base), moved_mm, by.get(k, np.inf))
    if axes:
        ends = np.linspace((len(common) + 1) / works, 1.0, len(axes) + 2)
        spans = [part(monitor, *pair) for pair in itertools.pairwise(ends.tolist())]
        alone = _alone(task, fit, fit.scene, still, spans[0])
        for axis, span in zip(axes, spans[1:], strict=True):
            chosen = [k for k in places if task.among[k].axis == axis]
            scene, by = _nudged(task, fit, chosen)
            now = _alone(task, fit, scene, still, span)
            # Without room for a step, nothing is learned of it.
            found |= {
                k: _by_place(task.among[k], fit, (now, alone), by.get(k, np.inf)) for k in chosen
            }
    return [found[k] for k in range(len(task.among))]


def _at_depth(press: BallPress, depth_mm: float) -> BallPress:
    """A press with one depth alone."""
    moved = press.displaced_mm(depth_mm)
    return dataclasses.replace(
        press,
        least_mm=depth_mm,
        most_mm=depth_mm,
        guess_mm=depth_mm,
        depths_mm=np.array([0.0, depth_mm]),
        displacement_mm=np.stack([np.zeros_like(moved), moved]),
        normal_N=np.array([0.0, press.force_N(depth_mm)]),
    )


def _nudged(task: Task, fit: Fit, chosen: Sequence[int]) -> tuple[Scene, dict[int, float]]:
    """The scene with some unknowns a step on, or back where there is no room, and by how much."""
    signs = np.ones(len(chosen))
    steps = np.array([task.among[k].step for k in chosen])
    by = np.zeros(len(chosen))
    scene = fit.scene
    for _ in range(2):
        values = fit.values.copy()
        values[chosen] += signs * steps
        scene, got = moved_scene(task.scene, task.among, values, task.mesh)
        by = (got - fit.values)[chosen]
        short = np.abs(by) < ROOM * steps
        if not short.any():
            break
        signs[short] = -1.0
    enough = np.abs(by) >= ROOM * steps
    return scene, {k: float(size) for k, size, ok in zip(chosen, by, enough, strict=True) if ok}


def _together(
    task: Task,
    scene: Scene,
    fit: Fit,
    presses: Sequence[tuple[BallPress, Circle]],
    monitor: Monitor,
) -> list[np.ndarray]:
    """Light at all samples in the fitted powers, at rest and of each press, (N, 3) each."""
    strongest = float(fit.powers.lights.max())
    lamps = []
    for lamp, rgb in zip(scene.lights, fit.powers.lights.T, strict=True):
        colour, power = light_colour(rgb / strongest)
        if power > 0.0:
            lamps.append(dataclasses.replace(lamp, colour=colour, power=power))
    design = scene.of(task.design)
    optics = plain_optics(design.optics, tuple(lamps), TOGETHER)
    lit = dataclasses.replace(design, optics=optics)
    found: Drawn = drawn(lit, task.mesh, presses, task.store, monitor, "all lights")
    rest = strongest * found.rest + found.ambient[:, None] * fit.powers.ambient
    return [rest, *(strongest * each.change[0] for each in found.presses)]


def _difference(
    light: tuple[list[np.ndarray], list[np.ndarray]], moved_mm: np.ndarray, by: float
) -> Slopes:
    """From light after a step and before, and from where contacts are seen to have moved."""
    rest, *presses = [(now - before) / by for now, before in zip(*light, strict=True)]
    return Slopes(rest=rest, presses=tuple(presses), places_mm=moved_mm / by)


def _alone(
    task: Task,
    fit: Fit,
    scene: Scene,
    presses: Sequence[tuple[BallPress, Circle]],
    monitor: Monitor,
) -> LightBasis:
    """Each light of a scene alone, seen as in the fit."""
    lit = fit.scene.of(task.design)
    return open_basis(lit, task.mesh, scene.lights, presses, task.store, monitor)


def _by_place(
    unknown: Unknown, fit: Fit, bases: tuple[LightBasis, LightBasis], by: float
) -> Slopes:
    """By the place of a light along one axis, from the lights alone after a step and before."""
    (now, still), light = bases, unknown.light
    power = fit.powers.lights[:, light]
    pairs = [(now.rest, still.rest)]
    pairs += [
        (one.change[0], other.change[0])
        for one, other in zip(now.presses, still.presses, strict=True)
    ]
    rest, *changes = [
        np.outer((one[:, light] - other[:, light]) / by, power) for one, other in pairs
    ]
    return Slopes(rest=rest, presses=tuple(changes), places_mm=np.zeros((len(changes), 3)))
