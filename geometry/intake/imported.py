"""A body from a file to a sensor: placed, cut flat, hollowed, given a support and a foot.

Labels and picked faces survive all booleans (`labelling`). Without an inner file the core is the
set of points farther than the wall from the skin: marching cubes on the exact distance to its
triangles. Near the base the skin is continued straight down, so that the wall meets the base at
right angles.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from geometry.body.wall_between import Wall, wall_between
from geometry.intake.foot import foot
from geometry.intake.labelling import (
    expect_one_body,
    flat_arrays,
    labelled,
    manifold_of,
    patches,
    renumbered,
)
from geometry.intake.shell import outer_and_inner
from geometry.surface.offset import inset_surface
from geometry.surface.surface import FLAT_MM, face_areas, mesh_volume, on_plane
from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.design import Layers
from workbench.core.design.imported import Pick, ReadBody, ReadSurface
from workbench.core.result.results import BodyMethod, Solid

NO_BREP = np.zeros(0, dtype=np.uint8)
LEAST_BASE_MM2 = 10.0
"""Smallest base that can carry a sensor [mm2]."""
SETTLE_MM = (0.0, 0.1, 0.2, 0.4, 0.8)
"""How much higher a foot is cut that is not flat by itself, as that of a scan [mm]."""
ROUGH_SHARE = 0.005
"""Share of the base that a flat foot may lack, by a chamfer."""
LARGEST_MM = 400.0
"""Longest body that is offset: twice the largest likely sensor; grids grow with its cube [mm]."""
LEAST_WALL_MM = 0.2
"""Thinnest elastomer that can be cast [mm]."""


def build_imported(
    body: ReadBody,
    shape: Any,
    layers: Layers,
    picks: Sequence[Pick] = (),
    monitor: Monitor = silent,
) -> Solid:
    """Make a sensor of a read body.

    Args:
        body: What the file holds.
        shape: Turns, cut and foot, as `designs.imported.ImportedShape`.
        layers: Thickness of wall and support.
        picks: Faces that the designer named.

    Raises:
        DesignError: If the cut leaves no base, the wall or support no room, or the inner body
            comes through the outer.
    """
    turn = _rotation(shape)
    outer, shift = _placed(body.outer, turn, shape.cut_mm)
    monitor(0.2, "offsetting the wall")
    notice, own_wall = body.notice, outer_and_inner(outer) if body.inner is None else None
    if own_wall is not None:
        outer, core = own_wall
        wall = _expect_inside(outer, core)
        thick = f"{wall.least_mm:.2g} to {wall.most_mm:.2g} mm thick"
        shell = (
            f"the body is a shell already, {thick}: its two sides "
            "are outer and inner, and layers.elastomer_mm is not used"
        )
        notice = "; ".join(part for part in (notice, shell) if part)
        cavity = _offset(core, layers.support_mm, at="layers.support_mm")
    elif body.inner is None:
        core = _offset(outer, layers.elastomer_mm, at="layers.elastomer_mm")
        inset_mm = layers.elastomer_mm + layers.support_mm
        monitor(0.5, "offsetting the support")
        cavity = _offset(outer, inset_mm, at="layers.support_mm")
    else:
        core = manifold_of(body.inner.points_mm @ turn.T - shift, body.inner.faces, None)
        core = core.trim_by_plane((0.0, 0.0, 1.0), 0.0)
        _expect_inside(outer, core)
        cavity = _offset(core, layers.support_mm, at="layers.support_mm")
    monitor(0.8, "labelling")
    skin = outer - renumbered(core)
    membrane = labelled(skin, picks)
    expect_one_body(membrane, from_file=body.inner is not None)
    return Solid(
        membrane=membrane,
        support=labelled(renumbered(core, 0) - renumbered(cavity), ()),
        base=foot(outer, cavity, shape),
        outer_brep=NO_BREP,
        core_brep=NO_BREP,
        membrane_brep=NO_BREP,
        support_brep=NO_BREP,
        base_brep=NO_BREP,
        volume_mm3=mesh_volume(membrane.points_mm, membrane.faces),
        method=BodyMethod.IMPORTED,
        patches=patches(skin),
        notice=notice,
    )


def _rotation(shape: Any) -> np.ndarray:
    """Turns about X, then Y, then Z, shape (3, 3)."""
    total = np.eye(3)
    for axis, degrees in enumerate((shape.turn_x_deg, shape.turn_y_deg, shape.turn_z_deg)):
        cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn = np.eye(3)
        turn[[i, i, j, j], [i, j, i, j]] = cosine, -sine, sine, cosine
        total = turn @ total
    return total


def _placed(surface: ReadSurface, turn: np.ndarray, cut_mm: float) -> tuple[Any, np.ndarray]:
    """The outer body with its cut on z = 0 and its base centred, and the shift that did it."""
    points = surface.points_mm @ turn.T
    longest_mm = float(np.ptp(points, axis=0).max())
    if longest_mm > LARGEST_MM:
        raise DesignError(
            f"the body is {longest_mm:.4g} mm long, more than {LARGEST_MM:g} mm",
            hint="choose the unit of the file: mm, cm, m or inch; or scale the body",
            at="body.unit",
        )
    low, high = points[:, 2].min(), points[:, 2].max()
    if cut_mm >= high - low:
        raise DesignError(
            f"a cut of {cut_mm:g} mm leaves nothing of a body {high - low:.3g} mm high",
            hint="lower shape.cut_mm, or turn the body",
            at="shape.cut_mm",
        )
    whole = manifold_of(points, surface.faces, surface.patch)
    for rise_mm in SETTLE_MM:
        shift_mm = low + cut_mm + rise_mm
        body = whole.translate((0.0, 0.0, -shift_mm)).trim_by_plane((0.0, 0.0, 1.0), 0.0)
        # Just above the cut: on it, a flat foot of the body has no section.
        section = body.slice(min(0.01, 0.01 * (high - low)))
        area = float(section.area())
        if area < LEAST_BASE_MM2:
            raise DesignError(
                f"the base is {area:.3g} mm2, less than {LEAST_BASE_MM2:g} mm2: the body stands "
                "on a point or an edge",
                hint="raise shape.cut_mm, or turn the body until its foot is down",
                at="shape.cut_mm",
            )
        if abs(_flat_mm2(body) - area) <= ROUGH_SHARE * area:
            break
    outline = np.concatenate(section.to_polygons())
    middle = (outline.min(axis=0) + outline.max(axis=0)) / 2
    shift = np.array([middle[0], middle[1], shift_mm])
    return body.translate((-float(middle[0]), -float(middle[1]), 0.0)), shift


def _flat_mm2(body: Any) -> float:
    """Area of the faces on z = 0."""
    points, faces, _ = flat_arrays(body)
    return float(face_areas(points, faces[on_plane(points, faces)]).sum())


def _offset(outer: Any, inset_mm: float, *, at: str) -> Any:
    """Points of a body farther than the inset from its skin, cut at z = 0.

    Raises:
        DesignError: If there are none, or they do not reach the base.
    """
    points, faces, _ = flat_arrays(outer)
    found, deepest_mm = inset_surface(points, faces, inset_mm)
    if found is None:
        raise DesignError(
            f"a wall of {inset_mm:g} mm leaves no room inside: the body is at most "
            f"{deepest_mm:.2g} mm deep",
            hint="lower layers.elastomer_mm or layers.support_mm, or scale the body",
            at=at,
        )
    inner = manifold_of(*found, None).trim_by_plane((0.0, 0.0, 1.0), 0.0)
    pieces = sorted(inner.decompose(), key=lambda piece: -piece.volume())
    kept = pieces[0] if pieces else inner
    if kept.is_empty() or kept.bounding_box()[2] > FLAT_MM:
        raise DesignError(
            f"a wall of {inset_mm:g} mm closes the foot of the body: camera and LEDs have no way "
            "in",
            hint="lower layers.elastomer_mm or layers.support_mm, or raise shape.cut_mm",
            at=at,
        )
    return kept


def _expect_inside(outer: Any, core: Any) -> Wall:
    """The wall; refuses an inner body that comes through the outer, or leaves too thin a one."""
    if core.is_empty() or core.bounding_box()[2] > FLAT_MM:
        raise DesignError(
            "the inner body does not reach the base of the outer",
            hint="both files must share one coordinate system; raise shape.cut_mm if they do",
            at="body.inner",
        )
    wall = wall_between(outer, core)
    if wall.least_mm < LEAST_WALL_MM:
        x, y, z = wall.least_at_mm
        raise DesignError(
            f"the wall between outer and inner body is {wall.least_mm:.2g} mm at "
            f"({x:.1f}, {y:.1f}, {z:.1f}) mm, less than {LEAST_WALL_MM:g} mm",
            hint="make the inner body smaller; both files must share one coordinate system",
            at="body.inner",
        )
    return wall
