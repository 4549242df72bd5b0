"""Detail drawn pixel by pixel against a skin whose mesh is fine enough to carry it.

A small finger is dented at its tip under a pressure like Hertz's, and a wave of 0.5 mm stands on
the object. The witness is the same skin with its triangles at the tip divided eight by eight and
moved by the same relief: normals, depth, light and occlusion there come from geometry alone. The
null is the coarse skin without detail.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from sim.contact.objects.fine_surface import fine_surface
from sim.contact.objects.textures import true_heights
from sim.optics.field.bake import bake_light
from sim.optics.proof.specimen import dent, finger
from sim.optics.studio.detail import Detail, TouchedPixels, touched_edge_mm, touched_pixels
from sim.optics.studio.detail_filling import filling
from sim.optics.studio.render import Studio
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedRing, LightModel
from workbench.core.design.optics import Optics
from workbench.core.press.texture import Pattern, Texture
from workbench.core.result.results import MembraneMesh, Skin

DIRECT = LightModel("direct")
WAVES = Texture(pattern=Pattern.WAVES, pitch_mm=0.5, height_mm=0.03)
CARRIED = Texture(pattern=Pattern.WAVES, pitch_mm=1.5, height_mm=0.06)
RADIUS_MM, CYLINDER_MM = 8.0, 6.0
PATCH_MM = 2.0
"""Radius of the patch under pressure."""
COMPARED = 0.7
"""Share of that radius in which contrast is compared: the rim fades on both sides."""
DIVISIONS = 3
"""Times that edges of 0.4 mm are halved: 0.05 mm, ten per period."""
PLANE_STRAIN_MPa = 0.18
GRID_MM = 0.5
CAMERA = Camera(width_px=320, height_px=240, fov_x_deg=25.0)
RING = LedRing(radius_mm=3.0)


def wave_contrast(model: LightModel = DIRECT) -> tuple[float, float]:
    """Amplitude at the wave's period over that of the witness: with detail, and without.

    Should be 1 and 0.
    """
    mesh = finger(radius_mm=RADIUS_MM, elastomer_mm=1.5, cylinder_mm=CYLINDER_MM, edge_mm=0.4)
    detail = tip_detail(mesh.outer)
    moved = _dent(mesh.outer)
    optics = Optics(camera=CAMERA, ring=RING, light_model=model)
    studio = Studio(mesh, bake_light(mesh, RING, model=model), optics)
    plain = studio.linear(moved[None])[0].reshape(-1, 3)
    touched = touched_pixels(studio.imager, detail.pressure_MPa[0])
    detailed = studio.detailed(moved, detail)
    fine, fine_moved = _witness(mesh, moved, detail)
    fine_light = bake_light(fine, RING, model=model)
    witness = Studio(fine, fine_light, optics).linear(fine_moved[None])[0].reshape(-1, 3)
    return _contrast(witness, detailed, plain, touched, WAVES.pitch_mm)


def carried_contrast() -> tuple[float, float]:
    """As `wave_contrast`, of waves of 1.5 mm that contact resolves and the skin carries in part.

    The coarse skin's vertices lie on the object; the witness's do, at every 0.05 mm.
    """
    mesh = finger(radius_mm=RADIUS_MM, elastomer_mm=1.5, cylinder_mm=CYLINDER_MM, edge_mm=0.4)
    detail = tip_detail(mesh.outer, texture=CARRIED, pressed=50.0)
    within = detail.pressure_MPa[0] > 0.0
    moved = _dent(mesh.outer)
    skin, (_, fine) = _divided(mesh.outer, within, [mesh.outer.normals, moved])
    optics = Optics(camera=CAMERA, ring=RING, light_model=DIRECT)
    studio = Studio(mesh, bake_light(mesh, RING, model=DIRECT), optics)
    coarse = moved + _raised(mesh.outer.points_mm)
    divided = dataclasses.replace(mesh, outer=skin)
    light = bake_light(divided, RING, model=DIRECT)
    witness = Studio(divided, light, optics)
    true = witness.linear((fine + _raised(skin.points_mm)).astype(np.float32)[None])[0]
    plain = studio.linear(coarse[None])[0].reshape(-1, 3)
    touched = touched_pixels(studio.imager, detail.pressure_MPa[0])
    shown = studio.detailed(coarse, detail)
    return _contrast(true.reshape(-1, 3), shown, plain, touched, CARRIED.pitch_mm)


def _raised(points_mm: np.ndarray) -> np.ndarray:
    """Displacement of skin that lies on the carried waves, fading beyond the patch, (V, 3)."""
    height = true_heights(CARRIED)(points_mm[:, :2]) - 0.5 * CARRIED.height_mm
    top_mm = RADIUS_MM + CYLINDER_MM
    away = np.linalg.norm(points_mm - [0.0, 0.0, top_mm], axis=1)
    height *= np.clip(4.0 - away / (0.5 * PATCH_MM), 0.0, 1.0)
    return (-height[:, None] * [0.0, 0.0, 1.0]).astype(np.float32)


def _contrast(
    true: np.ndarray,
    shown: np.ndarray,
    plain: np.ndarray,
    touched: TouchedPixels,
    pitch_mm: float,
) -> tuple[float, float]:
    near = np.linalg.norm(touched.place_mm[:, :2], axis=1) < COMPARED * PATCH_MM
    pixel, place = touched.pixel[near], touched.place_mm[near]
    right = _amplitudes(true[pixel], place, pitch_mm)
    found = [float(_amplitudes(a[pixel], place, pitch_mm) @ right) for a in (shown, plain)]
    return found[0] / float(right @ right), found[1] / float(right @ right)


def tip_detail(skin: Skin, *, texture: Texture = WAVES, pressed: float = 2.0) -> Detail:
    """Detail at the tip of a finger under Hertz's pressure, at most `pressed` of the full one."""
    top_mm = float(skin.points_mm[:, 2].max())
    away = np.linalg.norm(skin.points_mm - [0.0, 0.0, top_mm], axis=1) / PATCH_MM
    share = np.sqrt(np.maximum(1.0 - away**2, 0.0))
    edge_mm = touched_edge_mm(skin, share[None])
    surface = fine_surface(texture, grid_mm=GRID_MM, edge_mm=edge_mm)
    assert surface is not None
    relief = filling(surface, PLANE_STRAIN_MPa)
    return Detail(
        filling=relief,
        pose=np.array([[0.0, 0.0, top_mm + 5.0, 1.0, 0.0, 0.0, 0.0]]),
        pressure_MPa=(pressed * relief.full_MPa * share)[None].astype(np.float32),
        top_mm=5.0,
    )


def _dent(skin: Skin) -> np.ndarray:
    top_mm = RADIUS_MM + CYLINDER_MM
    return dent(skin, at_mm=(0.0, 0.0, top_mm), depth_mm=0.4, radius_mm=3.0)


def _witness(
    mesh: MembraneMesh, moved: np.ndarray, detail: Detail
) -> tuple[MembraneMesh, np.ndarray]:
    """The mesh with a fine tip, and the displacement of its vertices with the relief."""
    pressure = detail.pressure_MPa[0]
    values = [mesh.outer.normals, moved, pressure[:, None], (pressure > 0.0)[:, None]]
    skin, (normals, moved, pressure, share) = _divided(mesh.outer, pressure > 0.0, values)
    touched = TouchedPixels(
        pixel=np.arange(len(moved)),
        corners=np.zeros((len(moved), 3), dtype=np.int32),
        weights=np.zeros((len(moved), 3), dtype=np.float32),
        place_mm=skin.points_mm + moved,
        normal=normals,
        way=normals,
        pressure_MPa=pressure[:, 0],
        share=share[:, 0],
    )
    relief_mm, _, toward = detail.relief(0, touched)
    total = moved + relief_mm[:, None] * toward
    return dataclasses.replace(mesh, outer=skin), total.astype(np.float32)


def _divided(
    skin: Skin, within: np.ndarray, values: list[np.ndarray]
) -> tuple[Skin, list[np.ndarray]]:
    """The skin with the faces at some vertices divided, and vertex values interpolated.

    Where divided faces meet whole ones, new vertices lie on the whole one's edge: no gap opens.
    """
    points, faces = skin.points_mm, skin.faces.astype(np.int64)
    fine, rest = faces[within[faces].any(axis=1)], faces[~within[faces].any(axis=1)]
    carried = [points, *(value.astype(np.float64) for value in values)]
    for _ in range(DIVISIONS):
        ends = np.sort(fine[:, [[0, 1], [1, 2], [2, 0]]], axis=2).reshape(-1, 2)
        edges, of = np.unique(ends, axis=0, return_inverse=True)
        middle = len(carried[0]) + of.reshape(-1, 3)
        carried = [np.concatenate([v, v[edges].mean(axis=1)]) for v in carried]
        a, b, c = fine.T
        ab, bc, ca = middle.T
        parts = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
        fine = np.concatenate([np.column_stack(part) for part in parts])
    points, normals, *others = carried
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    faces = np.concatenate([rest, fine]).astype(np.int32)
    return Skin(points_mm=points, faces=faces, normals=normals), [normals, *others]


def _amplitudes(light: np.ndarray, place_mm: np.ndarray, pitch_mm: float) -> np.ndarray:
    """Cosine and sine parts at the wave's period beside a smooth trend, all colours, shape (6,)."""
    x, y = place_mm[:, 0], place_mm[:, 1]
    phase = 2.0 * np.pi * x / pitch_mm
    powers = [x**i * y**j for i in range(5) for j in range(5 - i)]
    terms = np.column_stack([np.cos(phase), np.sin(phase), *powers])
    return np.linalg.lstsq(terms, light, rcond=None)[0][:2].ravel()
