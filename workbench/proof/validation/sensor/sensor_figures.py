"""Fast contact beside the contact solver, press by press: the record of the room `sensor`.

    python -m workbench.proof.validation.sensor.sensor_figures FOLDER [DESIGN ...]

presses each object by the contact solver, plays the same poses by `wb.Sensor` and keeps forces and
image scores of both. FOLDER is a project, so a run that was stopped goes on; designs that are not
named keep what was recorded of them by the same code.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sim.condensed.lessons import KINDS
from workbench.core.design.design import SensorDesign
from workbench.core.press.motion import slide
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh
from workbench.core.result.sensing import Contact
from workbench.edit.indenter_choice import choose_indenter
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner, evaluate, plan
from workbench.project.aim import default_target_mm
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.proof.validation.sensor.by_design import record_by_design
from workbench.sensor.making import make_pack
from workbench.sensor.sensor import Sensor
from workbench.system.record import Record

BALL, SLIDE = "sphere", "slide"
OBJECTS = (*(kind.value for kind in KINDS), "flower")
"""Those that are fitted, and one that is not."""
SIZE_MM = 6.0
DEPTH_MM, FRAMES, SHEAR_MM = 1.0, 10, 0.5
"""Ten frames down, ten aside."""
WIDTH_PX = 320
SLIDE_MM, SLID_DEPTH_MM = 2.0, 0.6
"""Way of a ball along the skin and back, ten frames each, and how deep it stands."""
IMAGES = (5, 10)
"""Frames whose images are compared, counted from one: half and all of the depth."""
CHANGED_GREY = 2
"""A pixel takes part in the box that is compared where the full image changed by more."""

RECORD = Record(
    path=Path(__file__).with_name("sensor_figures.json"),
    command="python -m workbench.proof.validation.sensor.sensor_figures FOLDER",
    sources=("workbench.proof.validation.sensor.sensor_figures", "sim.condensed"),
    apart=(
        "designs",
        "geometry",
        "sim.contact.press",
        "sim.fem",
        "sim.optics",
        "workbench.core",
        "workbench.edit",
        "workbench.live",
        "workbench.pipeline",
        "workbench.planning",
        "workbench.project",
        "workbench.report",
        "workbench.system",
        "workbench.view",
    ),
)
"""What the contact solver and the light say is data here; another fast contact makes it stale."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Played:
    """A press by both."""

    name: str
    contact: Contact
    force_N: np.ndarray
    """By the sensor, shape (K, 3)."""
    torque_Nmm: np.ndarray
    slip: np.ndarray
    """Share that slides by the sensor, shape (K,)."""
    images: dict[int, tuple[float, float]]
    """Of a frame, SSIM in the box that changes, and that of no dent."""
    noted: int
    """Frames that the sensor said are beyond its range."""


def play(
    sensor: Sensor, design: SensorDesign, mesh: MembraneMesh, press: tuple[str, Contact]
) -> Played:
    """A press of the contact solver by a sensor, pose by pose."""
    from sim.condensed.lessons import before

    name, contact = press
    thing = sensor.object(name, size_mm=SIZE_MM)
    poses = contact.indenter_pose
    sensor.reset(1)
    sensor.render(before(poses), thing)
    frames = [sensor.render(pose, thing) for pose in poses]
    moved = mesh.seen_displacement_mm(contact)
    rest = sensor.drawn(np.zeros_like(moved[:1]))[0]
    images = {}
    for number in IMAGES:
        full = sensor.drawn(moved[number - 1 : number])[0]
        images[number] = (
            boxed_ssim(frames[number - 1].rgb[0], full, rest),
            boxed_ssim(rest, full, rest),
        )
    return Played(
        name=name,
        contact=contact,
        force_N=np.concatenate([frame.force_N for frame in frames]),
        torque_Nmm=np.concatenate([frame.torque_Nmm for frame in frames]),
        slip=np.concatenate([frame.slip for frame in frames]),
        images=images,
        noted=sum(not frame.within_range[0] for frame in frames),
    )


def boxed_ssim(image: np.ndarray, full: np.ndarray, rest: np.ndarray) -> float:
    """Structural similarity of an image and the full one where the full one changed, its box."""
    from sim.optics.studio.metrics import SSIM_WINDOW_PX, ssim

    changed = np.abs(full.astype(int) - rest.astype(int)).max(axis=2) > CHANGED_GREY
    rows, columns = np.nonzero(changed)
    if not len(rows):
        return 1.0
    box = tuple(
        slice(max(int(line.min()) - SSIM_WINDOW_PX, 0), int(line.max()) + SSIM_WINDOW_PX + 1)
        for line in (rows, columns)
    )
    return ssim(image[box], full[box])


def figures_of(played: Played) -> dict[str, Any]:
    """Forces of both in every frame, angles, torques and images of a press."""
    contact, force = played.contact, played.force_N
    normal, reaction = contact.normal, contact.reaction_N
    along, wanted = force @ normal, reaction @ normal
    across = np.linalg.norm(force - np.outer(along, normal), axis=1)
    side = np.linalg.norm(reaction - np.outer(wanted, normal), axis=1)
    cosine = (force * reaction).sum(axis=1) / (
        np.linalg.norm(force, axis=1) * np.linalg.norm(reaction, axis=1)
    )
    turning = np.linalg.norm(contact.moment_Nmm[-1])
    return {
        "depth_mm": [round(DEPTH_MM * k / FRAMES, 3) for k in range(1, FRAMES + 1)],
        "normal_N": along.tolist(),
        "full_normal_N": wanted.tolist(),
        "across_N": across.tolist(),
        "full_across_N": side.tolist(),
        "worst_angle_deg": float(np.degrees(np.arccos(np.clip(cosine[2:], -1, 1))).max()),
        "torque_error": float(
            np.linalg.norm(played.torque_Nmm[-1] - contact.moment_Nmm[-1]) / max(turning, 1e-9)
        ),
        "full_torque_Nmm": float(turning),
        "slip": played.slip.tolist(),
        "full_slip": contact.sliding_share.tolist(),
        "ssim": {str(number): pair[0] for number, pair in played.images.items()},
        "null_ssim": {str(number): pair[1] for number, pair in played.images.items()},
        "noted": played.noted,
    }


def record_press(design: SensorDesign) -> Press:
    """Where and how each object is pressed and sheared."""
    target_mm = default_target_mm(design)
    return Press(target_mm=target_mm, depth_mm=DEPTH_MM, frames=FRAMES, shear_mm=(SHEAR_MM, 0.0))


def measured(name: str, project: Project) -> dict[str, Any]:
    """Figures of all objects on a design."""
    design = load_design(name, project=project)
    sensor = Sensor(make_pack(design, project, width_px=WIDTH_PX))
    found: dict[str, Any] = {"fit": sensor.law.errors or {}}
    target_mm = default_target_mm(design)
    path = record_press(design)
    for thing in OBJECTS:
        mesh, contact = _pressed(design, thing, path, project.store)
        found[thing] = figures_of(play(sensor, design, mesh, (thing, contact)))
    there_and_back = (slide(SLIDE_MM, 0.0, frames=FRAMES), slide(-SLIDE_MM, 0.0, frames=FRAMES))
    path = Press(target_mm=target_mm, depth_mm=SLID_DEPTH_MM, frames=FRAMES, strokes=there_and_back)
    found[SLIDE] = slid(sensor, _pressed(design, BALL, path, project.store)[1])
    return found


def slid(sensor: Sensor, contact: Contact) -> dict[str, Any]:
    """Tangential forces of a ball that slides to and fro, by both, frame by frame of the slide."""
    from sim.condensed.lessons import before

    thing = sensor.object(BALL, size_mm=SIZE_MM)
    poses, normal = contact.indenter_pose, contact.normal
    sensor.reset(1)
    sensor.feel(before(poses), thing)
    force = np.concatenate([sensor.feel(pose, thing).force_N for pose in poses])
    across = [each - np.outer(each @ normal, normal) for each in (force, contact.reaction_N)]
    return {
        "across_N": across[0][FRAMES:].tolist(),
        "full_across_N": across[1][FRAMES:].tolist(),
    }


def _pressed(
    design: SensorDesign, thing: str, path: Press, store: Store
) -> tuple[MembraneMesh, Contact]:
    case = PressCase(indenter=choose_indenter(thing, size_mm=SIZE_MM), press=path)
    for _ in evaluate(design, case, InlineRunner(store), wanted=("press",)):
        pass
    calls = plan(design, case)
    return store.load("mesh", calls["mesh"].key), store.load("press", calls["press"].key)


def main(words: Sequence[str] | None = None) -> int:
    """Measure and record; 1 where something failed."""
    return record_by_design(RECORD, measured, __doc__, words)


if __name__ == "__main__":
    sys.exit(main())
