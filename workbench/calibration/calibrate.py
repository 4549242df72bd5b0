"""From photographs of a built sensor to a calibrated design, its unit, and what each predicts.

    circles     given, or found in the difference from rest
    drift       of exposure and white balance, from untouched skin
    places      of the contacts on the skin, as a stage knows them or by the camera of the design
    presses     of each ball by the contact solver, over the depths that the circle allows
    powers      and colours of the lights, with the depths as unknowns
    all else    camera, places of known lights, lobe, coating, fall-off, by Gauss-Newton; where a
                stage knows the places of contacts, the camera must see them there
    residual    of slope and place, over that
    predictions of every photograph; held-out ones from place and depth alone

Everything long is a stage of the store: a calibration that is stopped goes on where it was.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim.optics.studio.unit_residual import unit_bytes
from workbench.calibration.ball_presses import BallPress, press_balls
from workbench.calibration.contacts import Contacts, Light, Work
from workbench.calibration.derivatives import Fit, Task
from workbench.calibration.elasticity import Young, fitted_young
from workbench.calibration.fitted_design import fitted_design, with_unit
from workbench.calibration.light_basis import LightBasis
from workbench.calibration.light_sources import candidates, single_lights
from workbench.calibration.photo_rows import images_of
from workbench.calibration.powers import Powers, shifts_px, worth_keeping
from workbench.calibration.predictions import Predictions, depths_of, left_of, predict
from workbench.calibration.refine import Refined, refine, shifts_of
from workbench.calibration.residual import REACH
from workbench.calibration.seen.drift import LeftOut, SeenPhoto, seen_photos
from workbench.calibration.seen.photo_set import IDLE, PhotoSet
from workbench.calibration.seen.seen_places import SeenPlaces
from workbench.calibration.stored import stored
from workbench.calibration.unknowns import Scene, unknowns
from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.design import SensorDesign
from workbench.core.design.unit import unit
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.store import Store

POWERS_SHARES = {
    "mesh": 2.0,
    "presses": 50.0,
    "known": 10.0,
    "candidates": 20.0,
    "places": 10.0,
    "refine": 0.0,
    "predictions": 5.0,
    "rest": 1.0,
    "residual": 2.0,
}
SHARES = {"powers": POWERS_SHARES, "all": {**POWERS_SHARES, "refine": 130.0}}
"""Time of each step against the others'."""
NO_RESIDUAL = np.zeros((0, 4)), np.zeros((0, 3))
BADLY = 0.5
"""Share of the change that lights leave unexplained from which they are not those of the sensor
[1], by root mean squares: lights in other places leave .6 to .9, the right ones .2 to .4."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Calibration:
    """What a calibration gives."""

    design: SensorDesign
    """In the fitted light, seen by the fitted camera, without its unit."""
    unit_data: bytes
    """The unit's file."""
    known: bool
    """Whether the design's own lights were fitted, rather than candidates around it."""
    basis: LightBasis
    """Of the lights that were kept."""
    powers: Powers
    seen: tuple[SeenPhoto, ...]
    presses: tuple[BallPress, ...]
    """Of all photographs, in the order of `seen`."""
    depths_mm: tuple[float, ...]
    rest: np.ndarray
    """The sensor at rest in the fitted light alone, shape (H, W, 3), uint8."""
    by_light: Predictions
    """In the fitted light over the photograph at rest, without the residual."""
    predictions: Predictions
    """With the residual."""
    refined: Refined | None = None
    """Of `all` but powers; None where these alone were fitted."""
    young: Young | None = None
    """None where no force was measured."""
    left_out: tuple[LeftOut, ...] = ()
    """Photographs that show no contact."""


def calibrate(
    design: SensorDesign,
    photos: PhotoSet,
    store: Store,
    *,
    lights: str,
    monitor: Monitor,
    refining: str = "all",
) -> Calibration:
    """Fit a design's light to photographs.

    Args:
        design: Its camera must have the photographs' size.
        photos: At rest, and of balls.
        store: Keeps presses and light.
        lights: `known`: those of the design; `unknown`: candidates around the body; `auto`: the
            first if they explain the photographs, else the second.
        monitor: Progress and cancellation.
        refining: `all`: camera, places of known lights, lobe, coating and fall-off as well;
            `powers`: powers, colours and depths alone.

    Raises:
        DesignError: With a photograph's name, if it cannot be used.
        WorkbenchError: From the stages.
    """
    _expect_size(design, photos)
    span = _spans(SHARES[refining], monitor)
    mesh: MembraneMesh = stored(design, PressCase(), "mesh", store, span["mesh"])
    places = SeenPlaces(mesh, design.optics)
    found, left_out = seen_photos(photos, places.contact)
    contacts, located = [each for each, _ in found], [(each.photo, at) for each, at in found]
    photos = replace(photos, photos=tuple(each.photo for each in contacts))
    solved = press_balls(design, places, located, store, span["presses"])
    work = Work(design=design, photos=photos, store=store, mesh=mesh, solved=tuple(solved))
    known, light = _whose_lights(work, work.where_seen(contacts, places), lights, span)
    # Where each contact is in its photograph is known better now than its circle said.
    width, sensor = photos.idle.shape[1], design.optics.camera.sensor
    targets = work.targets(contacts, light.basis)
    away = shifts_px(light.basis, targets, light.powers, sensor, width)
    moved = work.moved(contacts, away, places)
    light = work.light(moved, light.basis.lights, span["places"])
    refined = None
    if refining == "all":
        task, first = _task(work, moved, light, known=known)
        refined = refine(task, first, span["refine"])
        fit = refined.fit
        design, light = fit.scene.of(design), Light(basis=fit.basis, powers=fit.powers)
        away = shifts_of(task, fit)
        moved = work.moved(moved.seen, away, SeenPlaces(mesh, design.optics))
    whole = _whole(replace(work, design=design), moved, (known, light, refined), span)
    return replace(whole, left_out=tuple(left_out))


def _spans(shares: dict[str, float], monitor: Monitor) -> dict[str, Monitor]:
    """The part of each step in the whole."""
    ends = np.cumsum(list(shares.values())) / sum(shares.values())
    starts = np.concatenate([[0.0], ends[:-1]])
    return {
        name: part(monitor, float(start), float(end))
        for name, start, end in zip(shares, starts, ends, strict=True)
    }


def _whose_lights(
    work: Work, contacts: Contacts, lights: str, span: dict[str, Monitor]
) -> tuple[bool, Light]:
    """Whether the lights are the design's, and their powers, or those of candidates."""
    if lights != "unknown":
        found = work.light(contacts, single_lights(work.design.optics), span["known"])
        powers = found.powers
        if lights == "known" or powers.error_grey <= BADLY * powers.null_grey:
            return True, found
    traced, solving = part(span["candidates"], 0.0, 0.95), part(span["candidates"], 0.95, 1.0)
    found = work.light(contacts, candidates(work.mesh), traced)
    kept = found.basis.only(worth_keeping(found.basis, found.powers))
    return False, work.powers(contacts, kept, solving)


def _task(work: Work, contacts: Contacts, light: Light, *, known: bool) -> tuple[Task, Fit]:
    """What Gauss-Newton fits, and where it begins."""
    optics, fitted = work.design.optics, work.fitted
    scene = Scene(camera=optics.camera, coating=optics.coating, lights=light.basis.lights)
    targets = work.targets(contacts.seen, light.basis)
    task = Task(
        design=work.design,
        mesh=work.mesh,
        store=work.store,
        scene=scene,
        among=tuple(unknowns(scene, known=known)),
        presses=tuple(work.solved[k] for k in fitted),
        boxes=tuple(contacts.seen[k].circle for k in fitted),
        targets=targets,
        images=images_of(targets, light.basis, optics.camera.sensor, work.photos.idle.shape[1]),
    )
    first = Fit(
        values=np.zeros(len(task.among)),
        scene=scene,
        circles=task.boxes,
        basis=light.basis,
        powers=light.powers,
    )
    return task, first


def _whole(
    work: Work,
    contacts: Contacts,
    fitted: tuple[bool, Light, Refined | None],
    span: dict[str, Monitor],
) -> Calibration:
    """Residual and predictions in the fitted light."""
    known, light, refined = fitted
    photos, mesh, store = work.photos, work.mesh, work.store
    young = _young(work, contacts, light.powers, refined)
    design = fitted_design(
        work.design, light.basis.lights, light.powers, ring=known and refined is None
    )
    if young is not None:
        material = replace(design.material, young_MPa=young.young_MPa)
        design = replace(design, material=material)
    depths = depths_of(contacts.presses, work.fitted, light.powers.depths_mm)
    pairs = zip(contacts.presses, depths, strict=True)
    displaced = [press.displaced_mm(depth) for press, depth in pairs]
    bare = unit("unit.npz", unit_bytes(photos.idle_png, *NO_RESIDUAL, REACH))
    first = predict(with_unit(design, bare), mesh, store, displaced, span["predictions"])
    centres, weights = left_of(first, contacts.seen, work.fitted)
    data = unit_bytes(photos.idle_png, centres, weights, REACH)
    whole = with_unit(design, unit("unit.npz", data))
    return Calibration(
        design=design,
        unit_data=data,
        known=known,
        basis=light.basis,
        powers=light.powers,
        seen=tuple(contacts.seen),
        presses=tuple(contacts.presses),
        depths_mm=tuple(depths),
        rest=predict(design, mesh, store, displaced[:1], span["rest"]).rest,
        by_light=first,
        predictions=predict(whole, mesh, store, displaced, span["residual"]),
        refined=refined,
        young=young,
    )


def _young(work: Work, contacts: Contacts, powers: Powers, refined: Refined | None) -> Young | None:
    """Young's modulus from the fitted photographs with a force."""
    presses = [contacts.presses[k] for k in work.fitted]
    covariance = np.zeros((len(presses), len(presses)))
    if refined is not None:
        own = len(refined.among) + np.arange(len(presses))
        covariance = refined.covariance[np.ix_(own, own)]
    return fitted_young(work.design.material.young_MPa, presses, powers.depths_mm, covariance)


def _expect_size(design: SensorDesign, photos: PhotoSet) -> None:
    camera, (height, width) = design.optics.camera, photos.idle.shape[:2]
    if (width, height) != (camera.width_px, camera.height_px):
        raise DesignError(
            f"{IDLE} has {width} x {height} pixels, the camera of the design "
            f"{camera.width_px} x {camera.height_px}",
            hint=f"set optics.camera.width_px = {width} and height_px = {height}, and the field of "
            "view that goes with them",
            at="optics.camera.width_px",
        )
