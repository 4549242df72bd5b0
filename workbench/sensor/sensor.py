"""`wb.Sensor`: poses of an object in, images and forces out.

    sensor = wb.Sensor.load("geltip")            # or the folder of a pack
    ball = sensor.object("sphere", size_mm=6)
    frame = sensor.render(poses, ball)           # (B, 7): x, y, z [mm], qw, qx, qy, qz
    frame.rgb, frame.force_N, frame.depth_mm

Row b of the poses is sensor b, and a call is the next moment of its life: what sticks stays where
it stuck. `reset` forgets, `state` and `restore` keep. Without friction equal poses give equal
answers whatever the way there.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from sim.condensed.fast_contact import FastContact, Touch
from sim.condensed.growing import GrowingContact
from sim.condensed.lessons import collider_of
from sim.condensed.tensors import touch_tensors
from sim.optics.raster.imager import Imager
from workbench.core.base.errors import DesignError
from workbench.core.base.packages import naming_packages
from workbench.planning.plan import StageMonitor
from workbench.project.project import Project
from workbench.sensor.frame import Felt, Frame
from workbench.sensor.pack import Pack, is_pack, read_pack
from workbench.sensor.tensor_frame import Range, TensorEye, TensorFelt, TensorFrame, felt_tensors
from workbench.sensor.things import Thing, mesh_thing

if TYPE_CHECKING:
    import torch

FEW_NODES = 6
"""Nodes that touch below which forces are coarse."""
UNSETTLED_MM = 0.02
"""Change of the last round beyond which a frame is not settled [mm]."""
DEEPER = 1.1
"""Indentation beyond the deepest that was fitted, as a factor, that is worth a word."""


class Sensor:
    """One design, any number of them side by side, on the compute device."""

    def __init__(self, pack: Pack, fast: GrowingContact | None = None) -> None:
        """From a pack; `fast` where its skin is bare."""
        from workbench.pipeline.devices import open_device

        open_device()
        self.name, self.skin, self.law = pack.name, pack.skin, pack.law
        self.left_out = pack.left_out
        """What the design's camera does that images do not show."""
        self._fast = fast or FastContact(pack.skin, pack.law, pack.material)
        self._imager = Imager.from_state(pack.images)
        self._surface = pack.surface
        self._rest_depth_mm = pack.rest_depth_mm
        self._count = 0
        self._tensor_eye: TensorEye | None = None

    @classmethod
    def load(
        cls,
        source: Path | str,
        *,
        project: Project | Path | str | None = None,
        width_px: int | None = None,
        at_once: bool = False,
        monitor: StageMonitor | None = None,
    ) -> Self:
        """A sensor from the folder of a pack, or from a design by name or file.

        What a design lacks is computed first and kept in the project: minutes for a new one.

        Args:
            source: Folder of a pack, or the name or file of a design.
            project: Where results of a design are kept; as for `wb.evaluate`.
            width_px: Width of its images; a pack has its own.
            at_once: Begin with what is quick: how the skin gives is found where it is touched, a
                second or two for each new place, and forces follow a law for all skins unless the
                design's own presses are in the project. `law.errors` has what that was off by.
            monitor: Told stage, fraction and note while something is computed.

        Raises:
            DesignError: If there is no such pack or design, or it cannot be condensed.
        """
        path = Path(source)
        if is_pack(path):
            if width_px is not None:
                raise DesignError(
                    "the images of a pack have the size that they were packed with",
                    hint="leave width_px out, or load the design",
                    at="width_px",
                )
            return cls(read_pack(path))
        from workbench.sensor.making import make_growing, make_pack

        if at_once:
            where = (str(source), project)
            return cls(*make_growing(*where, width_px=width_px, monitor=monitor))
        return cls(make_pack(str(source), project, width_px=width_px, monitor=monitor))

    @property
    def image_px(self) -> tuple[int, int]:
        """Width and height of its images."""
        rows, columns = self._imager.shape
        return columns, rows

    def object(
        self, shape: str | Path | tuple[np.ndarray, np.ndarray] | Any, **options: Any
    ) -> Thing:
        """An object by name, from a file, or as a mesh.

        Args:
            shape: As `wb.choose_indenter` takes it, or points (P, 3) [mm] and triangles (F, 3), or
                anything with `vertices` and `faces`.
            options: Those of `wb.choose_indenter`: `size_mm`, `edge_radius_mm`, `texture`.

        Raises:
            DesignError: If there is no such object, or its mesh is open or without volume.
        """
        if isinstance(shape, (str, Path)):
            from workbench.edit.indenter_choice import choose_indenter

            indenter = choose_indenter(str(shape), **options)
            return Thing(name=indenter.kind.value, collider=collider_of(indenter))
        points, faces = shape if isinstance(shape, tuple) else (shape.vertices, shape.faces)
        return mesh_thing(np.asarray(points, float), np.asarray(faces, int))

    def reset(self, count: int | None = None) -> None:
        """Forget all touches; of so many sensors from now on."""
        self._count = count or max(self._count, 1)
        self._fast.reset(self._count)

    def render(self, poses: np.ndarray, thing: Thing) -> Frame:
        """The next moment of each sensor.

        Args:
            poses: x, y, z [mm], qw, qx, qy, qz of the object in each sensor's frame, (B, 7) or
                (7,). Another number of rows than before begins anew.
            thing: What `object` made.

        Raises:
            DesignError: If a pose is not finite or its quaternion is zero.
            SolveError: If a press touches too much of the skin at once.
        """
        rows, touch = self._touched(poses, thing)
        moved = self._surface.displacement_mm(touch.displacement_mm)
        return Frame(
            rgb=self.drawn(moved),
            looks=lambda: self._looked(moved),
            **self._felt(rows, touch, thing),
        )

    def feel(self, poses: np.ndarray, thing: Thing) -> Felt:
        """The next moment of each sensor without images; as `render`."""
        rows, touch = self._touched(poses, thing)
        return Felt(**self._felt(rows, touch, thing))

    def render_tensors(self, poses: np.ndarray | torch.Tensor, thing: Thing) -> TensorFrame:
        """As `render`, but all that is felt and seen stays on the device, as tensors of PyTorch.

        On a GPU nothing but the poses goes through the processor's memory.

        Raises:
            PackageError: If PyTorch is not installed.
            DeviceError: If the device is a GPU that this build of PyTorch does not know.
            DesignError, SolveError: As `render`.
        """
        felt = self.feel_tensors(poses, thing)
        if self._tensor_eye is None:
            self._tensor_eye = TensorEye(self._surface, self._imager, self._rest_depth_mm)
        return self._tensor_eye.frame(felt)

    def feel_tensors(self, poses: np.ndarray | torch.Tensor, thing: Thing) -> TensorFelt:
        """The same without images."""
        with naming_packages():
            import torch
        rows = self._ready(poses.cpu() if isinstance(poses, torch.Tensor) else poses)
        self._fast.advance(thing.collider, thing.placed(rows))
        touch = touch_tensors(self._fast.felt, len(rows), len(self.skin.points_mm))
        within = Range(
            deepest=DEEPER * self.law.deepest, unsettled_mm=UNSETTLED_MM, fewest=FEW_NODES
        )
        return felt_tensors(touch, thing.arms_mm(rows), within)

    def drawn(self, moved_mm: np.ndarray) -> np.ndarray:
        """Images of a skin that moved, (B, V, 3) [mm] at drawn vertices: (B, H, W, 3), uint8."""
        return self._imager.images(moved_mm)

    def _ready(self, poses: Any) -> np.ndarray:
        """Checked poses, and as many sensors as they are."""
        rows = checked_poses(poses)
        if len(rows) != self._count:
            self.reset(len(rows))
        return rows

    def _touched(self, poses: np.ndarray, thing: Thing) -> tuple[np.ndarray, Touch]:
        rows = self._ready(poses)
        return rows, self._fast.step(thing.collider, thing.placed(rows))

    def _felt(self, rows: np.ndarray, touch: Touch, thing: Thing) -> dict[str, Any]:
        notes = tuple(self._note(touch, row) for row in range(len(rows)))
        return {
            "force_N": touch.force_N,
            "torque_Nmm": thing.about_origin(rows, touch.force_N, touch.moment_Nmm),
            "displacement_mm": touch.displacement_mm,
            "pressure_MPa": touch.pressure_MPa,
            "slip": touch.sliding,
            "within_range": np.array([not note for note in notes]),
            "notes": notes,
        }

    def state(self) -> dict[str, np.ndarray]:
        """What all sensors remember, as arrays."""
        return self._fast.state()

    def restore(self, state: dict[str, np.ndarray]) -> None:
        """Go back to a `state`."""
        self._fast.restore(state)
        self._count = self._fast.presses

    def _note(self, touch: Touch, row: int) -> str:
        deepest, touching = float(touch.deepest[row]), int(touch.touching[row])
        if touching and deepest > DEEPER * self.law.deepest:
            return (
                f"indented by {deepest:.2f} of the wall; forces were fitted up to "
                f"{self.law.deepest:.2f}"
            )
        if touch.settled_mm[row] > UNSETTLED_MM:
            return f"not settled: the skin still moves by {touch.settled_mm[row]:.3f} mm"
        if 0 < touching < FEW_NODES:
            return f"{touching} nodes touch: the force is coarse"
        return ""

    def _looked(self, moved_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Depths (B, H, W) and dots (B, M, 2) of displaced skins, (B, V, 3)."""
        imager = self._imager
        depths, dots = [], []
        for one in moved_mm:
            imager.look(one[None])
            normal = np.zeros((imager.raster.pixels, 3), dtype=np.float32)
            depth = self._rest_depth_mm.copy().ravel()
            imager.describe(normal, depth)
            depths.append(depth.reshape(imager.shape))
            if len(imager.backdrop.dots_mm):
                dots.append(imager.marker_px())
        none = np.zeros((len(moved_mm), 0, 2), dtype=np.float32)
        return np.stack(depths), np.stack(dots) if dots else none


def checked_poses(poses: np.ndarray) -> np.ndarray:
    """Poses with unit quaternions, shape (B, 7), float64.

    Raises:
        DesignError: If the shape is another, a number is not finite, or a quaternion is zero.
    """
    rows = np.atleast_2d(np.asarray(poses, dtype=np.float64)).copy()
    hint = "a row is x, y, z [mm], qw, qx, qy, qz; (1, 0, 0, 0) is no turn"
    if rows.ndim != 2 or rows.shape[1] != 7 or not len(rows):
        raise DesignError(f"poses have shape {np.shape(poses)}, not (B, 7)", hint=hint, at="poses")
    for number, row in enumerate(rows):
        if not np.isfinite(row).all():
            raise DesignError(f"pose {number} is not finite: {row.tolist()}", hint=hint, at="poses")
        if np.linalg.norm(row[3:]) < 1e-6:
            raise DesignError(f"pose {number} has a quaternion of length 0", hint=hint, at="poses")
    rows[:, 3:] /= np.linalg.norm(rows[:, 3:], axis=1, keepdims=True)
    return rows
