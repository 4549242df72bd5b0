"""A designer's file to closed surfaces in mm: read, repaired where that is safe, and said so.

What cannot be mended safely (`geometry.intake.mending`) is refused with place and remedy, and with
the offer to remesh it (`geometry.intake.repair`) by a stated deviation, which is made only once
accepted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from geometry.body.solid import weld
from geometry.formats.stl import stl_corners, welded
from geometry.intake.cad_child import SEW_MM
from geometry.intake.cad_file import read_cad
from geometry.intake.mending import Triangles, expect_simple, facing_outward, mended, refuse_count
from geometry.intake.repair import Repaired, remeshed
from geometry.surface.holes import Damaged
from geometry.surface.surface import mesh_volume, open_edges, pieces
from workbench.core.base.errors import DesignError, GeometryError, MeshingError
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.imported import (
    BodyFile,
    FileKind,
    ImportedBody,
    LengthUnit,
    ReadBody,
    ReadSurface,
    RepairOffer,
)

OUTER, INNER = "outer", "inner"
MM_PER = {LengthUnit.MM: 1.0, LengthUnit.CM: 10.0, LengthUnit.M: 1000.0, LengthUnit.INCH: 25.4}
LIKELY_MM = (8.0, 200.0)
"""Sizes that a tactile sensor may have: what an unknown unit is judged by [mm]."""
LARGEST_MM = 1e6
"""A coordinate of a kilometre is a flipped bit of a STEP file [mm]."""
SMOOTH_COSINE = 0.866
"""Neighbouring triangles of an STL that differ by less than 30 degrees are one patch."""


@dataclass(frozen=True, kw_only=True, slots=True)
class _Asked:
    """One file of a body, and how it is to be read."""

    file: BodyFile
    unit: LengthUnit
    role: str
    repair: bool
    """Whether a remesh is accepted."""


@dataclass(frozen=True, kw_only=True, slots=True)
class _Closed:
    """What one file holds, in the file's unit."""

    outer: Triangles
    hollow: Triangles | None = None
    """The inner side of a double-walled body, facing outward too."""
    patch: np.ndarray | None = None
    """Face of the CAD file of each triangle (M,), where they are known."""


@dataclass(frozen=True, kw_only=True, slots=True)
class _Found:
    """What one file holds, in mm."""

    outer: ReadSurface
    hollow: ReadSurface | None
    unit: LengthUnit
    said: list[str]


def read_body(body: ImportedBody, monitor: Monitor = silent) -> ReadBody:
    """Read the outer body and, where there is one, the inner.

    Raises:
        DesignError: Saying what is wrong with the file, where, and what to do; with `repair` where
            a remesh is on offer.
    """
    outer = _in_mm(_Asked(file=body.outer, unit=body.unit, role=OUTER, repair=body.repair), monitor)
    inner, said = outer.hollow, outer.said
    if body.inner is not None:
        # Files of one export share their unit; that of a STEP file says nothing about an STL.
        shared = outer.unit if body.outer.kind is FileKind.STL else body.unit
        asked = _Asked(file=body.inner, unit=shared, role=INNER, repair=body.repair)
        found = _in_mm(asked, monitor)
        inner, said = found.outer, said + found.said
    return ReadBody(outer=outer.outer, inner=inner, unit=outer.unit.value, notice="; ".join(said))


def _in_mm(asked: _Asked, monitor: Monitor) -> _Found:
    """One file's surface in mm, its unit, and what was done to it.

    Messages name the file, because they are shown once; notices are stored, and the same content
    under another name must read the same, so they name the role.
    """
    notes: list[str] = []
    try:
        read = _read_step if asked.file.kind is FileKind.STEP else _read_stl
        closed, unit, factor = read(asked, notes, monitor)
    except (DesignError, MeshingError) as error:
        error.at = error.at or f"body.{asked.role}"
        raise
    return _Found(
        outer=_surface(closed.outer, factor, closed.patch),
        hollow=None if closed.hollow is None else _surface(closed.hollow, factor),
        unit=unit,
        said=[f"{asked.role} body: {note}" for note in notes],
    )


def _surface(triangles: Triangles, factor: float, patch: np.ndarray | None = None) -> ReadSurface:
    points, faces = triangles
    if patch is None:
        patch = smooth_patches(points, faces)
    return ReadSurface(points_mm=points * factor, faces=faces, patch=patch)


def _unit(points: np.ndarray, asked: _Asked, notes: list[str]) -> LengthUnit:
    """The unit given, or the one that makes an STL as large as a sensor."""
    if asked.unit is not LengthUnit.AUTO:
        return asked.unit
    size = float(np.ptp(points, axis=0).max())
    low, high = LIKELY_MM
    fits = [unit for unit, factor in MM_PER.items() if low <= size * factor <= high]
    if fits[:1] == [LengthUnit.MM]:
        if len(fits) > 1:
            notes.append(
                f"taken as {size:.3g} mm long; if it is {size * MM_PER[fits[1]]:.3g} mm, choose "
                f"{fits[1].value} as its unit"
            )
        return LengthUnit.MM
    if len(fits) == 1:
        notes.append(f"its numbers were taken as {fits[0].value}")
        return fits[0]
    options = ", ".join(f"{u.value}: {size * MM_PER[u]:.3g} mm" for u in fits or MM_PER)
    raise DesignError(
        f"{asked.file.name} is {size:.3g} units long, and an STL does not say which ({options})",
        hint="choose the unit of the file: mm, cm, m or inch",
        at="body.unit",
    )


def _read_step(
    asked: _Asked, notes: list[str], monitor: Monitor
) -> tuple[_Closed, LengthUnit, float]:
    """What a STEP file holds; the CAD kernel has already turned the file's own unit into mm."""
    name, found = asked.file.name, read_cad(asked.file, monitor)
    largest_mm = float(np.abs(found.points_mm).max(initial=0.0))
    if not largest_mm <= LARGEST_MM:
        raise DesignError(
            f"{name} has a vertex at {largest_mm:.3g} mm, beyond {LARGEST_MM:g} mm; the file is "
            "damaged",
            hint="export the body again from the program that made it",
        )
    points, faces, patch = weld(found.points_mm, found.faces, found.patch)

    def attempt(made: list[str]) -> _Closed:
        if len(found.solids_mm3) > 1:
            refuse_count(name, list(found.solids_mm3))
        made += found.notes
        whole = found.sound and not open_edges(faces) and mesh_volume(points, faces) > 0.0
        if whole and pieces(faces).max() == 0:
            expect_simple(points, faces, name)
            return _Closed(outer=(points, faces), patch=patch)
        if not found.solids_mm3 and pieces(faces).max() > 0:
            raise Damaged(
                f"{name} holds {patch.max() + 1} loose faces that do not meet within {SEW_MM:g} mm",
                hint="export a closed solid, not surfaces or wires",
            )
        outer, hollow = mended(points, faces, name, made)
        return _Closed(outer=outer, hollow=hollow)

    return _or_repaired(attempt, (points, faces), 1.0, asked, notes), LengthUnit.MM, 1.0


def _read_stl(
    asked: _Asked, notes: list[str], monitor: Monitor
) -> tuple[_Closed, LengthUnit, float]:
    """What an STL holds, in its own numbers, and what one of them is in mm."""
    name = asked.file.name
    points, faces = welded(stl_corners(asked.file.data.tobytes(), name, at=""))
    if not len(faces):
        raise DesignError(f"{name} has no faces", hint="export the body, not an empty file")
    unit = _unit(points, asked, notes)

    def attempt(made: list[str]) -> _Closed:
        outer, hollow = mended(points, faces, name, made)
        return _Closed(outer=outer, hollow=hollow)

    closed = _or_repaired(attempt, (points, faces), MM_PER[unit], asked, notes)
    return closed, unit, MM_PER[unit]


def _or_repaired(
    attempt: Callable[[list[str]], _Closed],
    triangles: Triangles,
    factor: float,
    asked: _Asked,
    notes: list[str],
) -> _Closed:
    """What mending gives, else the remeshed surface where that is accepted.

    Raises:
        DesignError: With the offer of a remesh, where it is not.
    """
    made: list[str] = []
    try:
        closed = attempt(made)
    except Damaged as damage:
        reason = damage
    else:
        notes += made
        return closed
    refusal = DesignError(reason.message, hint=reason.hint, at=reason.at)
    repaired = _remeshed(triangles)
    if repaired is None:
        raise refusal from None
    offer = RepairOffer(
        step_mm=repaired.step * factor,
        deviation_mm=repaired.deviation * factor,
        farthest=repaired.farthest,
        closed_mm=repaired.closed_width * factor,
    )
    if not asked.repair:
        refusal.repair = offer
        refusal.hint = (
            f"run again with --repair: {offer.words} (repair = true under [body] in a design "
            f"file); or {reason.hint}"
        )
        raise refusal from None
    # The reason names the file, and what is stored must not.
    why = reason.message.replace(asked.file.name, "it")
    notes.append(f"{offer.words}, because {why}")
    return _Closed(outer=(repaired.points, repaired.faces))


def _remeshed(triangles: Triangles) -> Repaired | None:
    points, faces = triangles
    try:
        repaired = remeshed(points, facing_outward(points, faces))
    except GeometryError:
        return None
    return repaired if repaired is not None and repaired.bodies == 1 else None


def smooth_patches(points_mm: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Patches of a closed mesh between edges sharper than 30 degrees, shape (M,), int32."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    corners = points_mm[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    wide = faces.astype(np.int64)
    start, stop = wide.ravel(), np.roll(wide, -1, axis=1).ravel()
    span = int(wide.max()) + 1
    order = np.argsort(start * span + stop)
    across = order[np.searchsorted((start * span + stop)[order], stop * span + start)] // 3
    here = np.repeat(np.arange(len(faces)), 3)
    smooth = np.einsum("ij,ij->i", normal[here], normal[across]) > SMOOTH_COSINE
    links = coo_matrix((np.ones(smooth.sum()), (here[smooth], across[smooth])), [len(faces)] * 2)
    return connected_components(links, directed=False)[1].astype(np.int32)
