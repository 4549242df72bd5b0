"""Driven regions: which faces an actuation moves, and where their points belong when."""

from __future__ import annotations

import numpy as np

from sim.contact.region.quadrature import SurfacePoints
from workbench.core.base.errors import DesignError, shown
from workbench.core.press.actuation import Actuation
from workbench.core.press.press import Press
from workbench.core.result.results import MembraneMesh, Skin, region_masks

UNDRIVEN = -1


def driven_faces(mesh: MembraneMesh, press: Press) -> tuple[np.ndarray, np.ndarray]:
    """Which actuation drives each outer and inner face, -1 for none, shapes (F,) and (G,).

    Raises:
        DesignError: If the membrane has no region of that name.
    """
    skins = (mesh.outer, mesh.inner)
    outer, inner = (np.full(len(skin.faces), UNDRIVEN) for skin in skins)
    regions = [region_masks(skin.labels, skin.numbers) for skin in skins]
    for number, actuation in enumerate(press.actuations):
        chosen = [
            _facing(skin, actuation) & named.get(actuation.region, np.zeros(len(skin.faces), bool))
            for skin, named in zip(skins, regions, strict=True)
        ]
        if not any(mask.any() for mask in chosen):
            names = ", ".join(sorted(set(regions[0]) | set(regions[1])))
            raise DesignError(
                f"the membrane has no region {shown(actuation.region)} to drive; it has {names}",
                hint="name one of them, or choose a family with actuators, such as the trunk",
                at="press.actuations",
            )
        for drives, mask in zip((outer, inner), chosen, strict=True):
            drives[mask] = number
    return outer, inner


def _facing(skin: Skin, actuation: Actuation) -> np.ndarray:
    """Faces on the side that the actuation names; all where it names none, shape (F,), bool."""
    if not any(actuation.facing):
        return np.ones(len(skin.faces), bool)
    corners = skin.points_mm[skin.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return normal @ np.asarray(actuation.facing) > 0.0


def drives_inner(mesh: MembraneMesh, press: Press) -> bool:
    """Whether a drive moves any of the inner skin."""
    return bool((driven_faces(mesh, press)[1] != UNDRIVEN).any())


def farthest_drive_mm(mesh: MembraneMesh, press: Press) -> float:
    """Longest way of a driven vertex from where it was, looked at where drives turn round [mm]."""
    farthest_mm = 0.0
    driven = driven_faces(mesh, press)
    for skin, drives in zip((mesh.outer, mesh.inner), driven, strict=True):
        for number, actuation in enumerate(press.actuations):
            places_mm = skin.points_mm[np.unique(skin.faces[drives == number])]
            for frame, _ in actuation.keys:
                ways_mm = np.linalg.norm(actuation.displacement_mm(places_mm, frame), axis=1)
                farthest_mm = max(farthest_mm, float(ways_mm.max(initial=0.0)))
    return farthest_mm


def driven_displacement_mm(points: SurfacePoints, press: Press, progress: float) -> np.ndarray:
    """Displacement that drives prescribe after `progress` frames [mm], (P, 3); 0 elsewhere."""
    found = np.zeros((points.count, 3))
    for number, actuation in enumerate(press.actuations):
        members = points.drive == number
        found[members] = actuation.displacement_mm(points.position_mm[members], progress)
    return found
