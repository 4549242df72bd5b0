"""A twin's scene for `mitsuba_tracer`, written without Mitsuba: meshes, lights, camera, coating."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera, LensModel
from workbench.core.design.optics import Coating, Optics
from workbench.core.result.results import MembraneMesh

if TYPE_CHECKING:
    from sim.optics.transport.sources import Sources

ARRAYS, SEEN = "scene.npz", "seen.npz"
"""In a scene's folder: what the tracer reads, and what it leaves."""
SKIN, WALL, DISCS = "skin.ply", "wall.ply", "discs.ply"
AROUND = 24
"""Corners of an LED's disc."""
ALUMINIUM = 0.91
"""Reflectance of aluminium in visible light. Source: Rakic, Applied Optics 34 (1995), 4755."""
MOST_FLAKES = 0.98
"""Share of the coating that flakes may be [1]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Pose:
    """One photograph's skin and random numbers."""

    displacement_mm: np.ndarray | None
    """Of the seen skin's vertices, shape (V, 3); None at rest."""
    photons: int
    seed: int


def write_scene(
    folder: Path, mesh: MembraneMesh, optics: Optics, pose: Pose, ambient: np.ndarray
) -> None:
    """Write the files that the tracer reads.

    Args:
        folder: There already.
        mesh: The skins; the seen one is coated.
        optics: LEDs, camera, coating, index.
        pose: Of the skin.
        ambient: Radiance of the skin in the ambient light, shape (3,).

    Raises:
        DesignError: If the camera's lens is none that Mitsuba has.
    """
    from geometry.surface.surface import face_areas, vertex_normals
    from sim.optics.light.lights import place_leds
    from sim.optics.proof.mitsuba_scene import ply_bytes
    from sim.optics.transport.scene import open_scene
    from sim.optics.transport.sources import open_sources
    from sim.optics.transport.view import directions_to_camera

    check_lens(optics.camera)
    skin, wall = mesh.seen, mesh.cavity
    points = np.asarray(skin.points_mm, np.float64)
    if pose.displacement_mm is not None:
        points = points + pose.displacement_mm
    # Light comes from inside: faces look there.
    faces = skin.faces[:, ::-1]
    transport = optics.transport
    if transport is None:
        raise ValueError("photons trace light")
    leds = place_leds(optics.ring, optics.lamps)
    sources = open_sources(leds, open_scene(mesh, transport, displacement_mm=pose.displacement_mm))
    third = np.repeat(face_areas(points, skin.faces) / 3.0, 3)
    index = optics.refractive_index
    discs = np.flatnonzero(~sources.in_shell.astype(bool))
    arrays = {
        "index": np.array(index),
        "photons": np.array(pose.photons),
        "seed": np.array(pose.seed),
        "coating": np.array(flakes_of(optics.coating)),
        "faces": faces,
        "vertex_mm2": np.bincount(skin.faces.ravel(), third, len(points)),
        "to_camera": directions_to_camera(points, mesh, optics.camera, index),
        "ambient": ambient,
        "position_mm": sources.position_mm,
        "axis": sources.axis,
        "emission": sources.emission,
        "power": sources.power * sources.strongest,
        "disc_radiance": np.repeat(_disc_radiance(sources, discs), AROUND, axis=0),
        "camera": camera_pose(optics.camera),
        "fov_x_deg": np.array(optics.camera.fov_x_deg),
        "size_px": np.array([optics.camera.width_px, optics.camera.height_px]),
    }
    packed = io.BytesIO()
    np.savez(packed, allow_pickle=False, **arrays)
    (folder / ARRAYS).write_bytes(packed.getvalue())
    normals = vertex_normals(points, skin.faces)
    (folder / SKIN).write_bytes(ply_bytes(points, -normals, faces))
    (folder / WALL).write_bytes(ply_bytes(wall.points_mm, wall.normals, wall.faces))
    (folder / DISCS).write_bytes(ply_bytes(*disc_mesh(sources, discs)))


def check_lens(camera: Camera) -> None:
    """Refuse a lens that Mitsuba has no like of.

    Raises:
        DesignError: Naming it.
    """
    if camera.lens is not LensModel.PINHOLE:
        raise DesignError(
            f"Mitsuba has no {camera.lens.value} lens",
            hint="choose lens = 'pinhole', or photograph the twin by photons: --light photons",
            at="optics.camera.lens",
        )


def flakes_of(coating: Coating) -> tuple[float, float, float]:
    """Reflectance of a matte binder, share of aluminium flakes in it, roughness of their slopes.

    Together they send back what the product's coating does of light along the normal: flakes
    F0 / R of it, R aluminium's reflectance, and the binder the rest, rho (1 - F0).
    """
    share = min(coating.specular / ALUMINIUM, MOST_FLAKES)
    matte = coating.albedo * (1.0 - coating.specular) / (1.0 - share)
    return min(matte, 1.0), share, coating.roughness


def camera_pose(camera: Camera) -> np.ndarray:
    """From Mitsuba's camera, +X to the left, +Y up, to the sensor frame, shape (4, 4)."""
    from sim.optics.camera.camera import rotation_camera_to_sensor

    x, y, z = rotation_camera_to_sensor(camera).T
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = np.column_stack([-x, -y, z]), camera.position_mm
    return pose


def disc_mesh(sources: Sources, discs: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, normals, each (D `AROUND`, 3), and faces of lights as polygons that shine forward."""
    turn = 2.0 * np.pi * np.arange(AROUND) / AROUND
    points, normals = np.zeros((len(discs), AROUND, 3)), np.zeros((len(discs), AROUND, 3))
    for row, number in enumerate(discs):
        axis = sources.axis[number].astype(np.float64)
        helper = np.eye(3)[np.argmin(np.abs(axis))]
        x = np.cross(helper, axis)
        x *= sources.emission[number, 2] / np.linalg.norm(x)
        ring = np.cos(turn)[:, None] * x + np.sin(turn)[:, None] * np.cross(axis, x)
        points[row], normals[row] = sources.position_mm[number] + ring, axis
    fan = np.array([[0, k, k + 1] for k in range(1, AROUND - 1)])
    faces = (fan + AROUND * np.arange(len(discs))[:, None, None]).reshape(-1, 3)
    return points.reshape(-1, 3), normals.reshape(-1, 3), faces.astype(np.int32)


def _disc_radiance(sources: Sources, discs: np.ndarray) -> np.ndarray:
    """P / (pi A) of each disc, in air, shape (D, 3)."""
    area_mm2 = np.pi * sources.emission[discs, 2].astype(np.float64) ** 2
    power = sources.power[discs] * sources.strongest
    return power / (np.pi * np.maximum(area_mm2, 1e-9))[:, None]
