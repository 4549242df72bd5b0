"""What is printed on the skin that the camera sees: markers, or the tips of pins."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from sim.optics.field.model import model_of
from sim.optics.raster.backdrop import dots_of_faces
from sim.optics.raster.gbuffer import GBuffer
from sim.optics.raster.markers import TIP_REFLECTANCE, Coverage, Dots, dots_at, ink, print_dots
from sim.optics.raster.skin_view import SkinView
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LightModel
from workbench.core.design.optics import Optics
from workbench.core.result.results import MembraneMesh

LEAST_ALBEDO = 0.01
"""Darkest skin that white tips are compared with [1]: carbon-black silicone returns 2 to 5 %."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Printed:
    """What is printed on the seen skin, and which pixels see it."""

    dots: Dots
    gain: float
    """Radiance of inked skin over that of bare skin [1]."""
    coverage: Coverage
    """Of the background."""
    start: np.ndarray
    """Where the dots of each triangle begin in `of`, int32."""
    of: np.ndarray
    """Numbers of the dots that each triangle can hold, one triangle after the other, int32."""


def _dots(
    mesh: MembraneMesh, model: LightModel, optics: Optics, camera: Camera
) -> tuple[Dots, float]:
    """What is printed on the seen skin: tips of pins, else markers; and its gain."""
    if len(mesh.tips_mm):
        coating = optics.coating
        albedo = coating.phong_diffuse if model_of(model).paper else coating.albedo
        dots = dots_at(mesh.seen, mesh.tips_mm, mesh.tip_radius_mm, camera)
        return dots, TIP_REFLECTANCE / max(albedo, LEAST_ALBEDO)
    return print_dots(mesh.seen, optics.markers, camera), optics.markers.reflectance


def printed_on(
    mesh: MembraneMesh,
    model: LightModel,
    optics: Optics,
    camera: Camera,
    view: SkinView,
    seen: GBuffer,
) -> Printed:
    """Dots or tips as the pixels `seen` see them."""
    dots, gain = _dots(mesh, model, optics, camera)
    by_number = np.empty_like(dots.inked)
    by_number[:] = dots.inked[view.face_number]
    coverage = ink(
        seen,
        dots=dataclasses.replace(dots, inked=by_number),
        skin=dataclasses.replace(mesh.seen, faces=view.faces),
        camera=camera,
        rays=view.rays,
    )
    start, of = dots_of_faces(dots, mesh.seen, view)
    return Printed(dots=dots, gain=gain, coverage=coverage, start=start, of=of)
