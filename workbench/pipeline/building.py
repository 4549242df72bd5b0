"""From parameters to a body that has been checked, whatever the CAD kernel does.

Three rungs: the family's B-rep; once more with its fillets softened; its signed distance fields.
Each result must be watertight, one body, and of the volume that two other ways agree on: the
kernel's own for the same body, and a coarse integral of the fields, which knows nothing of the
kernel. A body from fields must also have its wall everywhere. What had to be
changed stands in `Solid.notice`.

The kernel (OCCT) reports failures as errors of its own, or not at all; both lead one rung down.
Leaves out: features smaller than the tolerances here; families check for those one by one.
"""

from __future__ import annotations

import dataclasses
import functools
from typing import Any

import numpy as np

from designs.bodies import WALL_SHARE
from workbench.core.base.errors import GeometryError, MeshingError
from workbench.core.design.design import Layers
from workbench.core.result.results import Label, Solid

SURFACE_LIMIT = 0.003
"""Triangles' volume against the kernel's."""
FINENESS = (1.0, 8.0)
"""How finely a body is tessellated, first and where its volume is then off by too much."""
FIELD_LIMIT = 0.03
"""Volume against the coarse integral of the fields."""
COARSE_MM = 1.0
"""Grid of that integral [mm]: 10 to 40 ms a body."""


def build_solid(family: Any, shape: Any, layers: Layers) -> Solid:
    """The labelled, checked body of a family.

    Args:
        family: As `designs.family.Family`.
        shape: The family's parameters.

    Raises:
        DesignError: If the parameters contradict each other.
        MeshingError: If not even signed distance gives a usable body.
    """
    expected_mm3 = coarse_volume_mm3(family.fields(shape, layers))
    try:
        return _by_kernel(family, shape, layers, expected_mm3)
    except (GeometryError, MeshingError) as error:
        first = error
    softer = family.soften(shape)
    if softer is not None:
        try:
            solid = _by_kernel(family, softer, layers, expected_mm3)
            # Why the kernel gave up names its library, and helps no designer.
            return _noted(solid, _changed(shape, softer))
        except (GeometryError, MeshingError) as error:
            first = error
    return _by_distance(family, shape, layers, expected_mm3, first)


def coarse_volume_mm3(fields: Any, step_mm: float = COARSE_MM) -> float:
    """Volume of the elastomer by its fields [mm3]: outer less core, each integrated on a grid.

    A cell counts by how far its middle is inside, in steps: exact for planes that face the grid,
    and good to second order elsewhere.
    """
    low, high = np.array(fields.low_mm) - step_mm, np.array(fields.high_mm) + step_mm
    axes = [np.arange(low[k] + step_mm / 2, high[k], step_mm) for k in range(3)]
    axes[2] = np.arange(step_mm / 2, high[2], step_mm)
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)

    def filled(distance: np.ndarray) -> float:
        return float(np.clip(0.5 - distance / step_mm, 0.0, 1.0).sum()) * step_mm**3

    return filled(fields.outer(grid)) - filled(fields.core(grid))


def check_solid(solid: Solid, expected_mm3: float) -> Solid:
    """The body, if it is one closed body of the expected volume.

    Raises:
        MeshingError: If not, with the value and the limit.
    """
    from geometry.surface.surface import mesh_volume, open_edges

    points, faces = solid.membrane.points_mm, solid.membrane.faces
    gaps, pieces, volume_mm3 = open_edges(faces), body_count(faces), mesh_volume(points, faces)
    if gaps:
        raise _unusable(f"the surface has {gaps} open edges")
    if pieces != 1:
        raise _unusable(f"the elastomer is in {pieces} pieces")
    if volume_mm3 <= 0.0:
        raise _unusable(f"the volume is {volume_mm3:.4g} mm3")
    for name, other_mm3, limit in (
        ("the kernel's", solid.volume_mm3, SURFACE_LIMIT),
        ("the fields'", expected_mm3, FIELD_LIMIT),
    ):
        if abs(volume_mm3 / other_mm3 - 1.0) > limit:
            raise _unusable(
                f"the surface holds {volume_mm3:.6g} mm3, {name} volume is {other_mm3:.6g} mm3; "
                f"they differ by more than {100 * limit:g} %"
            )
    return solid


def surface_error(solid: Solid) -> float:
    """Relative difference of the surface's volume from the kernel's."""
    from geometry.surface.surface import mesh_volume

    return abs(mesh_volume(solid.membrane.points_mm, solid.membrane.faces) / solid.volume_mm3 - 1.0)


def body_count(faces: np.ndarray) -> int:
    """Connected pieces of a triangle mesh."""
    from geometry.surface.surface import pieces

    return int(pieces(faces).max()) + 1


def _by_kernel(family: Any, shape: Any, layers: Layers, expected_mm3: float) -> Solid:
    """The B-rep body.

    Raises:
        GeometryError: Also where the kernel raised an error of its own.
        MeshingError: If the body is not what it should be.
    """
    from geometry.body.csg_brep import translated
    from geometry.body.solid import assemble

    bodies = translated(lambda: family.build(shape, layers))
    first, finer = (functools.partial(assemble, bodies, fineness=value) for value in FINENESS)
    solid = translated(first)
    if surface_error(solid) > SURFACE_LIMIT:
        solid = translated(finer)
    return check_solid(solid, expected_mm3)


def _by_distance(
    family: Any, shape: Any, layers: Layers, expected_mm3: float, failure: Exception
) -> Solid:
    from geometry.body.implicit import solid_from_fields, step_for

    fields = family.fields(shape, layers)
    solid = solid_from_fields(fields, wall_mm=layers.elastomer_mm, support_mm=layers.support_mm)
    _check_wall(solid, fields.wall_mm)
    step_mm = step_for(layers.elastomer_mm)
    return _noted(
        check_solid(solid, expected_mm3),
        f"the CAD kernel failed, so the body was built by signed distance at {step_mm:g} mm: "
        f"edges are rounded by about that, and STEP files hold triangles ({failure})",
    )


def least_wall_mm(solid: Solid) -> float:
    """Shortest way from a vertex of the inner side to one of the outer side [mm].

    It is longer than the wall by at most the triangles' edge, so no sound wall reads thin.
    """
    from scipy.spatial import KDTree

    membrane = solid.membrane
    outer, inner = (
        membrane.points_mm[np.unique(membrane.faces[membrane.has(label)])]
        for label in (Label.OUTER, Label.INNER)
    )
    return float(KDTree(outer).query(inner)[0].min())


def _check_wall(solid: Solid, nominal_mm: float) -> None:
    limit_mm = WALL_SHARE * nominal_mm
    if nominal_mm > 0.0 and (wall_mm := least_wall_mm(solid)) < limit_mm:
        raise MeshingError(
            f"the elastomer wall is {wall_mm:.2g} mm at its thinnest, less than {limit_mm:.2g} mm, "
            f"half of what it should be",
            hint="raise layers.elastomer_mm, or round and bend the shape less",
            at="layers.elastomer_mm",
        )


def _changed(shape: Any, softer: Any) -> str:
    """Which parameters were softened, and from what to what."""
    parts = []
    for field in dataclasses.fields(shape):
        before, after = getattr(shape, field.name), getattr(softer, field.name)
        if before != after:
            label, unit = field.metadata.get("label", field.name), field.metadata.get("unit", "")
            parts.append(f"{label} {before:g} {unit} could not be built; {after:g} {unit} was")
    return ", ".join(parts)


def _noted(solid: Solid, notice: str) -> Solid:
    notices = [part for part in (solid.notice, notice) if part]
    return dataclasses.replace(solid, notice="; ".join(notices))


def _unusable(why: str) -> MeshingError:
    return MeshingError(why, hint="change the last shape parameter a little", at="shape")
