"""Casting moulds: two outer halves and a core, as B-rep bodies and as printable meshes.

The cavity is the body enlarged by the shrinkage, 1 / (1 - s). The split azimuth is the one with
the least undercut. STL and STEP come from the same B-rep; the parts and the cast share the faces
on which they touch, so overlaps are measured, not assumed.

Leaves out: draft angles, more than two halves, ejectors.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from geometry.castability import best_split_deg, thinnest_wall_mm
from geometry.conform import overlaps_mm3, piece_count, share_faces
from geometry.mould_parts import Block, Ring, block_half, core_with_flange
from geometry.rays import RayCaster
from geometry.solid import Tessellation, brep_bytes, part_from_brep, tessellate
from geometry.surface import is_watertight
from workbench.core.booleans import cut
from workbench.core.design import MouldOptions
from workbench.core.errors import GeometryError
from workbench.core.fabrication import FabricationPart, MouldSet, PartGroup
from workbench.core.monitor import Monitor, silent
from workbench.core.results import Label, LabelledSurface, Solid

ANGLE_RAD = 0.15
"""Printed parts need no finer facets; the distance tolerance stays 0.02 mm."""
LARGEST_OVERLAP_MM3 = 1e-3
PROBE_HEIGHT_MM = 0.01
"""Height above the base at which the annulus is measured [mm]."""
GATE_AZIMUTH_DEG = 90.0
APART_MM = 15.0
"""Gap between the parts of the exploded view [mm]."""
CAST = "cast"


def make_mould(solid: Solid, options: MouldOptions, monitor: Monitor = silent) -> MouldSet:
    """Make the mould of a body that stands on z = 0 with its tip up.

    Raises:
        DesignError: If the gate does not fit.
        GeometryError: If a part is not one closed body, or parts overlap.
    """
    monitor(0.0, "looking for the best split")
    outer_faces = solid.membrane.faces[solid.membrane.has(Label.OUTER)]
    azimuth_deg, _ = best_split_deg(solid.membrane.points_mm, outer_faces)
    outer, core = _enlarged(solid, options, azimuth_deg)
    box = outer.bounding_box()
    block = Block(low=np.array([*box.min]), high=np.array([*box.max]), wall_mm=options.wall_mm)
    ring = _annulus(solid, options, azimuth_deg)
    monitor(0.1, "cutting half A")
    bodies = {"half_a": block_half(outer, block, options, side=1)}
    monitor(0.25, "cutting half B")
    bodies["half_b"] = block_half(outer, block, options, side=-1)
    monitor(0.4, "building the core")
    bodies["core"] = core_with_flange(core, block, ring, options)
    bodies[CAST] = cut(outer, core, what="core from the cast")
    monitor(0.5, "joining faces")
    shared = share_faces(bodies)
    monitor(0.7, "tessellating")
    turned = {name: _turned(body, azimuth_deg) for name, body in shared.items()}
    meshes = _tessellated(shared, turned, azimuth_deg)
    monitor(0.85, "checking")
    return _checked_set(turned, meshes, block, azimuth_deg)


def _checked_set(
    bodies: Mapping[str, Any],
    meshes: Mapping[str, Tessellation],
    block: Block,
    azimuth_deg: float,
) -> MouldSet:
    overlap_mm3 = max(
        overlaps_mm3({name: (mesh.points_mm, mesh.faces) for name, mesh in meshes.items()}).values()
    )
    if overlap_mm3 > LARGEST_OVERLAP_MM3:
        raise GeometryError(
            f"mould parts overlap by {overlap_mm3:.3g} mm3, more than {LARGEST_OVERLAP_MM3:g} mm3",
            hint="raise mould.clearance_mm, or change the last shape parameter a little",
            at="mould",
        )
    explode = _explode(block, azimuth_deg)
    names = [name for name in meshes if name != CAST]
    return MouldSet(
        parts=tuple(_part(name, bodies[name], meshes[name], explode[name]) for name in names),
        split_azimuth_deg=azimuth_deg,
        overlap_mm3=overlap_mm3,
        thinnest_wall_mm=min(
            thinnest_wall_mm(meshes[name].points_mm, meshes[name].faces) for name in names
        ),
        cast_volume_mm3=float(bodies[CAST].volume),
    )


def _part(
    name: str, body: Any, mesh: Tessellation, explode: tuple[float, float, float]
) -> FabricationPart:
    # As a slicer sees it: STL keeps float32 and no indices, so vertices are welded anew.
    reloaded = _reloaded(mesh)
    pieces = piece_count(*reloaded)
    if pieces != 1:
        raise GeometryError(
            f"mould part {name} falls into {pieces} pieces",
            hint="raise mould.wall_mm or lower mould.gate_diameter_mm",
            at="mould",
        )
    return FabricationPart(
        name=name,
        group=PartGroup.MOULD,
        points_mm=mesh.points_mm,
        faces=mesh.faces,
        brep=brep_bytes(body),
        volume_mm3=float(body.volume),
        watertight=is_watertight(reloaded[1]),
        explode=explode,
    )


def _reloaded(mesh: Tessellation) -> tuple[np.ndarray, np.ndarray]:
    corners = mesh.points_mm.astype(np.float32)[mesh.faces].reshape(-1, 3)
    points, faces = np.unique(corners, axis=0, return_inverse=True)
    return points, faces.reshape(-1, 3)


def _enlarged(solid: Solid, options: MouldOptions, azimuth_deg: float) -> tuple[Any, Any]:
    """Outer body and core, larger by the shrinkage, with the pull direction turned to +X."""
    factor = 1.0 / (1.0 - options.shrink_percent / 100.0)
    bodies = (part_from_brep(array) for array in (solid.outer_brep, solid.core_brep))
    outer, core = (_turned(body.scale(factor), -azimuth_deg) for body in bodies)
    return outer, core


def _turned(body: Any, azimuth_deg: float) -> Any:
    from build123d import Axis

    return body.rotate(Axis.Z, azimuth_deg) if azimuth_deg else body


def _tessellated(
    shared: Mapping[str, Any], turned: Mapping[str, Any], azimuth_deg: float
) -> dict[str, Tessellation]:
    """Meshes of bodies that share faces, turned back by the azimuth.

    The bodies are tessellated before turning: only unturned do they still share their faces.
    """
    angle = np.radians(azimuth_deg)
    rotation = np.array(
        [[np.cos(angle), np.sin(angle), 0.0], [-np.sin(angle), np.cos(angle), 0.0], [0, 0, 1.0]]
    )
    meshes = {name: tessellate(shared[name], angle_rad=ANGLE_RAD) for name in turned}
    if not azimuth_deg:
        return meshes
    return {
        name: mesh._replace(points_mm=mesh.points_mm @ rotation) for name, mesh in meshes.items()
    }


def _annulus(solid: Solid, options: MouldOptions, azimuth_deg: float) -> Ring:
    """Where gate and vents end, midway between core and outer body, in the mould's frame."""
    count = options.vent_count + 1
    turns = np.radians(GATE_AZIMUTH_DEG + 360.0 * np.arange(count) / count)
    factor = 1.0 / (1.0 - options.shrink_percent / 100.0)
    inner = _radii(solid.membrane, Label.INNER, turns + np.radians(azimuth_deg))
    outer = _radii(solid.membrane, Label.OUTER, turns + np.radians(azimuth_deg))
    middle = (inner + outer)[:, None] / 2 * np.column_stack([np.cos(turns), np.sin(turns)])
    return Ring(centres_mm=middle * factor, gap_mm=float((outer - inner).min()) * factor)


def _radii(surface: LabelledSurface, label: Label, azimuths: np.ndarray) -> np.ndarray:
    """Distance from the axis to a region just above the base [mm], shape (A,)."""
    caster = RayCaster(surface.points_mm, surface.faces[surface.has(label)])
    # A hair off, because rays exactly through a vertex may slip between its triangles.
    turned = azimuths + 1e-4
    directions = np.column_stack([np.cos(turned), np.sin(turned), np.zeros(len(turned))])
    origins = np.tile([0.0, 0.0, PROBE_HEIGHT_MM], (len(turned), 1))
    distance = caster.hits(origins, directions)[0]
    if not np.isfinite(distance).all():
        raise GeometryError(
            "the wall above the base cannot be found from the axis",
            hint="the body must stand on z = 0 around the origin",
            at="shape",
        )
    return distance


def _explode(block: Block, azimuth_deg: float) -> dict[str, tuple[float, float, float]]:
    angle = np.radians(azimuth_deg)
    apart = block.half_x_mm + APART_MM
    x, y = float(np.cos(angle)) * apart, float(np.sin(angle)) * apart
    return {
        "half_a": (x, y, 0.0),
        "half_b": (-x, -y, 0.0),
        "core": (0.0, 0.0, -(block.height_mm + APART_MM)),
    }
