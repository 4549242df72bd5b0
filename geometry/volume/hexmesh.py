"""Structured hexahedra through the wall, and the skins that share their nodes.

Two sheets of quadrilaterals on the inner and the outer face are joined by straight lines in equal
layers. Whether a shape can be divided so is found by trying: sheets that miss a face, fold, or
lose part of a face's area or of the volume (pins, suckers) are refused, and the skins are remeshed
instead, with a notice that says why.
"""

from __future__ import annotations

import math

import numpy as np

from geometry.surface.remesh import remesh
from geometry.surface.surface import face_areas
from geometry.surface.transfer import node_regions
from geometry.volume.hexquality import hex_volumes, scaled_jacobian
from geometry.volume.ogrid import Pace
from geometry.volume.relax import relaxed
from geometry.volume.sheets import Sheets, cap_sheets, offset_sheets
from geometry.volume.skins import (
    cavity_skin,
    labelled_faces,
    part_of,
    quad_skin,
    region_skin,
    with_regions,
)
from geometry.volume.slab import is_slab, slab_sheets
from workbench.core.base.errors import MeshingError
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.design import Meshing
from workbench.core.result.results import (
    Label,
    LabelledSurface,
    MembraneMesh,
    Skin,
    Solid,
    VolumeMesh,
    region_masks,
)

FEWEST_LAYERS = 2
LONGEST_LAYER = 1.5
"""Most that a layer may be thicker than the cells are wide on nine tenths of the wall."""
AREA_SHARE = 0.015
"""A side whose area is off by more has features that the sheets passed over."""
VOLUME_SHARE = 0.005
"""Largest relative error of volume; 0.1 % is usual at 0.4 mm."""
REGION_SHARE = 0.1
"""Largest relative error of the area of a numbered region: it would not be the one drawn."""
LONGEST_EDGE = 6.0
"""Edge over the mean edge of a sheet above which rays jumped over a feature."""
LEAST_QUALITY = 0.05
"""Scaled Jacobian below which a cell spoils any solver that uses it."""


def mesh_membrane(
    solid: Solid, meshing: Meshing, monitor: Monitor = silent, *, paired: bool = False
) -> MembraneMesh:
    """Mesh the wall of a membrane: hexahedra and skins, or skins alone with a notice.

    Args:
        solid: The body.
        meshing: How fine.
        monitor: Told the progress.
        paired: Whether eight cells each should make a larger one (`VolumeMesh.groups`).

    Raises:
        MeshingError: If a side of the wall has no face, or remeshing fails.
    """
    for side in (Label.OUTER, Label.INNER):
        labelled_faces(solid.membrane, side)
    monitor(0.0, "casting rays")
    hexes, notice = None, ""
    try:
        hexes, outer, inner = _hexahedra(solid, Pace(meshing.hex_mm, paired=paired), monitor)
    except MeshingError as problem:
        monitor(0.5, "remeshing the surface")
        even = remesh(solid.membrane, meshing.hex_mm)
        outer, inner = region_skin(even, Label.OUTER), region_skin(even, Label.INNER)
        notice = f"no hexahedra: {problem.message}; skins are triangles and contact is unaffected"
    monitor(0.8, "meshing the cavity")
    return MembraneMesh(
        hexes=hexes,
        outer=outer,
        inner=inner,
        cavity=cavity_skin(solid.support),
        tips_mm=solid.tips_mm,
        tip_radius_mm=solid.tip_radius_mm,
        backing_mm=solid.backing_mm,
        notice=notice,
    )


def _hexahedra(solid: Solid, pace: Pace, monitor: Monitor) -> tuple[VolumeMesh, Skin, Skin]:
    """Hexahedra with their outer and inner skin, by the first kind of sheets that does.

    Raises:
        MeshingError: If the shape cannot be divided so.
    """
    if is_slab(solid.membrane):
        return _between(slab_sheets(solid.membrane, pace), solid, pace, monitor)
    try:
        return _between(cap_sheets(solid.membrane, pace), solid, pace, monitor)
    except MeshingError as problem:
        try:
            return _between(offset_sheets(solid.membrane, pace), solid, pace, monitor)
        except MeshingError:
            raise problem from None


def _between(
    sheets: Sheets, solid: Solid, pace: Pace, monitor: Monitor
) -> tuple[VolumeMesh, Skin, Skin]:
    """Hexahedra between two sheets, with their outer and inner skin.

    Raises:
        MeshingError: If the sheets miss part of the body, or a cell is inverted.
    """
    membrane = solid.membrane
    chord = _chord_share(membrane, pace.edge_mm)
    _expect_cover(sheets.inside, sheets.quads, part_of(membrane, Label.INNER), chord)
    if sheets.rim is Label.BASE:
        _expect_cover(sheets.outside, sheets.quads, part_of(membrane, Label.OUTER), chord)
    monitor(0.2, "squaring cells")
    sheets = relaxed(sheets, membrane)
    monitor(0.4, "stacking layers")
    hexes = _stack(sheets, pace)
    _expect_near(hexes.volume_mm3, solid.volume_mm3, VOLUME_SHARE + chord, "volume", "mm3")
    skins, node_labels, node_numbers = [], hexes.labels.copy(), hexes.numbers.copy()
    for side, quads in _boundary(sheets, hexes.layers).items():
        skin, nodes = quad_skin(hexes.points_mm, quads)
        skin = with_regions(skin, membrane, side)
        _expect_areas(skin, part_of(membrane, side), chord)
        bits, numbers = node_regions(len(nodes), skin.faces, skin.labels, skin.numbers)
        node_labels[nodes] |= bits
        node_numbers[nodes] = np.maximum(node_numbers[nodes], numbers)
        skins.append(skin)
    marked = VolumeMesh(
        points_mm=hexes.points_mm,
        cells=hexes.cells,
        labels=node_labels,
        quality=hexes.quality,
        layers=hexes.layers,
        volume_mm3=hexes.volume_mm3,
        numbers=node_numbers,
        groups=hexes.groups,
    )
    return marked, skins[0], skins[1]


def _stack(sheets: Sheets, pace: Pace) -> VolumeMesh:
    """Hexahedra between two node sheets; only the rim is labelled yet.

    Raises:
        MeshingError: If a cell is inverted.
    """
    inside, outside = sheets.inside, sheets.outside
    usual_mm, thick_mm = np.percentile(np.linalg.norm(outside - inside, axis=1), [50.0, 90.0])
    layers = max(
        pace.count(usual_mm, FEWEST_LAYERS), math.ceil(thick_mm / (LONGEST_LAYER * pace.edge_mm))
    )
    if pace.paired:
        layers += layers % 2
    share = np.linspace(0.0, 1.0, layers + 1)[:, None, None]
    points = ((1.0 - share) * inside + share * outside).reshape(-1, 3)
    sheet = len(inside)
    level = sheet * np.arange(layers, dtype=np.int32)[:, None, None]
    cells = np.concatenate([sheets.quads + level, sheets.quads + level + sheet], axis=2)
    cells = cells.reshape(-1, 8)
    quality = scaled_jacobian(points, cells)
    good = quality > LEAST_QUALITY
    if not good.all():
        raise MeshingError(
            f"{np.count_nonzero(~good)} of {len(quality)} cells are inverted or "
            f"nearly flat (scaled Jacobian {quality.min():.3f}, at least {LEAST_QUALITY:g})",
            hint="make the shape smoother or the wall more even",
            at="shape",
        )
    lower = 2 * len(sheets.quads) * np.arange(layers // 2)[:, None, None]
    fours = (sheets.groups + lower).reshape(-1, 4)
    labels = np.zeros((layers + 1, sheet), dtype=np.uint8)
    labels[:, sheets.ring] |= np.uint8(sheets.rim)
    return VolumeMesh(
        points_mm=points,
        cells=cells.astype(np.int32),
        labels=labels.ravel(),
        quality=quality.astype(np.float32),
        layers=layers,
        volume_mm3=float(hex_volumes(points, cells).sum()),
        groups=np.concatenate([fours, fours + len(sheets.quads)], axis=1).astype(np.int32),
    )


def _boundary(sheets: Sheets, layers: int) -> dict[Label, np.ndarray]:
    """Quadrilaterals of the outer and the inner skin, out of the sensor, each (Q, 4)."""
    sheet = len(sheets.inside)
    outer = sheets.quads + layers * sheet
    if sheets.rim is Label.OUTER:
        lower = sheets.ring + sheet * np.arange(layers)[:, None]
        beside = np.roll(lower, -1, axis=1)
        rim_faces = np.stack([lower, beside, beside + sheet, lower + sheet], axis=-1)
        outer = np.concatenate([outer, rim_faces.reshape(-1, 4)])
    return {Label.OUTER: outer, Label.INNER: sheets.quads}


def _chord_share(membrane: LabelledSurface, spacing_mm: float) -> float:
    """Share that chords of this spacing cut off a circle as wide as the body: (h / r)^2 / 6."""
    width_mm = float(np.ptp(membrane.points_mm[:, :2], axis=0).min())
    return (2.0 * spacing_mm / width_mm) ** 2 / 6.0


def _expect_cover(
    points_mm: np.ndarray, quads: np.ndarray, wanted: LabelledSurface, chord: float
) -> None:
    """Refuse a sheet that passes over pins or suckers, before any time is spent on it."""
    found = float(face_areas(points_mm, np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])).sum())
    whole = float(face_areas(wanted.points_mm, wanted.faces).sum())
    _expect_near(found, whole, AREA_SHARE + chord, "area of a side", "mm2")
    corners = points_mm[quads]
    edges = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
    if edges.max() > LONGEST_EDGE * edges.mean():
        raise MeshingError(
            f"layers jump over part of the body: an edge of {edges.max():.3g} mm where the mean is "
            f"{edges.mean():.3g} mm, at most {LONGEST_EDGE:g} times that",
            hint="use tetrahedra or material points for shapes with steps",
            at="shape",
        )


def _expect_areas(skin: Skin, wanted: LabelledSurface, chord: float) -> None:
    found_mm2 = face_areas(skin.points_mm, skin.faces)
    wanted_mm2 = face_areas(wanted.points_mm, wanted.faces)
    masks = region_masks(skin.labels, skin.numbers)
    for name, members in region_masks(wanted.labels, wanted.numbers).items():
        found = float(found_mm2[masks[name]].sum()) if name in masks else 0.0
        share = REGION_SHARE if "_" in name else AREA_SHARE
        _expect_near(found, float(wanted_mm2[members].sum()), share + chord, f"{name} area", "mm2")


def _expect_near(found: float, wanted: float, share: float, what: str, unit: str) -> None:
    if abs(found - wanted) > share * wanted:
        raise MeshingError(
            f"layers miss part of the body: {what} {found:.4g} instead of {wanted:.4g} {unit}",
            hint="lower meshing.hex_mm, or use tetrahedra or material points",
            at="meshing.hex_mm",
        )
