"""Make `released.npz` of the room `published` from the files that were released with the paper.

`.venv/bin/python -m docs.released_bodies FOLDER` reads `FOLDER/membranes/*.stl` and
`FOLDER/indenters/*.stl`. Of a membrane the outer skin is kept: inner faces and the flat cuts by
which it is held are left out. Of an indenter the head is kept, without the block behind it.
Membranes are thinned by quadric decimation as far as stays within `ERROR_MM` of the file, measured
from both sides; places are kept to a micrometre.
"""

from __future__ import annotations

import itertools
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab  # noqa: TID253
import trimesh  # noqa: TID253 (a program of its own, not part of the package)
from scipy.spatial import ConvexHull  # noqa: TID253

from geometry.surface.spread import spread
from geometry.surface.surface import closest_point, face_areas
from workbench.proof.validation.published.released import CUTS, FILE, STEP_MM, Cut

ERROR_MM = 0.02
"""Farthest that a place of either surface may lie from the other."""
SHARES = (0.04, 0.06, 0.08, 0.12, 0.16, 0.24, 0.32, 0.48, 0.64, 1.0)
"""Of the triangles that are kept, the fewest first."""
FLAT_MM = 0.01
FOOT_MM = 25.0
"""x of the face that an indenter's head stands on."""
PLACES = 20_000
WAYS, GRAZING = 200, 0.05
"""Directions that are tried from each face of a membrane, and their least cosine to its normal."""


def skin(body: Any, cuts: tuple[Cut, ...]) -> tuple[np.ndarray, np.ndarray]:
    """The outer faces of a membrane: from which a way leads out, once the cuts are closed."""
    centre, normal = body.triangles_center, body.face_normals
    held = np.zeros(len(centre), dtype=bool)
    closed = [body]
    for cut in cuts:
        flat = (np.abs(body.triangles @ cut.way - cut.offset_mm) < FLAT_MM).all(axis=1)
        rim = body.triangles[flat].reshape(-1, 3)
        across = np.linalg.svd(np.atleast_2d(cut.way))[2][1:]
        hull = rim[ConvexHull(rim @ across.T).vertices]
        fan = [[hull[0], *pair] for pair in itertools.pairwise(hull)]
        closed.append(trimesh.Trimesh(**trimesh.triangles.to_kwargs(fan)))
        held |= flat
    scene: Any = trimesh.util.concatenate(closed)
    outside = held.copy()
    directions = np.random.default_rng(0).normal(size=(WAYS, 3))
    for way in directions / np.linalg.norm(directions, axis=1, keepdims=True):
        todo = np.flatnonzero(~outside & (normal @ way > GRAZING))
        if len(todo):
            start = centre[todo] + 1e-4 * normal[todo]
            blocked = scene.ray.intersects_any(start, np.tile(way, (len(todo), 1)))
            outside[todo[~blocked]] = True
    return compact(body.vertices, body.faces[outside & ~held])


def compact(points: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Without the vertices that no face has, and without faces that have no area."""
    faces = faces[face_areas(points, faces) > 0.0]
    used, renumbered = np.unique(faces, return_inverse=True)
    return np.asarray(points)[used], renumbered.reshape(-1, 3)


def thinned(points: np.ndarray, faces: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray]:
    """A share of the triangles on the same surface, the rim kept."""
    meshlab: Any = pymeshlab
    meshes = meshlab.MeshSet(verbose=False)
    meshes.add_mesh(meshlab.Mesh(points, faces))
    meshes.meshing_decimation_quadric_edge_collapse(
        targetfacenum=int(share * len(faces)),
        preserveboundary=True,
        boundaryweight=10.0,
        preservenormal=True,
        planarquadric=True,
        qualitythr=0.1,
    )
    found = meshes.current_mesh()
    return compact(found.vertex_matrix(), found.face_matrix())


def apart_mm(one: tuple[np.ndarray, np.ndarray], other: tuple[np.ndarray, np.ndarray]) -> float:
    """Largest distance of places of either surface to the other."""
    ways = ((one, other), (other, one))
    return max(float(closest_point(*b, spread(*a, PLACES).points_mm)[1].max()) for a, b in ways)


def rounded(points: np.ndarray) -> np.ndarray:
    """Places in steps, shape (N, 3), int32."""
    return np.round(points / STEP_MM).astype(np.int32)


def main(folder: Path) -> None:
    """Write the file, and say of each body what was left out."""
    kept: dict[str, Any] = {}

    def keep(name: str, points: np.ndarray, faces: np.ndarray) -> None:
        kept[f"{name}/places"] = rounded(points)
        kept[f"{name}/faces"] = faces.astype(np.uint16)

    for family, cuts in CUTS.items():
        whole = skin(trimesh.load(folder / "membranes" / f"{family}.stl"), cuts)
        for share in SHARES:
            small = whole if share == 1.0 else thinned(*whole, share)
            small = (rounded(small[0]) * STEP_MM, small[1])
            error_mm = apart_mm(whole, small)
            if error_mm <= ERROR_MM:
                break
        keep(f"membranes/{family}", *small)
        print(f"{family}: {len(whole[1])} -> {len(small[1])} triangles, {error_mm:.4f} mm")
    for path in sorted((folder / "indenters").glob("*.stl")):
        body: Any = trimesh.load(path)
        head = (body.triangles[:, :, 0] < FOOT_MM - FLAT_MM).any(axis=1)
        keep(f"indenters/{path.stem}", *compact(body.vertices, body.faces[head]))
    np.savez_compressed(FILE, **kept)
    print(f"{FILE}: {FILE.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
