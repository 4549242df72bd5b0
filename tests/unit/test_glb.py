"""The GLB writer: another reader finds the mesh that went in, and trimesh writes the same."""

from __future__ import annotations

import io
import json
import struct
from typing import Any

import numpy as np
import pytest
import trimesh

from ui.page.imaging import coloured_glb
from workbench.view.glb import MOST_SHORT, Topology, write_glb
from workbench.view.section_cut import Axis, Plane


def read(glb: bytes) -> Any:
    """The mesh as trimesh reads it, vertices in their order."""
    return trimesh.load(io.BytesIO(glb), file_type="glb", process=False).dump()[0]  # pyright: ignore


def colours_of(glb: bytes) -> np.ndarray:
    """Linear colours of the vertices as they stand in the file, shape (N, 4), uint8.

    trimesh reads no colours beside a material.
    """
    size = int.from_bytes(glb[12:16], "little")
    tree = json.loads(glb[20 : 20 + size])
    number = tree["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]
    place = tree["bufferViews"][tree["accessors"][number]["bufferView"]]
    start = 20 + size + 8 + place["byteOffset"]
    return np.frombuffer(glb[start : start + place["byteLength"]], np.uint8).reshape(-1, 4)


@pytest.fixture(scope="module")
def torus() -> Any:
    """A smooth mesh of 20 000 vertices in 400 columns."""
    return trimesh.creation.torus(3.0, 1.0, major_sections=200, minor_sections=100)


def test_the_mesh_comes_back(torus: Any) -> None:
    """Positions are those of float32, triangles the same, greys those of a curve of power 2.2."""
    grey = np.tile(np.arange(256, dtype=np.uint8), 79)[: len(torus.vertices)]
    colours = np.stack([grey, grey[::-1], np.full_like(grey, 128)], axis=1)
    topology = Topology.of(torus.faces, len(torus.vertices))
    glb = write_glb(torus.vertices, colours, topology, both_sides=False)
    mesh = read(glb)
    np.testing.assert_array_equal(mesh.vertices, torus.vertices.astype(np.float32))
    np.testing.assert_array_equal(mesh.faces, torus.faces)
    linear = 255.0 * (colours / 255.0) ** 2.2
    # Written as whole numbers.
    np.testing.assert_allclose(colours_of(glb)[:, :3], linear, atol=0.5)
    assert (colours_of(glb)[:, 3] == 255).all()


def test_the_file_is_that_of_trimesh(torus: Any) -> None:
    """Loaded back, both files have the same vertices, colours and triangles."""
    rng = np.random.default_rng(0)
    colours = rng.integers(0, 256, torus.vertices.shape, dtype=np.uint8)
    linear = np.rint(255.0 * (colours / 255.0) ** 2.2).astype(np.uint8)
    theirs = trimesh.Trimesh(torus.vertices, torus.faces, process=False, vertex_colors=linear)
    there = read(trimesh.Scene(theirs).export(file_type="glb", include_normals=True))  # pyright: ignore
    glb = coloured_glb(torus.vertices, torus.faces, colours)
    here = read(glb)
    np.testing.assert_array_equal(here.vertices, there.vertices)
    np.testing.assert_array_equal(here.faces, there.faces)
    np.testing.assert_array_equal(colours_of(glb), there.visual.vertex_colors)


def test_normals_are_those_of_a_torus(torus: Any) -> None:
    """The normal of a torus points away from the middle of its tube."""
    points = torus.vertices
    middle = points * (1.0, 1.0, 0.0)
    middle *= 3.0 / np.linalg.norm(middle, axis=1, keepdims=True)
    normals = Topology.of(torus.faces, len(points)).normals(points)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-5)
    # Facets of 1.8 degrees along and 3.6 degrees around the tube.
    assert ((points - middle) * normals).sum(axis=1).min() > np.cos(np.radians(1.8))


def test_a_vertex_without_triangles_has_no_normal() -> None:
    """Zero, and no warning of a division."""
    topology = Topology.of(np.array([[0, 1, 2]]), 4)
    normals = topology.normals(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5]]))
    np.testing.assert_array_equal(normals, [[0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 0, 0]])


@pytest.mark.parametrize(("vertices", "bytes_each"), [(MOST_SHORT, 2), (MOST_SHORT + 1, 4)])
def test_long_meshes_have_long_indices(vertices: int, bytes_each: int) -> None:
    """Up to 65 535 vertices are named by 16 bits; the file says which, and how long it is."""
    topology = Topology.of(np.array([[0, 1, vertices - 1]]), vertices)
    points = np.zeros((vertices, 3))
    glb = write_glb(points, np.zeros((vertices, 3), np.uint8), topology, both_sides=False)
    magic, version, length, size = struct.unpack("<4sIII", glb[:16])
    assert (magic, version, length) == (b"glTF", 2, len(glb))
    tree = json.loads(glb[20 : 20 + size])
    assert tree["bufferViews"][3]["byteLength"] == 3 * bytes_each
    assert tree["accessors"][3]["componentType"] == {2: 5123, 4: 5125}[bytes_each]
    assert all(view["byteOffset"] % 4 == 0 for view in tree["bufferViews"])


def test_a_mesh_that_is_cut_away_is_still_a_file(torus: Any) -> None:
    """A plane that leaves nothing gives a triangle without an area."""
    plane = Plane(axis=Axis.X, position_mm=-100.0)
    colours = np.zeros(torus.vertices.shape, np.uint8)
    assert read(coloured_glb(torus.vertices, torus.faces, colours, plane)).area == 0.0


@pytest.mark.parametrize("plane", [None, Plane(axis=Axis.X, position_mm=0.0)])
def test_the_back_is_drawn_where_a_skin_is_cut(torus: Any, plane: Plane | None) -> None:
    """A closed skin shows its front alone, and costs half as much to draw."""
    glb = coloured_glb(torus.vertices, torus.faces, np.zeros(torus.vertices.shape, np.uint8), plane)
    tree = json.loads(glb[20 : 20 + struct.unpack("<I", glb[12:16])[0]])
    assert tree["materials"][0]["doubleSided"] is (plane is not None)
