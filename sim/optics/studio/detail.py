"""Textures of the object that are finer than contact's grid, added to images pixel by pixel.

Within the contact patch the skin takes on the fine relief f of the object (`fine_surface`) as far
as the pressure carries it into the valleys (`detail_filling`). At a pixel that sees the place x of
the deformed skin, a = R^T (x - o) in the object's body frame, the skin is moved by

    D = e s,   e = R (0, 0, -1),   s = w c(a_z) skin(f(a_x, a_y), p)

with the pressure p interpolated in the triangle, c the share of the texture at the body's height
(1 below its origin, 0 at its top), and w the share of the triangle's corners, weighed by their
nearness, that are touched: 0 at the rim. With g = w c R (ds/da_x, ds/da_y, 0) the outward normal
becomes the cofactor of I + e g^T applied to it,

    n' = unit((1 + e . g) n - (e . n) g),

depth grows by the way along the pixel's ray to the moved plane, and radiance by what the light
model gives for n' less what it gives for n (`detail_kernels`), dimmed by the share of light that
the dent's shadow leaves of the smooth skin. Displacement and shading are linear in pixels: crests
are not shifted sideways (0.03 mm seen at 45 degrees would be half a pixel).

Limits. Skin: ridges from 0.05 mm on (`textures.FINEST_MM`) and slopes up to 1.5; periods below the
thickness of the elastomer, beyond which it is no half-space (2 mm on a finger). Image: a period
needs two pixels, 0.31 mm at the tip of a finger 42 mm high that 640 pixels see at 100 degrees (0.16
mm per pixel), and nothing warns where it has fewer: a moire shows. Light is taken at the middle of
each pixel and not averaged over it, so contrast is too high by 57 % at two pixels per period, 11 %
at four, 3 % at eight. Against a skin meshed ten and twenty times per period the contrast of waves
of 0.5 mm is 1.04 and 1.01 (`detail_checks`).

Left out: meshes finer than the samples; soft objects, whose surface moves; contact by particles,
which finds no pressure; skins seen from behind through pins; the model `photons`, which traces the
skin of the mesh; the relief's own shadows and interreflection; slope of w, c and p.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.contact.objects.fine_surface import fine_surface
from sim.contact.objects.sampling import box_mm
from sim.optics.raster.bundles import Spots
from sim.optics.raster.imager import Imager
from sim.optics.studio.detail_filling import Filling, filling
from sim.optics.studio.detail_kernels import shade_points
from workbench.core.base.poses import rotations
from workbench.core.press.indenter import Indenter
from workbench.core.result.results import MembraneMesh, Skin
from workbench.core.result.sensing import Contact

LEAST_COSINE = 0.05
"""Cosine of ray and skin below which a displacement moves no depth: the skin is seen edge-on."""


@dataclass(frozen=True, kw_only=True, slots=True)
class DetailPixels:
    """What the detail changes in one frame, at P pixels."""

    pixel: np.ndarray
    """Their numbers, shape (P,)."""
    change: np.ndarray
    """Of the radiance that leaves the skin toward the camera, shape (P, 3), float32."""
    normal: np.ndarray
    """Unit normals facing the camera, shape (P, 3), float32."""
    away_mm: np.ndarray
    """By how much the skin is farther along the pixel's ray [mm], shape (P,), float32."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Detail:
    """The fine relief of an object in K frames of a press."""

    filling: Filling
    pose: np.ndarray
    """Of the body frame, as `Contact.indenter_pose`, shape (K, 7)."""
    pressure_MPa: np.ndarray
    """At the vertices of the seen skin, shape (K, V)."""
    top_mm: float
    """Height of the body above its origin [mm]."""

    def seen(self, imager: Imager, frame: int) -> DetailPixels | None:
        """What changes in the one frame that the imager has just looked at; None if nothing."""
        touched = touched_pixels(imager, self.pressure_MPa[frame])
        if not len(touched.pixel):
            return None
        relief_mm, slope, toward = self.relief(frame, touched)
        smooth = touched.normal
        lean = smooth @ toward
        stretch = (1.0 + slope @ toward)[:, None]
        tilted = _unit(stretch * smooth - lean[:, None] * slope)
        cosine = np.einsum("pc,pc->p", touched.way, smooth)
        facing = np.where(cosine > LEAST_COSINE, relief_mm * lean / np.maximum(cosine, 1e-6), 0.0)
        return DetailPixels(
            pixel=touched.pixel,
            change=_change(imager, touched, tilted),
            normal=_facing(tilted, touched.way),
            away_mm=facing.astype(np.float32),
        )

    def relief(
        self, frame: int, touched: TouchedPixels
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Height [mm], (P,), its slope, (P, 3), and the unit vector that it goes along, (3,)."""
        origin_mm, turned = self.pose[frame, :3], rotations(self.pose[frame : frame + 1, 3:])[0]
        body_mm = (touched.place_mm - origin_mm) @ turned
        height_mm, slopes = self.filling.heights(body_mm[:, :2], touched.pressure_MPa)
        share = touched.share * np.clip(1.0 - body_mm[:, 2] / self.top_mm, 0.0, 1.0)
        return share * height_mm, (share[:, None] * slopes) @ turned[:, :2].T, -turned[:, 2]


@dataclass(frozen=True, kw_only=True, slots=True)
class TouchedPixels:
    """P pixels that see skin which the object touches."""

    pixel: np.ndarray
    """Shape (P,)."""
    corners: np.ndarray
    """Vertices of the triangle that each sees, shape (P, 3), int32."""
    weights: np.ndarray
    """Barycentric coordinates, shape (P, 3), float32."""
    place_mm: np.ndarray
    """On the deformed skin [mm], shape (P, 3)."""
    normal: np.ndarray
    """Outward unit normals there, shape (P, 3)."""
    way: np.ndarray
    """Unit directions of the rays, away from the camera, shape (P, 3)."""
    pressure_MPa: np.ndarray
    """Shape (P,)."""
    share: np.ndarray
    """Share w of the corners that are touched, shape (P,)."""


def open_detail(
    indenter: Indenter | None,
    mesh: MembraneMesh,
    contact: Contact,
    *,
    young_MPa: float,
    poisson: float,
) -> Detail | None:
    """The fine relief of an object on a press; None where there is none, or no way to show it.

    Args:
        indenter: The object; None where no detail is wanted.
        mesh: The skins.
        contact: The press, on the outer skin.
        young_MPa: Young's modulus of the elastomer.
        poisson: Its Poisson ratio.

    Raises:
        DesignError: If its ridges are too narrow for an image.
    """
    if indenter is None or indenter.soft is not None:
        return None
    if not len(contact.pressure_MPa) or len(mesh.tips_mm):
        return None
    edge_mm = touched_edge_mm(mesh.seen, contact.pressure_MPa)
    surface = fine_surface(indenter.texture, grid_mm=contact.grid_mm, edge_mm=edge_mm)
    if surface is None:
        return None
    return Detail(
        filling=filling(surface, young_MPa / (1.0 - poisson**2)),
        pose=contact.indenter_pose,
        pressure_MPa=contact.pressure_MPa,
        top_mm=float(box_mm(indenter)[1][2]),
    )


def touched_edge_mm(skin: Skin, pressure_MPa: np.ndarray) -> float:
    """Root mean square edge [mm] of the triangles that are touched in any frame, else of all.

    Args:
        skin: The seen skin.
        pressure_MPa: At its vertices, shape (K, V).
    """
    most_MPa = pressure_MPa.max(axis=0)
    touched = np.any(most_MPa[skin.faces] > 0.0, axis=1)
    corners = skin.points_mm[skin.faces[touched] if touched.any() else skin.faces]
    edges = corners - np.roll(corners, 1, axis=1)
    return float(np.sqrt(np.mean(np.sum(edges**2, axis=2))))


def touched_pixels(imager: Imager, pressure_MPa: np.ndarray) -> TouchedPixels:
    """Pixels whose triangle has a corner under pressure, of the first frame of the batch."""
    raster = imager.raster
    face = raster.seen.triangle.to_numpy()[: raster.pixels]
    shown = (face >= 0) & (raster.seen.on_patch.to_numpy()[: raster.pixels] > 0)
    pressed = np.any(pressure_MPa[raster.view.faces] > 0.0, axis=1)
    pixel = np.flatnonzero(shown & pressed[face])
    corners = raster.view.faces[face[pixel]]
    second = raster.seen.weights.to_numpy()[pixel]
    weights = np.column_stack([1.0 - second.sum(axis=1), second]).astype(np.float32)
    placed = raster.posed.placed.to_numpy()[: raster.vertices]
    turned = raster.posed.turned.to_numpy()[: raster.vertices]

    def blended(values: np.ndarray) -> np.ndarray:
        return np.einsum("pk,pk...->p...", weights, values[corners])

    return TouchedPixels(
        pixel=pixel,
        corners=corners,
        weights=weights,
        place_mm=blended(placed),
        normal=_unit(blended(turned)),
        way=raster.view.direction[pixel],
        pressure_MPa=blended(np.maximum(pressure_MPa, 0.0)),
        share=blended((pressure_MPa > 0.0).astype(np.float32)),
    )


def _change(imager: Imager, touched: TouchedPixels, tilted: np.ndarray) -> np.ndarray:
    """Radiance with the tilted normals less that with the smooth ones, (P, 3), float32."""
    raster, shader = imager.raster, imager.shader
    spots = Spots(
        corners=np.ascontiguousarray(touched.corners, dtype=np.int32),
        shares=touched.weights,
        smooth=np.ascontiguousarray(-touched.normal, dtype=np.float32),
        tilted=np.ascontiguousarray(-tilted, dtype=np.float32),
    )
    before, after = np.zeros((2, len(touched.pixel), 3), dtype=np.float32)
    shade: Any = shade_points
    shade(
        spots,
        raster.skin,
        raster.posed,
        shader.lights,
        shader.scattered,
        shader.law,
        before,
        after,
    )
    lit = raster.radiance.to_numpy()[touched.corners]
    shadowed = np.einsum("pk,pkc->pc", touched.weights, lit)
    # What grazes the smooth skin lights crests alone, and no shadow of it is known.
    left = np.where(before > 0.0, shadowed / np.maximum(before, 1e-30), 1.0)
    return (after - before) * np.clip(left, 0.0, 1.0)


def _facing(outward: np.ndarray, way: np.ndarray) -> np.ndarray:
    """Normals toward the camera, as `compose_kernels.describe` writes them."""
    facing = -outward
    facing -= np.maximum(np.einsum("pc,pc->p", facing, way), 0.0)[:, None] * way
    return _unit(facing).astype(np.float32)


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12)
