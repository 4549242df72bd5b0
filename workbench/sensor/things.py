"""Objects of a sensor in a loop, and where their frames are."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sim.condensed.lessons import collider_of
from sim.contact.objects.collider import Collider
from workbench.core.base.poses import rotations


def _at_origin() -> np.ndarray:
    return np.zeros(3)


@dataclass(frozen=True, kw_only=True, slots=True)
class Thing:
    """A rigid object, ready to press."""

    name: str
    collider: Collider
    centre_mm: np.ndarray = field(default_factory=_at_origin)
    """Where the collider's origin lies in the frame that poses are of, shape (3,): the middle of
    the box around a mesh that has a frame of its own."""

    def placed(self, poses: np.ndarray) -> np.ndarray:
        """Poses of the collider, (B, 7), from those of the object's own frame."""
        found = poses.copy()
        found[:, :3] += self.arms_mm(poses)
        return found

    def about_origin(
        self, poses: np.ndarray, force_N: np.ndarray, moment_Nmm: np.ndarray
    ) -> np.ndarray:
        """Moments about the origin of the object's own frame, (B, 3)."""
        return moment_Nmm + np.cross(self.arms_mm(poses), force_N).astype(moment_Nmm.dtype)

    def arms_mm(self, poses: np.ndarray) -> np.ndarray:
        """Ways from the origin of the object's own frame to the collider's, (B, 3)."""
        return rotations(poses[:, 3:]) @ self.centre_mm


def mesh_thing(points_mm: np.ndarray, faces: np.ndarray) -> Thing:
    """An object of triangles, (F, 3), between points, (P, 3); it keeps its frame.

    Raises:
        DesignError: If the mesh is open, encloses no volume, or has too many triangles.
    """
    import trimesh

    from workbench.edit.indenter_choice import choose_indenter

    used = points_mm[np.unique(faces)] if len(faces) else points_mm
    mesh = trimesh.Trimesh(points_mm, faces, process=False)
    # What refuses bad meshes reads files.
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mesh.stl"
        mesh.export(path)
        indenter = choose_indenter(str(path))
    centre_mm = 0.5 * (used.min(axis=0) + used.max(axis=0)) if len(used) else np.zeros(3)
    return Thing(name="mesh", collider=collider_of(indenter), centre_mm=centre_mm)
