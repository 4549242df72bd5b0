"""The skin's mirror images in the cavity's wall, which the product leaves out of its images.

A camera's ray that meets the wall from the air side is split: Fresnel's T goes on to the skin, R
comes back. What comes back crosses the cavity, meets the wall again, and of it R T reaches the skin
there, R^2 T after one more crossing, and so on:

    ghost = sum over k >= 1 of R_1 ... R_k T_(k+1) L(skin behind the wall at the k-th mirrored ray)

Along the axis of a finger of index 1.41 that is about 3 % of the light; where the wall is seen at a
slant some 10 %. A path tracer shows it, and so does a real sensor. The product leaves it out of its
images: it would cost several casts of every ray in each frame. It is here to compare with path
tracers on equal terms.

Leaves out: mirror images of the lights (`maps.pixel_glare` has the first), light reflected at the
wall from inside the solid, which the traced photons hold already, and a second wall behind a ridge.
Source of the split: Born and Wolf, Principles of Optics, section 1.5.
"""

from __future__ import annotations

import numpy as np

from sim.optics.camera.camera import pixel_centres, pixel_directions
from sim.optics.camera.refraction import refract
from workbench.core.base.check import expect
from workbench.core.design.camera import Camera
from workbench.core.result.results import MembraneMesh, Skin

STEP_MM = 1e-3
"""How far a ray starts beside the wall that it left [mm]; single precision holds 4e-6."""


def mirrored_radiance(
    mesh: MembraneMesh,
    camera: Camera,
    index: float,
    radiance_at_vertices: np.ndarray,
    *,
    bounces: int = 5,
) -> np.ndarray:
    """Radiance of mirror images, to be added to what the camera sees, shape (H, W, 3), float64.

    In the solid's own measure: what is seen in air is 1 / index^2 of it, as of the image itself.

    Args:
        mesh: The skins; its seen skin may be a deformed one.
        camera: In the cavity.
        index: Refractive index of the solid [1].
        radiance_at_vertices: Of the seen skin, the same in all directions, shape (V, 3).
        bounces: Crossings of the cavity that are followed; each has a tenth of the light before.
    """
    from geometry.surface.rays import RayCaster

    skin, wall = mesh.seen, mesh.cavity
    expect(radiance_at_vertices, f"{len(skin.points_mm)} 3", name="radiance")
    at_wall = RayCaster(wall.points_mm, wall.faces)
    at_skin = RayCaster(skin.points_mm, skin.faces)
    direction = pixel_directions(camera, pixel_centres(camera))
    found = np.zeros((len(direction), 3))
    origin = np.tile(np.asarray(camera.position_mm, dtype=np.float64), (len(direction), 1))
    pixel, share = np.arange(len(direction)), np.ones(len(direction))
    for bounce in range(bounces + 1):
        distance, face, weights = at_wall.hits(origin, direction)
        normal = _normals(wall, face, weights)
        # A ray that meets no wall, or one from its solid side, ends there.
        met = (face >= 0) & (np.einsum("ij,ij->i", normal, direction) > 0.0)
        pixel, share, normal, direction = pixel[met], share[met], normal[met], direction[met]
        place = origin[met] + distance[met, None] * direction
        bent, passing = refract(direction, normal, index_from=1.0, index_to=index)
        if bounce:
            _, hit, corners = at_skin.hits(place + STEP_MM * bent, bent)
            seen = hit >= 0
            values = radiance_at_vertices[skin.faces[hit[seen]]]
            light = np.einsum("nk,nkc->nc", corners[seen], values)
            found[pixel[seen]] += (share * passing)[seen, None] * light
        share = share * (1.0 - passing)
        along = np.einsum("ij,ij->i", direction, normal)
        direction = direction - 2.0 * along[:, None] * normal
        origin = place - STEP_MM * normal
    return found.reshape(camera.height_px, camera.width_px, 3)


def _normals(wall: Skin, face: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Smooth unit normals of the wall where rays met it, shape (N, 3); any where they missed."""
    normal = np.einsum("nk,nkd->nd", weights, wall.normals[wall.faces[face]])
    return normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
