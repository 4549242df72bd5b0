"""A sensor on a body of a MuJoCo simulation: frames after each step, and its force if wanted.

    touch = wb.attach(model, data, "skin", "bolt", sensor=wb.Sensor.load("geltip_pack"))
    mujoco.mj_step(model, data)
    frame = touch()                      # as of `Sensor.render`: mm, N, the sensor's frame

A simulation knows rigid bodies, and keeps them apart by springs of its own: an object that rests on
the skin hardly dents it. With `apply_force` its contact is switched off, the object sinks in, and
what the skin pushes back is applied to both bodies, one step later, with damping:

    f = F + t dF/dt, but none that pulls.

F is the force at rest, which knows no loss; t dF/dt is a Kelvin-Voigt solid's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypedDict, Unpack

import numpy as np

from workbench.core.base.poses import pose_rows
from workbench.sensor.beside import beside
from workbench.sensor.frame import Felt, Frame
from workbench.sensor.sensor import Sensor
from workbench.sensor.things import Thing
from workbench.simulators.mujoco_module import MjData, MjModel, mujoco
from workbench.simulators.mujoco_names import body_number, by_body, geom_numbers
from workbench.simulators.mujoco_pushes import Pushes, switch_contact_off
from workbench.simulators.mujoco_shapes import (
    MM_OF_M,
    distances_mm,
    thing_of_geom,
    thing_of_geoms,
)
from workbench.simulators.mujoco_step import check_step

DAMPING_S = 1e-3
"""Of the applied force. Source: our choice, a loss factor of .2 at 32 Hz."""


class AttachOptions(TypedDict, total=False):
    """How a sensor takes part."""

    apply_force: bool
    """Whether the skin's force takes the place of MuJoCo's contact; not by default."""
    damping_s: float
    """t above, 1 ms by default."""


@dataclass(frozen=True, kw_only=True)
class Rigid:
    """An object that the sensor may feel."""

    names: tuple[str, ...]
    """Of its geoms."""
    body: int
    geom: int | None
    """Geom whose frame the object has; None: its body's."""
    thing: Thing

    def frame(self, data: MjData) -> tuple[np.ndarray, np.ndarray]:
        """Origin [m], (3,), and axes, (3, 3), in the world."""
        if self.geom is None:
            return data.xpos[self.body], data.xmat[self.body].reshape(3, 3)
        return data.geom_xpos[self.geom], data.geom_xmat[self.geom].reshape(3, 3)


def attach(
    model: MjModel,
    data: MjData,
    body: str | int,
    geoms: str | int | Sequence[str | int],
    sensor: Sensor,
    **options: Unpack[AttachOptions],
) -> AttachedSensor:
    """Put a sensor on a body of a MuJoCo simulation.

    Args:
        model: The model; with `apply_force` the collisions of the body are switched off in it.
        data: Its state.
        body: Name or number of the body whose frame is the sensor's: `skin` of a pack's
            `sensor.xml`, with its prefix.
        geoms: Names or numbers of what it may touch. Geoms of one body are one object; of several
            objects the one that stands deepest in the skin is felt.
        sensor: The sensor; it may be put on several bodies, each with a touch of its own.
        options: `apply_force` and `damping_s`, see `AttachOptions`.

    Raises:
        DesignError: If there is no such body or geom, or a geom's shape cannot be pressed.
        PackageError: If MuJoCo is not installed.
    """
    mujoco()
    numbers = geom_numbers(model, geoms)
    objects = tuple(_rigid(model, body, found) for body, found in by_body(model, numbers).items())
    return AttachedSensor(model, data, body_number(model, body), objects, sensor, **options)


class AttachedSensor:
    """What a sensor on a body feels; made by `attach`."""

    def __init__(
        self,
        model: MjModel,
        data: MjData,
        body: int,
        objects: tuple[Rigid, ...],
        sensor: Sensor,
        **options: Unpack[AttachOptions],
    ) -> None:
        self.model, self.data, self.objects = model, data, objects
        self.sensor = beside(sensor)
        self.body, self.felt_object = body, objects[0]
        self._damping_s = options.get("damping_s", DAMPING_S)
        self._pushes = Pushes(data) if options.get("apply_force", False) else None
        if self._pushes is not None:
            switch_contact_off(model, body, [rigid.body for rigid in objects])
        self.reset()

    def reset(self) -> None:
        """Forget all touches, as after the simulation was reset."""
        self._time_s, self._wrench = -np.inf, np.zeros(6)
        self.sensor.reset(1)
        if self._pushes is not None:
            self._pushes.forget()

    def __call__(self) -> Frame:
        """What the sensor sees and feels now, after a step: a frame of one row.

        Raises:
            SolveError: If the object touches too much of the skin at once, or the simulation's
                step is too long for its mass.
        """
        frame = self.sensor.render(self._now(), self.felt_object.thing)
        self._keep(frame)
        return frame

    def feel(self) -> Felt:
        """The same without an image, for steps between images.

        Raises:
            SolveError: If the object touches too much of the skin at once, or the simulation's
                step is too long for its mass.
        """
        felt = self.sensor.feel(self._now(), self.felt_object.thing)
        self._keep(felt)
        return felt

    def _now(self) -> np.ndarray:
        """Pose of the object that is felt, shape (7,), in mm."""
        if self.data.time < self._time_s:
            self.reset()
        # A step leaves poses of its beginning behind.
        mujoco().mj_kinematics(self.model, self.data)
        poses = [self._pose(rigid) for rigid in self.objects]
        number = self._deepest(poses) if len(poses) > 1 else 0
        if self.objects[number] is not self.felt_object:
            self.felt_object, self._wrench = self.objects[number], np.zeros(6)
            self.sensor.reset(1)
        return poses[number]

    def _pose(self, rigid: Rigid) -> np.ndarray:
        origin_m, turned = rigid.frame(self.data)
        ours = self.data.xmat[self.body].reshape(3, 3)
        place_mm = ours.T @ (origin_m - self.data.xpos[self.body]) * MM_OF_M
        return pose_rows(place_mm[None], (ours.T @ turned)[None])[0]

    def _deepest(self, poses: list[np.ndarray]) -> int:
        points_mm = self.sensor.skin.points_mm
        pairs = zip(self.objects, poses, strict=True)
        return int(np.argmin([distances_mm(r.thing, points_mm, pose).min() for r, pose in pairs]))

    def _keep(self, felt: Felt) -> None:
        """Remember what was felt, and apply its force where that is wanted."""
        wrench = np.concatenate([felt.force_N[0], felt.torque_Nmm[0] / MM_OF_M]).astype(float)
        passed_s, self._time_s = self.data.time - self._time_s, self.data.time
        before, self._wrench = self._wrench, wrench
        if self._pushes is None:
            return
        rate = (wrench - before) / passed_s if 0.0 < passed_s < np.inf else np.zeros(6)
        pushed = wrench + self._damping_s * rate
        if pushed[:3] @ wrench[:3] <= 0.0:
            pushed = np.zeros(6)
        turned = self.data.xmat[self.body].reshape(3, 3)
        force, moment = pushed.reshape(2, 3) @ turned.T
        bodies = (self.felt_object.body, self.body)
        place_m = self.felt_object.frame(self.data)[0]
        if passed_s < np.inf:
            check_step(
                (self.model, self.data),
                bodies,
                (turned @ wrench[:3], place_m),
                dent_m=float(np.linalg.norm(felt.displacement_mm[0], axis=1).max()) / MM_OF_M,
                step_s=passed_s,
                damping_s=self._damping_s,
            )
        self._pushes.put(bodies, np.concatenate([force, moment]), place_m)


def _rigid(model: MjModel, body: int, geoms: list[int]) -> Rigid:
    names = tuple(model.geom(geom).name for geom in geoms)
    if len(geoms) == 1:
        thing = thing_of_geom(model, geoms[0])
        return Rigid(names=names, body=body, geom=geoms[0], thing=thing)
    return Rigid(names=names, body=body, geom=None, thing=thing_of_geoms(model, geoms))
