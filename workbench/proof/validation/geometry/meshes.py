"""Meshes of every family's default shape: hexahedra where there are some, regions everywhere."""

from __future__ import annotations

import functools
import time

import numpy as np

from workbench.core.base.errors import MeshingError, WorkbenchError
from workbench.core.base.monitor import silent
from workbench.core.design.design import Layers, Meshing
from workbench.core.result.quality import MeshQuality
from workbench.core.result.results import LabelledSurface, MembraneMesh, Skin, Solid, region_masks
from workbench.pipeline.stages.build import BuildInputs, build
from workbench.pipeline.stages.mesh import MeshInputs, mesh
from workbench.pipeline.stages.quality import QualityInputs, quality
from workbench.proof.row import Row, bounded, failed

LEAST_JACOBIAN = 0.3
MOST_EDGE = 1.6
"""95 % of the edges are at most this many times the spacing."""
VOLUME_LIMIT = 0.005
SECONDS_LIMIT = 3.0
AREA_LIMIT = 0.01
WITHOUT_SLIDERS = "imported"


def family_names() -> list[str]:
    """Families that build a default shape by themselves."""
    from designs.family import families

    return [name for name in families() if name != WITHOUT_SLIDERS]


@functools.cache
def default_solid(family: str) -> Solid:
    """The default shape of a family."""
    from designs.family import resolve_shape

    return build(
        BuildInputs(family=family, shape=resolve_shape(family, {}), layers=Layers()), monitor=silent
    )


def rows() -> list[Row]:
    """`hex_FAMILY` where the default shape has hexahedra, and `labels_FAMILY` for every family."""
    found = []
    for name in family_names():
        try:
            solid = default_solid(name)
            start = time.perf_counter()
            meshes = mesh(MeshInputs(solid=solid, meshing=Meshing()), monitor=silent)
            seconds = time.perf_counter() - start
        except WorkbenchError as problem:
            found.append(failed(f"labels_{name}", "default shape", why=problem.message))
            continue
        judged = quality(QualityInputs(solid=solid, mesh=meshes), monitor=silent).volume
        if judged is not None:
            found.append(_hex_row(name, judged, seconds))
        found.append(_label_row(name, solid.membrane, meshes))
    return found


def _hex_row(name: str, judged: MeshQuality, seconds: float) -> Row:
    least, edge = float(judged.measure[0]), float(judged.edge_mm[4]) / Meshing().hex_mm
    off = abs(judged.volume_ratio - 1.0)
    case = (
        f"default, 0.4 mm: {judged.cells} cells, edge 95 % {edge:.2f} h (at most {MOST_EDGE:g}), "
        f"volume off {off:.2%} (at most {VOLUME_LIMIT:.1%}), {seconds:.1f} s (at most "
        f"{SECONDS_LIMIT:g})"
    )
    if edge > MOST_EDGE or off > VOLUME_LIMIT or seconds > SECONDS_LIMIT:
        return failed(f"hex_{name}", case, unit="1", why="a limit of the case is broken")
    return bounded(f"hex_{name}", case, least, unit="1", limit=LEAST_JACOBIAN, sense="min")


def _label_row(name: str, source: LabelledSurface, meshes: MembraneMesh) -> Row:
    try:
        worst, where = worst_area_error(source, meshes)
    except MeshingError as problem:
        return failed(f"labels_{name}", "default, 0.4 mm", unit="1", why=problem.message)
    case = f"default, 0.4 mm: largest on {where}"
    return bounded(f"labels_{name}", case, worst, unit="1", limit=AREA_LIMIT)


def worst_area_error(source: LabelledSurface, meshes: MembraneMesh) -> tuple[float, str]:
    """Largest relative error of area among the regions of both skins, and that region's name.

    Raises:
        MeshingError: If the skins lost a region, or have one that the body has not.
    """
    wanted = _areas_mm2(source)
    found = _areas_mm2(meshes.outer) | _areas_mm2(meshes.inner)
    wanted.pop("base", None)
    if found.keys() != wanted.keys():
        raise MeshingError(
            f"regions {sorted(found.keys() ^ wanted.keys())} are not on both body and skins",
            hint="lower meshing.hex_mm",
            at="meshing.hex_mm",
        )
    errors = {name: abs(found[name] / area - 1.0) for name, area in wanted.items()}
    where = max(errors, key=lambda name: errors[name])
    return errors[where], where


def _areas_mm2(surface: LabelledSurface | Skin) -> dict[str, float]:
    corners = surface.points_mm[surface.faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(across, axis=1) / 2
    masks = region_masks(surface.labels, surface.numbers)
    return {name: float(area[members].sum()) for name, members in masks.items()}
