"""Writes a coloured mesh as a GLB file: the frames of a press are many, alike, and wanted at once.

One mesh of triangles with positions, smooth normals and a colour at each vertex, under one matt
material. What frames share, the triangles and who is beside whom, is
worked out once (`Topology`). Left out: textures, several meshes, a tree of nodes, compression.

The layout is the binary one of glTF 2.0: a header of 12 bytes, then the chunks `JSON` and `BIN`,
each of 8 bytes and contents padded to a multiple of four. Source: Khronos Group, glTF 2.0
Specification, sections 3.6 (accessors), 3.7.2 (meshes), 3.9 (materials) and 4.4 (binary layout).
"""

from __future__ import annotations

import functools
import json
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np

SRGB_GAMMA = 2.2
"""Power that comes near the curve of sRGB."""
FLOAT, UINT32, UINT16, UINT8 = 5126, 5125, 5123, 5121
"""Component types."""
ARRAY, ELEMENTS = 34962, 34963
"""What a buffer view is bound to: attributes of vertices, indices."""
MATT = {"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.5}}
"""Without a material glTF means polished metal, which is black without an environment."""
CLEAR = {"alphaMode": "BLEND", "extensions": {"KHR_materials_unlit": {}}}
"""What a mesh with opacities has in place of a finish: its colours as they are, whatever lights."""
MOST_SHORT = 65_535
"""Vertices that 16 bits can name; the last number is kept free by the standard."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Topology:
    """Triangles, and what of them does not change when their vertices move."""

    faces: np.ndarray
    """Triangles, shape (M, 3)."""
    indices: np.ndarray
    """The same as the file has them, flat, uint16 where they fit, else uint32."""
    around: Any
    """Sparse matrix (N, M) of ones: which triangles are around which vertex."""

    @classmethod
    def of(cls, faces: np.ndarray, vertex_count: int) -> Topology:
        """That of triangles (M, 3) between so many vertices."""
        from scipy.sparse import csr_matrix

        faces = np.asarray(faces)
        kind = np.uint16 if vertex_count <= MOST_SHORT else np.uint32
        corners = np.asarray(faces, dtype=np.int32).ravel()
        triangles = np.repeat(np.arange(len(faces), dtype=np.int32), 3)
        ones = np.ones(len(corners), dtype=np.float32)
        around = csr_matrix((ones, (corners, triangles)), shape=(vertex_count, len(faces)))
        return cls(faces=faces, indices=faces.astype(kind).ravel(), around=around)

    def normals(self, points: np.ndarray) -> np.ndarray:
        """Area-weighted unit normals of vertices (N, 3), float32; zero where no triangle is."""
        points = np.asarray(points, dtype=np.float32)
        a, b, c = (points[self.faces[:, k]] for k in range(3))
        ab, ac = b - a, c - a
        # Three times as fast as np.cross.
        doubled = np.empty_like(ab)
        doubled[:, 0] = ab[:, 1] * ac[:, 2] - ab[:, 2] * ac[:, 1]
        doubled[:, 1] = ab[:, 2] * ac[:, 0] - ab[:, 0] * ac[:, 2]
        doubled[:, 2] = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
        summed = np.asarray(self.around @ doubled)
        length = np.sqrt(np.einsum("ij,ij->i", summed, summed))
        return summed / np.maximum(length, np.float32(1e-30))[:, None]


def write_glb(
    points_mm: np.ndarray, colours: np.ndarray, topology: Topology, *, both_sides: bool
) -> bytes:
    """A mesh as the bytes of a GLB file.

    Args:
        points_mm: Vertices [mm], shape (N, 3), finite, at least one.
        colours: sRGB of the vertices, shape (N, 3), uint8; or (N, 4) with opacities, unlit.
        topology: Its triangles, at least one.
        both_sides: Whether the back of a triangle is drawn too, which takes longer.
    """
    points = np.ascontiguousarray(points_mm, dtype="<f4")
    # Attributes begin at multiples of four bytes, so a colour has four.
    colour = np.full((len(points), 4), 255, dtype=np.uint8)
    given = np.asarray(colours)
    colour[:, :3] = _linear()[given[:, :3]]
    clear = given.shape[1] == 4
    if clear:
        colour[:, 3] = given[:, 3]
    blocks = [points, topology.normals(points).astype("<f4", copy=False), colour]
    parts = [block.tobytes() for block in (*blocks, topology.indices)]
    sizes = tuple(len(part) for part in parts)
    material = {**(CLEAR if clear else MATT), "doubleSided": both_sides}
    text = _description(sizes, points, topology, material)
    return _packed(text, b"".join(parts))


def _description(
    sizes: tuple[int, ...], points: np.ndarray, topology: Topology, material: dict[str, Any]
) -> bytes:
    """The chunk of JSON: what stands where in the chunk of bytes."""
    vertices, corners = len(points), len(topology.indices)
    kind = UINT16 if topology.indices.dtype == np.uint16 else UINT32
    low = [float(low) for low in points.min(axis=0)]
    high = [float(high) for high in points.max(axis=0)]
    starts = [sum(sizes[:k]) for k in range(len(sizes))]
    views = [
        {"buffer": 0, "byteOffset": start, "byteLength": size, "target": target}
        for start, size, target in zip(starts, sizes, (ARRAY, ARRAY, ARRAY, ELEMENTS), strict=True)
    ]
    vector = {"componentType": FLOAT, "count": vertices, "type": "VEC3"}
    colour = {"componentType": UINT8, "normalized": True, "count": vertices, "type": "VEC4"}
    index = {"componentType": kind, "count": corners, "type": "SCALAR"}
    accessors = [{**vector, "min": low, "max": high}, vector, colour, index]
    attributes = {"POSITION": 0, "NORMAL": 1, "COLOR_0": 2}
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 3, "material": 0}]}],
        "materials": [material],
        **({"extensionsUsed": list(material["extensions"])} if "extensions" in material else {}),
        "buffers": [{"byteLength": sum(sizes)}],
        "bufferViews": views,
        "accessors": [{"bufferView": k, **each} for k, each in enumerate(accessors)],
    }
    return json.dumps(tree, separators=(",", ":")).encode()


def _packed(text: bytes, data: bytes) -> bytes:
    """Header and both chunks; JSON is filled up with spaces, bytes with zeros."""
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    return b"".join(
        (
            struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(data)),
            struct.pack("<I4s", len(text), b"JSON"),
            text,
            struct.pack("<I4s", len(data), b"BIN\0"),
            data,
        )
    )


@functools.cache
def _linear() -> np.ndarray:
    """Linear light, which glTF takes at vertices, of each grey value of sRGB, shape (256,)."""
    return np.rint(255.0 * (np.arange(256) / 255.0) ** SRGB_GAMMA).astype(np.uint8)
