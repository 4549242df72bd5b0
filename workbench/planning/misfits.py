"""What will be refused, told from the body alone: lights, cameras, target and depth.

Meshing, lattice and bake take from seconds to minutes, and each refuses what does not fit when its
turn comes. The same checks need no more than the faces of the built body, which are there within a
second: the outer skin, the face behind it and the air side of the support, as the CAD kernel left
them. Left out: what only the path of a trajectory, strokes or drives can tell.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from geometry.surface.rays import RayCaster
from geometry.surface.surface_place import place_near
from geometry.volume.skins import rough_skins
from sim.contact.motion.approach import expect_near, plan_approach
from sim.contact.objects.collider import Collider, make_collider
from sim.contact.readout.verdict import check_depth
from sim.contact.region.backing import support_points_mm
from sim.optics.light.places import camera_field, check_camera, check_lights
from workbench.core.base.errors import DesignError
from workbench.core.design.optics import Optics
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import Press
from workbench.core.result.results import MembraneMesh, Skin, Solid

COARSE_MM = 1.5
"""Grid on which an object without a closed form is sampled here [mm]: a twentieth of a second."""
EDGE_MM = 0.7
"""Edge to which skins are divided around the press [mm]: no object slips between such points."""
NEAR_MM = 8.0
"""Reach of that around the object, beyond its own [mm]."""
AHEAD_MM = 1e-3
"""Distance inside the skin at which the ray through the wall begins [mm]."""


def misfits(
    solid: Solid,
    optics: Optics | None,
    indenter: Indenter | None = None,
    press: Press | None = None,
) -> list[DesignError]:
    """Everything that the stages would refuse, the first for each light, camera and press.

    Args:
        solid: The built body.
        optics: Lights and cameras; None leaves them out.
        indenter: The object; without it and a press only the optics is looked at.
        press: Where and how far.
    """
    mesh = rough_skins(solid)
    found: list[DesignError] = []
    checks = [] if optics is None else list(_optical(mesh, optics))
    if indenter is not None and press is not None and press.trajectory is None:
        checks.append(lambda: _check_press(mesh, indenter, press))
    for check in checks:
        try:
            check()
        except DesignError as error:
            found.append(error)
    return found


def _optical(mesh: MembraneMesh, optics: Optics) -> Iterator[Callable[[], None]]:
    yield lambda: check_lights(mesh, optics.ring, optics.lamps)
    for camera in optics.all_cameras:
        yield lambda camera=camera: check_camera(mesh, camera, at=camera_field(optics, camera))


def _check_press(mesh: MembraneMesh, indenter: Indenter, press: Press) -> None:
    """Refuse a target off the skin, and a depth that reaches the support.

    Raises:
        DesignError: With the distance, or the largest depth that fits [mm].
    """
    outer = mesh.outer
    place = place_near(outer.points_mm, outer.faces, press.target_mm)
    expect_near(press, place.point_mm, place.distance_mm)
    if press.actuations or indenter.soft is not None:
        # Driven regions move the skin, and a soft object gives way itself.
        return
    if indenter.mesh is not None or indenter.texture.raised:
        _check_wall(mesh, place.point_mm, place.normal, press.depth_mm)
        return
    collider = _collider(indenter)
    reach_mm = collider.reach_mm + press.depth_mm + NEAR_MM
    around = dataclasses.replace(
        mesh,
        outer=_around(mesh.outer, place.point_mm, reach_mm),
        inner=_around(mesh.inner, place.point_mm, reach_mm),
    )
    approach = plan_approach(around.outer, collider, press)
    check_depth(support_points_mm(around), approach)


@functools.lru_cache(maxsize=4)
def _collider(indenter: Indenter) -> Collider:
    """The object's distance, kept while a slider moves something else."""
    return make_collider(indenter, grid_mm=COARSE_MM)


def _check_wall(
    mesh: MembraneMesh, place_mm: np.ndarray, normal: np.ndarray, depth_mm: float
) -> None:
    """Refuse a depth of more than the wall has there: the object's first touch is on the way."""
    inner = mesh.inner
    start = (place_mm - AHEAD_MM * normal)[None]
    distance_mm = float(RayCaster(inner.points_mm, inner.faces).hits(start, -normal[None])[0][0])
    wall_mm = distance_mm + AHEAD_MM + mesh.backing_mm
    if depth_mm > wall_mm:
        raise DesignError(
            f"at a depth of {depth_mm:g} mm the object reaches the support; the wall is "
            f"{wall_mm:.1f} mm there",
            hint="lower press.depth_mm or raise layers.elastomer_mm",
            at="press.depth_mm",
        )


def _around(skin: Skin, place_mm: np.ndarray, reach_mm: float) -> Skin:
    """The part of a skin around a place, in triangles of an even size: a touch is found between
    corners, and a straight wall has them only at its ends.
    """
    import trimesh

    from geometry.surface.surface import vertex_normals

    corners = skin.points_mm[skin.faces]
    low, high = corners.min(axis=1), corners.max(axis=1)
    near = ((low < place_mm + reach_mm) & (high > place_mm - reach_mm)).all(axis=1)
    divided: Any = trimesh.remesh.subdivide_to_size(
        skin.points_mm, skin.faces[near], EDGE_MM, return_index=True
    )
    points, faces, origin = divided
    corners = points[faces]
    low, high = corners.min(axis=1), corners.max(axis=1)
    kept = ((low < place_mm + reach_mm) & (high > place_mm - reach_mm)).all(axis=1)
    used, renumbered = np.unique(faces[kept], return_inverse=True)
    return Skin(
        points_mm=points[used],
        faces=renumbered.reshape(-1, 3).astype(np.int32),
        normals=vertex_normals(points, faces)[used],
        labels=skin.labels[near][origin][kept],
        numbers=skin.numbers[near][origin][kept],
    )
