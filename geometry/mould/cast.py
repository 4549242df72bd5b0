"""The body to be cast, as the mould sees it: what shapes its outside and what hollows it.

Both come from the membrane's own triangles: the core is the inner face turned over and capped at
its open rims; the outer body is everything else with the same cap. Their difference is the membrane
to the last bit, and mould parts cut by them share triangles with the cast. A flat inner face (a
pad) leaves no core: the outer body is then the membrane itself.

Shrinkage enlarges both about the base plane by 1 / (1 - s). Draft narrows the core toward its tip:
a point at height h above the base moves to the axis by tan(draft) h, times its distance from the
axis over the opening's mean radius; straight walls so get the draft exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from geometry.body import csg
from geometry.surface.holes import cap, open_loops
from workbench.core.base.errors import GeometryError
from workbench.core.design.making import MouldOptions
from workbench.core.result.results import Label, Solid

FLAT_MM = 1e-3
"""An inner face that stands out of the base plane by less is flat [mm]."""
NO_BREP = np.zeros(0, dtype=np.uint8)
LEAST_SCALE = 0.2
"""A taper never narrows the core's tip below this share of its width."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Cast:
    """Outer body and core in the assembled position, enlarged by the shrinkage."""

    outer: csg.Body
    core: csg.Body | None
    base_mm: float
    """Height of the base plane [mm], where the mould's lid is."""
    sensing: csg.Body
    """The sensing surface alone, open at its rims: what the outer parts shape."""
    loops_mm: tuple[np.ndarray, ...]
    """Outlines of the cast's face on the base plane [mm], shape (N, 2) each."""

    @property
    def corners_mm(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner of the outer body's bounding box [mm], shape (3,) each."""
        return self.outer.points_mm.min(axis=0), self.outer.points_mm.max(axis=0)


def make_cast(solid: Solid, options: MouldOptions) -> Cast:
    """Outer body and core of a sensor's membrane.

    Raises:
        GeometryError: If the inner face cannot be capped at its rims.
    """
    membrane = solid.membrane
    points, faces = membrane.points_mm, membrane.faces
    base_mm = float(points[:, 2].min())
    inner = membrane.has(Label.INNER)
    factor = 1.0 / (1.0 - options.shrink_percent / 100.0)
    flat = not inner.any() or np.ptp(points[faces[inner], 2]) < FLAT_MM
    if flat:
        outer = _body(points, faces, solid.membrane_brep)
        core = None
    else:
        lid = cap(points, faces[inner])
        outer = _body(points, np.vstack([faces[~inner], lid[:, ::-1]]), solid.outer_brep)
        core = _body(points, np.vstack([faces[inner], lid])[:, ::-1], solid.core_brep)
        core = _tapered(core, base_mm, options.draft_deg)
    touching = membrane.has(Label.BASE) if membrane.has(Label.BASE).any() else inner
    return Cast(
        outer=_enlarged(outer, factor, base_mm),
        core=None if core is None else _enlarged(core, factor, base_mm),
        base_mm=base_mm,
        sensing=_enlarged(_body(points, faces[membrane.has(Label.OUTER)]), factor, base_mm),
        loops_mm=tuple(factor * points[loop, :2] for loop in open_loops(faces[touching])),
    )


def footprint(cast: Cast) -> Any:
    """The cast's face on the base plane as a shapely polygon."""
    import shapely

    area = shapely.Polygon()
    for loop in cast.loops_mm:
        area = area.symmetric_difference(shapely.Polygon(loop).buffer(0))
    return area


def _tapered(core: csg.Body, base_mm: float, draft_deg: float) -> csg.Body:
    if not draft_deg:
        return core
    rim = core.points_mm[core.points_mm[:, 2] < base_mm + FLAT_MM, :2]
    centre = (rim.min(axis=0) + rim.max(axis=0)) / 2
    radius_mm = float(np.linalg.norm(rim - centre, axis=1).mean())
    height = core.points_mm[:, 2] - base_mm
    share = np.maximum(1.0 - np.tan(np.radians(draft_deg)) * height / radius_mm, LEAST_SCALE)
    axis = _axis(core, base_mm, centre)
    points = core.points_mm.copy()
    points[:, :2] = axis + share[:, None] * (points[:, :2] - axis)
    return csg.Body(points_mm=points, faces=core.faces)


def _axis(core: csg.Body, base_mm: float, centre: np.ndarray) -> np.ndarray:
    """Middle of the core's section at the height of each vertex [mm], shape (N, 2)."""
    height = core.points_mm[:, 2] - base_mm
    edges = np.linspace(0.0, height.max(), 13)
    middles = [centre]
    for low, high in pairwise(edges):
        near = core.points_mm[(height >= low) & (height <= high), :2]
        middles.append((near.min(axis=0) + near.max(axis=0)) / 2 if len(near) else middles[-1])
    heights = np.concatenate([[0.0], (edges[:-1] + edges[1:]) / 2])
    found = np.array(middles)
    return np.column_stack([np.interp(height, heights, found[:, k]) for k in (0, 1)])


def _body(points: np.ndarray, faces: np.ndarray, brep: np.ndarray = NO_BREP) -> csg.Body:
    used, compact = np.unique(faces, return_inverse=True)
    return csg.Body(points_mm=points[used], faces=compact.reshape(-1, 3), brep=brep)


def _enlarged(body: csg.Body, factor: float, base_mm: float) -> csg.Body:
    base = np.array([0.0, 0.0, base_mm])
    brep = body.brep
    if brep.size and factor != 1.0:
        brep = _enlarged_brep(csg.scaled(body, factor, base))
    return csg.Body(points_mm=base + factor * (body.points_mm - base), faces=body.faces, brep=brep)


def _enlarged_brep(body: csg.Node) -> np.ndarray:
    """The B-rep of a scaled body; none where the kernel refuses, as for bodies without one."""
    from geometry.body.csg_brep import evaluate, translated
    from geometry.body.solid import brep_bytes

    try:
        return translated(lambda: brep_bytes(evaluate(body, what="the enlarged body")))
    except GeometryError:
        return NO_BREP
