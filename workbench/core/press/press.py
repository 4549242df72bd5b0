"""Where an object is pressed into the skin, how far and along which path, and how it is computed.

Quasi-static: speed enters nowhere.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass

import numpy as np

from workbench.core.base.check import within
from workbench.core.base.errors import DesignError
from workbench.core.press.actuation import Actuation
from workbench.core.press.motion import Mover, Stroke
from workbench.core.press.trajectory import FARTHEST_MM, Pose, Trajectory, unit_pose

MOST_STROKES = 100


@dataclass(frozen=True, kw_only=True, slots=True)
class Press:
    """One press path: straight in, then shear and twist at full depth, then strokes.

    A trajectory replaces all of that. Where the sensor moves, its rows are the sensor's poses in
    the room, and the object stands at `object_pose`.
    """

    target_mm: tuple[float, float, float] = (0.0, 10.0, 35.0)
    """Point near the skin [mm], sensor frame; projected onto the outer surface."""
    depth_mm: float = 1.0
    """Depth from first touch along the inward normal [mm]."""
    shear_mm: tuple[float, float] = (0.0, 0.0)
    """Displacement along U and V in the tangent plane [mm]; U is +Z projected, V = n x U."""
    twist_deg: float = 0.0
    """Rotation about the outward normal at full depth [degree]."""
    frames: int = 10
    """Frames of the approach; as many again follow when there is shear or twist."""
    actuations: tuple[Actuation, ...] = ()
    """Regions of the membrane that are driven meanwhile; each lasts until its last key."""
    strokes: tuple[Stroke, ...] = ()
    """Moves that follow, one after the other."""
    trajectory: Trajectory | None = None
    """Timed poses instead of depth, shear, twist and strokes; the target is then found on the way,
    except for a moving sensor without `object_pose`."""
    mover: Mover = Mover.OBJECT
    """Which of the two moves in the room."""
    object_pose: Pose | None = None
    """Where the object stands in the room while the sensor moves along a trajectory: x, y, z [mm],
    qw, qx, qy, qz. None: where it first touches the target when the sensor is at its first pose."""

    def __post_init__(self) -> None:
        if not all(math.isfinite(x) for x in (*self.target_mm, *self.shear_mm)):
            raise DesignError(
                f"target {self.target_mm} or shear {self.shear_mm} is not finite",
                hint="give three numbers in mm for the target and two for the shear",
                at="press.target_mm",
            )
        hint = "depth counts inward from first touch; 1 mm is typical for a 2 mm wall"
        at = "press.depth_mm"
        within(self.depth_mm, 0.0, 50.0, what="press depth", unit="mm", at=at, hint=hint)
        at = "press.shear_mm"
        for shear in self.shear_mm:
            within(shear, -20.0, 20.0, what="shear", unit="mm", at=at)
        at = "press.twist_deg"
        within(self.twist_deg, -90.0, 90.0, what="twist", unit="degree", at=at)
        within(self.frames, 1, 500, what="frame count", unit="", at="press.frames")
        at = "press.strokes"
        within(len(self.strokes), 0, MOST_STROKES, what="stroke count", unit="", at=at)
        if self.trajectory is not None:
            self._check_trajectory(self.trajectory)
        elif self.object_pose is not None:
            raise DesignError(
                "a press has an object pose but no trajectory",
                hint="give a trajectory with it; a press starts where the object touches the skin",
                at="press.object_pose",
            )

    def _check_trajectory(self, trajectory: Trajectory) -> None:
        if self.strokes:
            raise DesignError(
                f"a press has a trajectory and {len(self.strokes)} strokes",
                hint="put the strokes into the trajectory, or leave one of them out",
                at="press.trajectory",
            )
        sensor_moves = self.mover is Mover.SENSOR
        away_mm = np.array(trajectory.poses)[:, :3]
        if self.object_pose is not None:
            if not sensor_moves:
                raise DesignError(
                    "the object has a fixed pose, but it is the object that moves",
                    hint="let the sensor move (mover sensor), or leave the object's pose out",
                    at="press.object_pose",
                )
            pose = unit_pose(self.object_pose, what="object pose", at="press.object_pose")
            object.__setattr__(self, "object_pose", pose)
            away_mm = away_mm - np.array(pose[:3])
        elif sensor_moves:
            away_mm = away_mm - away_mm[0]
        ways_mm = np.linalg.norm(away_mm, axis=1)
        beyond = np.flatnonzero(ways_mm > FARTHEST_MM)
        if len(beyond):
            row = int(beyond[0])
            raise DesignError(
                f"row {row + 1}: the trajectory leaves the scene, {ways_mm[row]:.0f} mm from the "
                f"{'object' if sensor_moves else 'sensor'}; the limit is {FARTHEST_MM:g} mm",
                hint="give places in mm, the object's in the frame of the sensor",
                at="press.trajectory",
            )

    @property
    def sliding(self) -> bool:
        """Whether shear or twist frames follow the approach."""
        return any(self.shear_mm) or bool(self.twist_deg)

    @property
    def approach_frames(self) -> int:
        """Frames of approach, shear and twist, after which the strokes begin."""
        return self.frames * (2 if self.sliding else 1)

    @property
    def frame_count(self) -> int:
        """Frames in all."""
        driven = max((actuation.last_frame for actuation in self.actuations), default=0)
        if self.trajectory is not None:
            return max(self.trajectory.frame_count, driven)
        moved = self.approach_frames + sum(stroke.frames for stroke in self.strokes)
        return max(moved, driven)

    def times_s(self) -> np.ndarray:
        """Label of the start and of every frame [s], shape (frame_count + 1,).

        A press has no times: its frames count as seconds. Frames after a trajectory's end too.
        """
        if self.trajectory is None:
            return np.arange(self.frame_count + 1.0)
        known = self.trajectory.frame_times_s()
        later = np.arange(1.0, self.frame_count + 2.0 - len(known))
        return np.append(known, known[-1] + later)

    @property
    def notice(self) -> str:
        """What is odd about this press but allowed, else ""."""
        if self.trajectory is not None:
            return self.trajectory.notice
        moves = self.depth_mm or self.sliding or self.strokes or self.actuations
        if moves:
            return ""
        return (
            "press depth 0 mm is first touch: nothing is deformed and no force is due; "
            "give a depth to press"
        )


class Extent(enum.StrEnum):
    """How much of the membrane takes part."""

    ACTIVE = "active"
    """The region around the contact."""
    FULL = "full"
    """All of it."""


class Method(enum.StrEnum):
    """How the contact is computed."""

    LATTICE = "lattice"
    """Total-Lagrangian B-spline MPM with penalty contact: the workbench's own."""
    PARTICLES = "particles"
    """The published way, for comparison: updated-Lagrangian MPM, the indenter made of particles."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactSettings:
    """Numerical choices of the contact solver."""

    grid_mm: float = 0.5
    """Edge of a background grid cell [mm]; a quarter of a 2 mm wall."""
    active_radius_mm: float = 0.0
    """Cells within this distance of the target take part [mm]; 0 lets patch and wall decide."""
    region_error: float = 3e-3
    """Error of the force that the automatic radius may cost, relative [1]."""
    extent: Extent = Extent.ACTIVE
    method: Method = Method.LATTICE
    penalty: float = 200.0
    """Contact stiffness per area in units of E / grid_mm [1]."""
    tolerance: float = 1e-3
    """Out-of-balance force over the reaction at which a frame counts as settled [1]."""
    max_substeps: int = 6000
    """Substeps of relaxation per frame before giving up."""

    def __post_init__(self) -> None:
        at = "contact.grid_mm"
        within(self.grid_mm, 0.1, 3.0, what="grid spacing", unit="mm", at=at)
        at = "contact.active_radius_mm"
        if self.active_radius_mm != 0.0:
            hint = "or 0, and the contact patch and the wall decide"
            radius_mm = self.active_radius_mm
            within(radius_mm, 3.0, 200.0, what="active radius", unit="mm", at=at, hint=hint)
        at = "contact.region_error"
        within(self.region_error, 1e-5, 0.05, what="error of the region", unit="", at=at)
        within(self.penalty, 1.0, 1e4, what="contact penalty", unit="", at="contact.penalty")
        within(self.tolerance, 1e-6, 0.1, what="tolerance", unit="", at="contact.tolerance")
        at = "contact.max_substeps"
        within(self.max_substeps, 10, 1_000_000, what="substep limit", unit="", at=at)
