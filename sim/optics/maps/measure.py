"""All maps of a design from its baked light and its cameras, in seconds.

Of models without a physical scale (the paper's fields) the maps of illumination and glare are left
out; so is the sensitivity to a force of skins with a gap behind them, whose stiffness depends on
where it ends.
"""

from __future__ import annotations

import numpy as np

from geometry.surface.surface import vertex_areas_mm2
from sim.optics.maps.judging import weighted_percentiles
from sim.optics.maps.look import best_look, look_of
from sim.optics.maps.map_kind import MapKind, Scene, light_maps, map_kinds
from workbench.core.base.monitor import Monitor, part, silent
from workbench.core.design.optics import Optics
from workbench.core.result.light import LightField, NormalTable
from workbench.core.result.maps import DesignerMaps, SkinMap
from workbench.core.result.results import MembraneMesh


def designer_maps(
    mesh: MembraneMesh,
    light: LightField,
    optics: Optics,
    table: NormalTable | None = None,
    *,
    young_MPa: float,
    monitor: Monitor = silent,
) -> DesignerMaps:
    """Every map of a design.

    Args:
        mesh: The skins.
        light: Baked light; any model but `photons`.
        optics: Cameras and coating.
        table: Of the models that have one.
        young_MPa: Of the elastomer, for the sensitivity to a force.
        monitor: Progress and cancellation.

    Raises:
        DesignError: If a camera is outside the cavity or sees nothing of the skin.
        OpticsError: If no light reaches what a camera sees.
    """
    cameras = optics.all_cameras
    looks = []
    for number, camera in enumerate(cameras):
        monitor(0.8 * number / len(cameras), f"maps of camera {number + 1} of {len(cameras)}")
        span = part(monitor, 0.8 * number / len(cameras), 0.8 * (number + 1) / len(cameras))
        looks.append(look_of(mesh, light, optics, table, camera, span))
    monitor(0.8, "maps")
    scene = Scene(mesh=mesh, light=light, look=best_look(looks), young_MPa=young_MPa)
    areas = vertex_areas_mm2(mesh.seen.points_mm, mesh.seen.faces)
    found = []
    for name, kind in map_kinds().items():
        values = kind.measure(scene)
        if values is not None:
            found.append((kind.place, _judged(kind, name, values, areas)))
    for every in light_maps():
        found += [
            (every.place, _judged(kind, name, values, areas))
            for kind, name, values in every.measure(scene)
        ]
    monitor(1.0, "maps ready")
    return DesignerMaps(maps=tuple(found for _, found in sorted(found, key=lambda pair: pair[0])))


def _judged(kind: MapKind, name: str, values: np.ndarray, areas: np.ndarray) -> SkinMap:
    """A map of values (V,) on vertices with these areas [mm2]."""
    values = values.astype(np.float32)
    known = np.isfinite(values)
    seen, weights = values[known].astype(np.float64), areas[known]
    marks = weighted_percentiles(seen, weights)
    return SkinMap(
        name=name,
        label=kind.label,
        unit=kind.unit,
        values=values,
        percentiles=marks,
        score_name=kind.figure,
        score=kind.score(seen, weights, marks),
        better="more" if kind.more_is_better else "less",
        meaning=kind.meaning,
    )
