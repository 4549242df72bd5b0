"""Where on the skin at rest a pixel looks, and how large a pixel is there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.optics.raster.skin_view import SkinView, open_skin_view
from workbench.calibration.seen.photo_set import BallPhoto, Circle
from workbench.core.base.errors import DesignError
from workbench.core.design.optics import Optics
from workbench.core.result.results import MembraneMesh

MOST_APART_MM = 4.0
"""Along the skin, from where the stage was to where the camera of the design sees the contact: in a
finger's twin, whose camera is .5 mm and a degree off, it was 1.6 at most. More is another contact,
or another frame."""
FLAT = 0.9995
"""Least cosine between normals of skin that counts as flat [1]: 1.8 degrees."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactPlace:
    """Where a contact is on the skin."""

    point_mm: np.ndarray
    """Shape (3,)."""
    normal: np.ndarray
    """Outward unit normal, shape (3,)."""
    radius_mm: float
    """Of the circle that is seen."""


class SeenPlaces:
    """One camera before one skin."""

    def __init__(self, mesh: MembraneMesh, optics: Optics) -> None:
        """Cast the camera's rays.

        Raises:
            DesignError: If the camera sees nothing of the skin.
        """
        self.mesh = mesh
        self._view: SkinView = open_skin_view(mesh, optics.camera, index=optics.refractive_index)
        view = self._view
        self._seen = np.diff(view.layer_start) > 0

    def place(self, circle: Circle, name: str) -> ContactPlace:
        """Where a circle of a photograph is.

        Raises:
            DesignError: With the photograph's name, if its middle sees no skin.
        """
        view = self._view
        column = min(max(round(circle.column_px), 0), view.width_px - 1)
        row = min(max(round(circle.row_px), 0), view.height_px - 1)
        number = row * view.width_px + column
        if not self._seen[number]:
            raise DesignError(
                f"{name} has its contact at column {column}, row {row}, where the camera of the "
                "design sees no skin",
                hint="correct the circle, or the camera's place and field of view",
                at="--photos",
            )
        point, normal = self._between(circle, number)
        step = max(2, round(circle.radius_px / 2))
        sizes = []
        for away in (step, -step, step * view.width_px, -step * view.width_px):
            other = number + away
            inside = 0 <= column + away < view.width_px if abs(away) == step else True
            if inside and 0 <= other < len(self._seen) and self._seen[other]:
                sizes.append(np.linalg.norm(self._at(other)[0] - point) / step)
        # People draw the circle's shorter half width where perspective makes it an ellipse.
        mm_per_px = float(np.median(sizes)) if sizes else 0.0
        return ContactPlace(point_mm=point, normal=normal, radius_mm=mm_per_px * circle.radius_px)

    def contact(self, circle: Circle, photo: BallPhoto) -> ContactPlace:
        """Where a photograph's contact is: by its stage where that is known, else by its circle.

        Raises:
            DesignError: With the photograph's name, if the circle's middle sees no skin, or that of
                the stage is far from it.
        """
        seen = self.place(circle, photo.name)
        if photo.place_mm is None:
            return seen
        away = photo.place_mm - seen.point_mm
        apart_mm = float(np.linalg.norm(away - (away @ seen.normal) * seen.normal))
        if apart_mm > MOST_APART_MM:
            pose = ", ".join(f"{value:.1f}" for value in photo.place_mm)
            there = ", ".join(f"{value:.1f}" for value in seen.point_mm)
            raise DesignError(
                f"{photo.name} was pressed at ({pose}) mm by its pose, but its contact is seen at "
                f"({there}), {apart_mm:.1f} mm along the skin, more than {MOST_APART_MM:g}",
                hint="poses are where the ball touches the skin at rest, in mm and in the frame of "
                "the design; correct them or the circle, or leave them empty",
                at="--photos",
            )
        return self._at_point(photo.place_mm, seen)

    def flat_to_mm(self, place: ContactPlace) -> float:
        """How far around a place seen and inner skin are flat and parallel [mm]."""
        nearest = np.inf
        for skin in (self.mesh.outer, self.mesh.inner):
            bent = np.abs(skin.normals @ place.normal) < FLAT
            # Vertices of other faces of the body, such as the far wall, end the flat part too.
            away = np.linalg.norm(skin.points_mm[bent] - place.point_mm, axis=1)
            nearest = min(nearest, float(away.min(initial=np.inf)))
        return nearest

    def wall_mm(self, place: ContactPlace) -> float:
        """Thickness of the wall along the inward normal [mm]; inf where nothing is behind."""
        from geometry.surface.rays import RayCaster

        inner = self.mesh.inner
        start = (place.point_mm - 1e-3 * place.normal)[None]
        caster = RayCaster(inner.points_mm, inner.faces)
        return float(caster.hits(start, -place.normal[None])[0][0])

    def _at_point(self, point_mm: np.ndarray, seen: ContactPlace) -> ContactPlace:
        """The skin that the camera sees nearest to a point, moved along itself to be below it."""
        view = self._view
        numbers = np.flatnonzero(self._seen)
        first_mm = view.layer_mm[view.layer_start[numbers]][:, None]
        skin = view.origin_mm[numbers] + first_mm * view.direction[numbers]
        nearest = numbers[np.argmin(np.linalg.norm(skin - point_mm, axis=1))]
        point, normal = self._at(int(nearest))
        away = point_mm - point
        along = away - (away @ normal) * normal
        return ContactPlace(point_mm=point + along, normal=normal, radius_mm=seen.radius_mm)

    def _between(self, circle: Circle, nearest: int) -> tuple[np.ndarray, np.ndarray]:
        """Point and normal at a circle's middle between four pixels, or of the nearest one."""
        view = self._view
        left = min(max(int(circle.column_px), 0), view.width_px - 2)
        top = min(max(int(circle.row_px), 0), view.height_px - 2)
        right = min(max(circle.column_px - left, 0.0), 1.0)
        down = min(max(circle.row_px - top, 0.0), 1.0)
        first = top * view.width_px + left
        numbers = [first, first + 1, first + view.width_px, first + view.width_px + 1]
        if not self._seen[numbers].all():
            return self._at(nearest)
        shares = np.outer([1.0 - down, down], [1.0 - right, right]).ravel()
        points, normals = zip(*(self._at(number) for number in numbers), strict=True)
        normal = shares @ np.array(normals)
        return shares @ np.array(points), normal / np.linalg.norm(normal)

    def _at(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Point and outward unit normal that a pixel sees."""
        view = self._view
        layer = view.layer_start[number]
        corners = view.faces[view.layer_face[layer]]
        weights = view.layer_weights[layer]
        normal = weights @ view.normals[corners]
        point = view.origin_mm[number] + view.layer_mm[layer] * view.direction[number]
        return point.astype(np.float64), (normal / np.linalg.norm(normal)).astype(np.float64)
