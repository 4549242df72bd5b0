"""B-rep bodies to labelled, watertight triangle surfaces, and to bytes and back.

OCCT tessellates each face on its own along shared edge polygons, so welding equal vertices closes
the surface. A face's region is found by probing a hair outside its largest triangle: inside the
core means inner; all of it on z = 0 means base; else outer.
"""

# OCP has no type stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import io
import itertools
from typing import Any, NamedTuple

import numpy as np

from geometry.surface.regions import mark_regions
from geometry.surface.surface import face_areas, mesh_volume, open_edges
from workbench.core.base.booleans import volume
from workbench.core.base.errors import GeometryError, MeshingError
from workbench.core.result.results import Label, LabelledSurface, Solid

TOLERANCE_MM = 0.02
ANGLE_RAD = 0.1
COARSE_TOLERANCE_MM = 0.02
COARSE_ANGLE_RAD = 0.25
"""Support and foot are never touched, but printed: chords may cost a thin shell 0.3 %."""
WELD_MM = 1e-5
"""Vertices nearer than this are one [mm]; the kernel's own tolerance is 1e-7."""
PROBE_MM = 0.02
"""Distance outside a face at which its region is probed [mm]."""
FLAT_MM = 1e-6
"""Height below which a vertex lies on the base plane [mm]."""


class Tessellation(NamedTuple):
    """A welded surface whose triangles know the B-rep face they came from."""

    points_mm: np.ndarray
    """Vertices [mm], shape (N, 3)."""
    faces: np.ndarray
    """Triangles, shape (M, 3), int32, counter-clockwise from outside."""
    patch: np.ndarray
    """Number of the B-rep face, shape (M,), int32."""


def assemble(bodies: Any, *, fineness: float = 1.0) -> Solid:
    """Turn the B-rep bodies of a family into arrays.

    Args:
        bodies: `membrane`, `outer`, `core`, `support`, `base` and `marks`, duck-typed: who builds
            them, `designs`, stands above this package.
        fineness: How many times finer than `TOLERANCE_MM` the elastomer is tessellated.

    Raises:
        MeshingError: If a surface is not watertight, or a marked region is empty.
    """
    coarse = {"tolerance_mm": COARSE_TOLERANCE_MM, "angle_rad": COARSE_ANGLE_RAD}
    # A chord's distance from its arc goes with the square of its angle.
    fine = {"tolerance_mm": TOLERANCE_MM / fineness, "angle_rad": ANGLE_RAD / fineness**0.5}
    return Solid(
        membrane=mark_regions(
            label_surface(bodies.membrane, bodies.core, **fine), bodies.marks.regions
        ),
        support=label_surface(bodies.support, bodies.core, **coarse),
        base=label_surface(bodies.base, None, **coarse),
        outer_brep=brep_bytes(bodies.outer),
        core_brep=brep_bytes(bodies.core),
        membrane_brep=brep_bytes(bodies.membrane),
        support_brep=brep_bytes(bodies.support),
        base_brep=brep_bytes(bodies.base),
        volume_mm3=volume(bodies.membrane),
        tips_mm=np.asarray(bodies.marks.tips_mm, dtype=np.float64).reshape(-1, 3),
        tip_radius_mm=bodies.marks.tip_radius_mm,
        backing_mm=bodies.marks.backing_mm,
    )


def label_surface(
    part: Any, core: Any, *, tolerance_mm: float = TOLERANCE_MM, angle_rad: float = ANGLE_RAD
) -> LabelledSurface:
    """Tessellate a body and label its faces outer, inner or base.

    Args:
        part: build123d body.
        core: Body whose inside makes a face inner, or None.
        tolerance_mm: Largest distance of a chord from the true surface.
        angle_rad: Largest angle between neighbouring chords.

    Raises:
        MeshingError: If the surface is not watertight or is inside out.
    """
    tessellation = tessellate(part, tolerance_mm=tolerance_mm, angle_rad=angle_rad)
    points, faces, patch = tessellation
    labels = np.full(int(patch.max()) + 1, Label.OUTER, dtype=np.uint8)
    areas = face_areas(points, faces)
    inside = _classifier(core)
    for number in np.unique(patch):
        members = np.flatnonzero(patch == number)
        # Inner before base: a pad's bonded face may lie in a plane that others call their base.
        if inside(_probe(points[faces[members[np.argmax(areas[members])]]], tolerance_mm)):
            labels[number] = Label.INNER
        elif np.abs(points[faces[members], 2]).max() < FLAT_MM:
            labels[number] = Label.BASE
    return LabelledSurface(points_mm=points, faces=faces, labels=labels[patch])


def tessellate(
    part: Any, *, tolerance_mm: float = TOLERANCE_MM, angle_rad: float = ANGLE_RAD
) -> Tessellation:
    """Closed triangle surface of a B-rep body.

    Raises:
        MeshingError: If it is not watertight or is inside out.
    """
    tessellation = weld(
        *loose_triangles(part.wrapped, tolerance_mm=tolerance_mm, angle_rad=angle_rad)
    )
    gaps = open_edges(tessellation.faces)
    if gaps:
        raise MeshingError(
            f"the tessellated surface has {gaps} open edges",
            hint="change the last shape parameter a little",
            at="shape",
        )
    volume_mm3 = mesh_volume(tessellation.points_mm, tessellation.faces)
    if volume_mm3 <= 0.0:
        raise MeshingError(
            f"the tessellated surface is inside out: volume {volume_mm3:.4g} mm3",
            hint="change the last shape parameter a little",
            at="shape",
        )
    return tessellation


def loose_triangles(shape: Any, *, tolerance_mm: float, angle_rad: float) -> Tessellation:
    """Triangles of a shape of OCCT, face by face, each with vertices of its own.

    Raises:
        MeshingError: If the kernel made none.
    """
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    BRepMesh_IncrementalMesh(shape, tolerance_mm, False, angle_rad, True)
    explorer = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE)
    # Two faces that differ in nothing but the way they are reached have one hash.
    found: dict[int, Any] = {}
    while explorer.More():
        found[hash(explorer.Current())] = explorer.Current()
        explorer.Next()
    points, faces, patches, offset = [], [], [], 0
    for number, face in enumerate(found.values()):
        arrays = _face_arrays(face)
        if arrays is None:
            # The surface stays open there, as whoever welds it finds.
            continue
        points.append(arrays[0])
        faces.append(arrays[1] + offset)
        patches.append(np.full(len(arrays[1]), number, dtype=np.int32))
        offset += len(arrays[0])
    if not points:
        raise MeshingError(
            "the CAD kernel made no triangles",
            hint="change the last shape parameter a little",
            at="shape",
        )
    return Tessellation(np.concatenate(points), np.concatenate(faces), np.concatenate(patches))


def weld(points_mm: np.ndarray, faces: np.ndarray, patch: np.ndarray) -> Tessellation:
    """Merge vertices nearer than `WELD_MM` and drop triangles that collapse."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    count = len(points_mm)
    pairs = KDTree(points_mm).query_pairs(WELD_MM, output_type="ndarray")
    links = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), (count, count))
    group = connected_components(links, directed=False)[1]
    kept, first = np.unique(group, return_index=True)
    renumbered = group[faces]
    proper = np.all(renumbered != np.roll(renumbered, 1, axis=1), axis=1)
    used, compact = np.unique(renumbered[proper], return_inverse=True)
    return Tessellation(
        points_mm=points_mm[first[np.searchsorted(kept, used)]],
        faces=compact.reshape(-1, 3).astype(np.int32),
        patch=patch[proper],
    )


def brep_bytes(part: Any) -> np.ndarray:
    """A B-rep body as OCCT text without triangles, shape (bytes,), uint8."""
    from OCP.BRepTools import BRepTools
    from OCP.TopTools import TopTools_FormatVersion

    stream = io.BytesIO()
    version = TopTools_FormatVersion.TopTools_FormatVersion_VERSION_1
    # Without its triangles: they are large, and whether a body was looked at must not change it.
    BRepTools.Write_s(part.wrapped, stream, False, False, version)
    return np.frombuffer(stream.getvalue(), dtype=np.uint8).copy()


def part_from_brep(array: np.ndarray) -> Any:
    """The build123d body of bytes made by `brep_bytes`.

    Raises:
        GeometryError: If the bytes are no B-rep.
    """
    from build123d.topology import Shape
    from OCP.BRep import BRep_Builder
    from OCP.BRepTools import BRepTools
    from OCP.TopoDS import TopoDS_Shape

    shape = TopoDS_Shape()
    BRepTools.Read_s(shape, io.BytesIO(array.tobytes()), BRep_Builder())
    if shape.IsNull():
        raise GeometryError(
            f"{array.size} bytes are not a B-rep body", hint="build the sensor again", at="shape"
        )
    return Shape.cast(shape)


def _face_arrays(face: Any) -> tuple[np.ndarray, np.ndarray] | None:
    """Vertices and outward triangles of one tessellated B-rep face; None if it has none."""
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_Orientation
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS

    location = TopLoc_Location()
    mesh = BRep_Tool.Triangulation_s(TopoDS.Face(face), location)
    if mesh is None:
        return None
    # Flat iterators: a list of 50,000 tuples costs twice as much, most of it garbage collection.
    nodes = itertools.chain.from_iterable(
        mesh.Node(i).Coord() for i in range(1, mesh.NbNodes() + 1)
    )
    points = np.fromiter(nodes, np.float64).reshape(-1, 3)
    corners = itertools.chain.from_iterable(
        mesh.Triangle(i).Get() for i in range(1, mesh.NbTriangles() + 1)
    )
    triangles = np.fromiter(corners, np.int64).reshape(-1, 3) - 1
    if not location.IsIdentity():
        move = location.Transformation()
        matrix = np.array([[move.Value(r, c) for c in range(1, 5)] for r in range(1, 4)])
        points = points @ matrix[:, :3].T + matrix[:, 3]
    if face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
        triangles = triangles[:, ::-1]
    return points, triangles


def _probe(corners: np.ndarray, tolerance_mm: float) -> np.ndarray:
    """A point surely outside a triangle's true surface, which may bulge by the tolerance."""
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    return corners.mean(axis=0) + (PROBE_MM + tolerance_mm) * normal / np.linalg.norm(normal)


def _classifier(core: Any) -> Any:
    """A function telling whether a point lies inside the core; never, when there is none."""
    if core is None:
        return lambda point: False
    from OCP.BRepClass3d import BRepClass3d_SolidClassifier
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_State

    solid = BRepClass3d_SolidClassifier(core.wrapped)
    box = core.bounding_box(optimal=False)
    low, high = np.array(tuple(box.min)), np.array(tuple(box.max))

    def inside(point: np.ndarray) -> bool:
        # A spline body takes 20 ms to say no.
        if np.any(point < low) or np.any(point > high):
            return False
        solid.Perform(gp_Pnt(*point.tolist()), 1e-7)
        return solid.State() == TopAbs_State.TopAbs_IN

    return inside
