"""Geoms of a MuJoCo model as objects of `wb.Sensor`, in mm.

Balls, cylinders, capsules and cubes are known in closed form, of any size; the others, and several
geoms of one body together, as triangles. Edges of cylinders and cubes are rounded by .45 mm, as
everywhere here; what is known by triangles, by half a millimetre or so.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from sim.contact.objects.collider import Collider
from workbench.core.base.errors import DesignError
from workbench.core.base.poses import rotations
from workbench.core.objects.kind import USUAL_EDGE_SHARE, Shape
from workbench.core.press.indenter import DEFAULT_EDGE_RADIUS_MM
from workbench.sensor.things import Thing, mesh_thing
from workbench.simulators.mujoco_module import MjModel, mujoco

MM_OF_M = 1e3
AROUND = 64
"""Sides of a round geom that becomes triangles."""
FINE = 4
"""Divisions of a ball that becomes triangles: 5,120 of them."""


def thing_of_geom(model: MjModel, geom: int) -> Thing:
    """A geom as an object, in its own frame.

    Raises:
        DesignError: If it is a plane or a height field, or a mesh that is open or too large.
    """
    kind, (x, y, z) = _kind(model, geom), model.geom_size[geom] * MM_OF_M
    if kind == "SPHERE":
        return Thing(name="sphere", collider=_ball(x))
    if kind == "CAPSULE":
        return Thing(name="capsule", collider=_round(0.0, y, x))
    if kind == "CYLINDER":
        edge_mm = _edge_mm(2.0 * min(x, y))
        return Thing(name="cylinder", collider=_round(x - edge_mm, y - edge_mm, edge_mm))
    if kind == "BOX" and x == y == z:
        return Thing(name="cube", collider=_cube(x))
    mesh = _triangles(model, geom)
    return mesh_thing(np.asarray(mesh.vertices), np.asarray(mesh.faces))


def thing_of_geoms(model: MjModel, geoms: Sequence[int]) -> Thing:
    """Several geoms of one body as one object, in the body's frame.

    Raises:
        DesignError: As `thing_of_geom`.
    """
    import trimesh

    placed = []
    for geom in geoms:
        mesh = _triangles(model, geom)
        transform = np.eye(4)
        transform[:3, :3] = rotations(model.geom_quat[geom])
        transform[:3, 3] = model.geom_pos[geom] * MM_OF_M
        placed.append(mesh.apply_transform(transform))
    whole = trimesh.boolean.union(placed, engine="manifold")
    return mesh_thing(np.asarray(whole.vertices), np.asarray(whole.faces))


def distances_mm(thing: Thing, points_mm: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """Signed distances of points, (N, 3), from an object at a pose, (7,): shape (N,).

    Of an object of triangles only a lower bound, beyond half a millimetre off.
    """
    (placed,) = thing.placed(pose[None])
    return thing.collider.distance((points_mm - placed[:3]) @ rotations(placed[3:]))[0]


def _kind(model: MjModel, geom: int) -> str:
    return mujoco().mjtGeom(int(model.geom_type[geom])).name.removeprefix("mjGEOM_")


def _ball(radius_mm: float) -> Collider:
    return _collider(Shape.SPHERE, (radius_mm, 0.0, 0.0), radius_mm, radius_mm)


def _round(radius_mm: float, half_mm: float, edge_mm: float) -> Collider:
    """A cylinder along Z, offset outwards: a capsule where its radius is zero.

    What is longer than wide is pressed with its side, which has no edge.
    """
    wide_mm, high_mm = radius_mm + edge_mm, half_mm + edge_mm
    sharpest_mm = wide_mm if high_mm > wide_mm else edge_mm
    return _collider(Shape.CYLINDER_Z, (radius_mm, half_mm, edge_mm), high_mm, sharpest_mm)


def _cube(half_mm: float) -> Collider:
    edge_mm = _edge_mm(2.0 * half_mm)
    inner_mm = half_mm - edge_mm
    return _collider(Shape.CUBE, (inner_mm, inner_mm, edge_mm), half_mm, edge_mm)


def _edge_mm(width_mm: float) -> float:
    return min(DEFAULT_EDGE_RADIUS_MM, USUAL_EDGE_SHARE * width_mm)


def _collider(
    shape: Shape, numbers: tuple[float, float, float], high_mm: float, sharpest_mm: float
) -> Collider:
    wide_mm = numbers[0] + numbers[2]
    across_mm = {Shape.SPHERE: 0.0, Shape.CYLINDER_Z: wide_mm, Shape.CUBE: 2.0**0.5 * wide_mm}
    return Collider(
        shape=shape,
        size=np.array([*numbers, 0.0, 0.0, 0.0, 0.0, 0.0]),
        samples=np.zeros((1, 1, 1)),
        reach_mm=float(np.hypot(across_mm[shape], high_mm)),
        half_height_mm=high_mm,
        least_radius_mm=sharpest_mm,
    )


def _triangles(model: MjModel, geom: int) -> Any:
    """A geom's surface in its own frame, a `trimesh.Trimesh`."""
    import trimesh

    made, (x, y, z) = trimesh.creation, model.geom_size[geom] * MM_OF_M
    match _kind(model, geom):
        case "BOX":
            return made.box((2.0 * x, 2.0 * y, 2.0 * z))
        case "SPHERE":
            return made.icosphere(FINE, x)
        case "ELLIPSOID":
            return made.icosphere(FINE).apply_scale((x, y, z))
        case "CYLINDER":
            return made.cylinder(x, 2.0 * y, sections=AROUND)
        case "CAPSULE":
            return made.capsule(2.0 * y, x, count=(AROUND, AROUND))
        case "MESH" | "SDF":
            return _mesh(model, int(model.geom_dataid[geom]))
    raise DesignError(
        f"the geom {model.geom(geom).name!r} is a {_kind(model, geom).lower()}, which has no end",
        hint="stand in for it by a box",
        at="geoms",
    )


def _mesh(model: MjModel, mesh: int) -> Any:
    import trimesh

    first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
    begin, faces = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    return trimesh.Trimesh(
        model.mesh_vert[first : first + count].astype(float) * MM_OF_M,
        model.mesh_face[begin : begin + faces],
        process=False,
    )
