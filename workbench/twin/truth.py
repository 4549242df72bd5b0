"""What a photograph of a twin really shows: `truth/NAME.npz` beside its folders."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.result.force_field import ForceField
from workbench.core.result.results import MembraneMesh
from workbench.system.whole_files import write_atomically
from workbench.twin.cases import TwinCase
from workbench.twin.contact import seen_displacement_mm

FOLDER = "truth"


@dataclass(frozen=True, kw_only=True, slots=True)
class Truth:
    """Of one photograph: V vertices of the skin that the camera looks at, F triangles."""

    rest_mm: np.ndarray
    """Vertices of the untouched skin, shape (V, 3), float32, sensor frame."""
    displaced_mm: np.ndarray
    """The same in the photograph."""
    faces: np.ndarray
    """Shape (F, 3), int32, counter-clockwise from outside."""
    normals: np.ndarray
    """Unit normals at rest, out of the sensor, shape (V, 3), float32."""
    pressure_MPa: np.ndarray
    """Contact pressure at the vertices, shape (V,), float32; of none where pins are seen."""
    contact_force_N: np.ndarray
    """Force of the object on the vertices, shape (V, 3), float32; likewise."""
    force_N: np.ndarray
    """Force on the membrane, shape (3,)."""
    object_pose: np.ndarray
    """x, y, z [mm], qw, qx, qy, qz of the object in the sensor frame, shape (7,)."""
    target_mm: np.ndarray
    """Where the object touched first, shape (3,)."""
    depth_mm: float
    """From first touch."""
    object_name: str


def truth_of(mesh: MembraneMesh, case: TwinCase, field: ForceField, frame: int) -> Truth:
    """What a frame of a path did to the skin."""
    seen, touched = mesh.seen, mesh.seen is mesh.outer
    moved_mm = seen_displacement_mm(mesh, field)[frame]
    pressure = field.pressure_MPa[frame] if touched else np.zeros(0)
    force = field.contact_force_N[frame] if touched else np.zeros((0, 3))
    return Truth(
        rest_mm=seen.points_mm.astype(np.float32),
        displaced_mm=(seen.points_mm + moved_mm).astype(np.float32),
        faces=seen.faces.astype(np.int32),
        normals=seen.normals.astype(np.float32),
        pressure_MPa=pressure.astype(np.float32),
        contact_force_N=force.astype(np.float32),
        force_N=-field.reaction_N[frame],
        object_pose=field.indenter_pose[frame],
        target_mm=field.target_mm,
        depth_mm=case.depth_at_mm(frame),
        object_name=case.name,
    )


def write_truth(folder: Path, name: str, truth: Truth) -> None:
    """Write `truth/NAME.npz` below a twin's folder.

    Raises:
        StoreError: If it cannot be written.
    """
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **{each: getattr(truth, each) for each in Truth.__slots__})
    write_atomically(folder / FOLDER / f"{name}.npz", buffer.getvalue())


def read_truth(path: Path) -> Truth:
    """Read one.

    Raises:
        DesignError: If there is none, or it is no truth of a photograph.
    """
    try:
        with np.load(path) as held:
            values = {name: held[name] for name in Truth.__slots__}
    except (OSError, ValueError, KeyError) as error:
        raise DesignError(
            f"{path} holds no truth of a photograph: {error}",
            hint="name a file that `workbench twin` wrote below truth",
            at="--truth",
        ) from error
    values["depth_mm"] = float(values["depth_mm"])
    values["object_name"] = str(values["object_name"])
    return Truth(**values)
