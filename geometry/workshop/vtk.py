"""VTK files for other tools: ParaView, PyVista, meshio and the solvers that read them.

`.vtu` holds cells of a volume, `.vtp` triangles, `.pvd` the list of a series. The XML formats of
the VTK file format description (Kitware, VTK File Formats, 2010), with arrays in base64 behind
zlib and 32-bit node numbers, so that they need nothing beside them. Coordinates are in mm in the
sensor frame, undeformed; arrays keep their type and carry their unit in their name. Every mesh has
`labels` (the bits of `Label`), `numbers` (of actuator or pin, else -1) and, because few tools
select by bit, one array of 0 and 1 for each region: OUTER, INNER, BASE, ACTUATOR, PIN, BACKED.

Leaves out: the material points and the images.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from geometry.surface.stress import von_mises_MPa
from geometry.surface.transfer import node_regions
from geometry.volume.skins import region_skin
from workbench.core.result.force_field import ForceField
from workbench.core.result.results import Label, LabelledSurface, MembraneMesh, Skin, VolumeMesh
from workbench.core.result.sensing import Contact


def volume_file(mesh: VolumeMesh) -> bytes:
    """Hexahedra or tetrahedra as a `.vtu` file.

    Regions are given at the nodes, the scaled Jacobian `quality` at the cells.
    """
    import pyvista

    kind = {8: pyvista.CellType.HEXAHEDRON, 4: pyvista.CellType.TETRA}[mesh.cells.shape[1]]
    # A copy: stored arrays are mapped read-only, and VTK keeps a pointer to what it is given.
    grid: Any = pyvista.UnstructuredGrid({kind: np.array(mesh.cells)}, np.array(mesh.points_mm))
    _put(grid.point_data, _region_arrays(mesh.labels, mesh.numbers))
    grid.cell_data["quality"] = np.array(mesh.quality)
    return _xml(grid)


def membrane_file(mesh: MembraneMesh, membrane: LabelledSurface) -> bytes:
    """The whole surface of the elastomer as a `.vtp` file.

    The even triangles of the outer and the inner skin, in this order, then the faces on the base
    as the body has them; the three share no vertices. Seen from outside the elastomer triangles
    are counter-clockwise. Regions are given at the faces and at the vertices.
    """
    parts = [mesh.outer, _turned(mesh.inner)]
    # A body that is bonded all around its rim has no face on the base.
    if membrane.has(Label.BASE).any():
        parts.append(region_skin(membrane, Label.BASE))
    return _xml(_joined(parts))


def contact_files(
    mesh: MembraneMesh,
    contact: Contact | ForceField,
    depth_mm: Sequence[float],
    *,
    name: str = "contact",
) -> dict[str, bytes]:
    """A press as `contact_000.vtp` ..., one for each frame, and `contact.pvd`, which lists them.

    Vertices are those of the outer skin in the order of the result, then, where it moves, those of
    the inner one. They stand where they were: the file's `displacement_mm` moves them.
    Stress, energy and all of contact are those of the outer skin, 0 on the inner one;
    `cauchy_MPa` has xx, yy, zz, xy, yz, zx, the order in which VTK reads a symmetric tensor.

    Args:
        mesh: The membrane on whose skins the result is.
        contact: The press by the contact solver or another source of forces; what a source does
            not know is left out.
        depth_mm: Depth of each frame from first touch [mm], shape (K,).
        name: First part of the files' names.
    """
    moving = [mesh.outer]
    if contact.inner_mm.shape[1]:
        moving.append(_turned(mesh.inner))
    surface = _joined(moving)
    files = {}
    for number, depth in enumerate(depth_mm):
        _put(surface.point_data, _frame_arrays(mesh, contact, number))
        _put(surface.field_data, _frame_numbers(contact, number, depth))
        files[f"{name}_{number:03d}.vtp"] = _xml(surface)
    files[f"{name}.pvd"] = _series(list(files))
    return files


def _frame_arrays(
    mesh: MembraneMesh, contact: Contact | ForceField, frame: int
) -> dict[str, np.ndarray]:
    moved = contact.displacement_mm[frame]
    if contact.inner_mm.shape[1]:
        moved = np.concatenate([moved, contact.inner_mm[frame]])
    behind = len(moved) - len(mesh.outer.points_mm)
    # What touches and strains is known on the outer skin; nothing touches the inner one.
    padded = {
        name: np.pad(values, ((0, behind), *[(0, 0)] * (values.ndim - 1)))
        for name, values in _skin_arrays(contact, frame).items()
    }
    return {"displacement_mm": np.array(moved), **padded}


def _skin_arrays(contact: Contact | ForceField, frame: int) -> dict[str, np.ndarray]:
    """What a frame says at the outer vertices; some methods and sources know only some of it."""
    names = ("contact_force_N", "pressure_MPa", "cauchy_MPa", "energy_MPa", "slip_mm")
    known = [name for name in names if len(getattr(contact, name))]
    found = {name: getattr(contact, name)[frame] for name in known}
    if "cauchy_MPa" in found:
        found["von_mises_MPa"] = von_mises_MPa(found["cauchy_MPa"])
    if len(contact.sliding):
        found["sliding"] = contact.sliding[frame].astype(np.uint8)
    return found


def _frame_numbers(
    contact: Contact | ForceField, frame: int, depth_mm: float
) -> dict[str, np.ndarray]:
    known = {}
    if contact.actuator_N.size:
        known["actuator_N"] = np.array(contact.actuator_N[frame])
    if len(contact.moment_Nmm):
        known["moment_Nmm"] = np.array(contact.moment_Nmm[frame])[None]
    if np.isfinite(contact.residual[frame]):
        known["residual"] = np.array(contact.residual[frame], dtype=np.float64)[None]
    return {
        **known,
        "depth_mm": np.array([depth_mm], dtype=np.float64),
        "reaction_N": np.array(contact.reaction_N[frame])[None],
        "normal_N": np.array(contact.normal_N[frame])[None],
        "indenter_pose": np.array(contact.indenter_pose[frame])[None],
    }


def _series(names: Sequence[str]) -> bytes:
    """A ParaView data file: the frames with their numbers as times."""
    rows = "".join(
        f'<DataSet timestep="{number}" part="0" file="{name}"/>\n'
        for number, name in enumerate(names)
    )
    return (
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>\n'
        f"{rows}</Collection>\n</VTKFile>\n"
    ).encode()


def _turned(skin: Skin) -> Skin:
    """The skin seen from its other side."""
    return Skin(
        points_mm=skin.points_mm,
        faces=skin.faces[:, ::-1],
        normals=-skin.normals,
        labels=skin.labels,
        numbers=skin.numbers,
    )


def _joined(skins: Sequence[Skin]) -> Any:
    """Several skins as one surface with the regions of its faces and vertices."""
    import pyvista

    sizes = [len(skin.points_mm) for skin in skins]
    starts = np.cumsum([0, *sizes[:-1]])
    points = np.concatenate([skin.points_mm for skin in skins])
    faces = np.concatenate([s.faces + start for s, start in zip(skins, starts, strict=True)])
    labels = np.concatenate([skin.labels for skin in skins])
    numbers = np.concatenate([skin.numbers for skin in skins])
    surface: Any = pyvista.PolyData.from_regular_faces(points, faces)
    _put(surface.cell_data, _region_arrays(labels, numbers))
    _put(surface.point_data, _region_arrays(*node_regions(len(points), faces, labels, numbers)))
    return surface


def _region_arrays(labels: np.ndarray, numbers: np.ndarray) -> dict[str, np.ndarray]:
    bits = {str(flag.name): ((labels & flag) != 0).astype(np.uint8) for flag in Label}
    return {"labels": np.array(labels), "numbers": np.array(numbers), **bits}


def _put(data: Any, arrays: Mapping[str, np.ndarray]) -> None:
    for name, values in arrays.items():
        data[name] = values


def _xml(dataset: Any) -> bytes:
    """The dataset as its XML file."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

    surface = dataset.IsA("vtkPolyData")
    writer = vtkXMLPolyDataWriter() if surface else vtkXMLUnstructuredGridWriter()
    writer.SetInputData(dataset)
    # Base64 within the element is the form that every reader knows.
    writer.SetDataModeToBinary()
    writer.SetHeaderTypeToUInt64()
    writer.SetIdTypeToInt32()
    writer.WriteToOutputStringOn()
    writer.Write()
    return writer.GetOutputString().encode()
