"""The VTK files of a run or an export: mesh, membrane, and the press frame by frame."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from workbench.core.result.results import MembraneMesh, Solid, VolumeMesh
from workbench.core.result.sensing import Contact
from workbench.system.folder import remove_stale
from workbench.system.whole_files import write_atomically

PATTERNS = ("mesh.vtu", "membrane.vtp", "contact_*.vtp", "contact.pvd")


def write_vtk(
    out: Path,
    solid: Solid,
    mesh: MembraneMesh,
    *,
    tets: VolumeMesh | None = None,
    contact: Contact | None = None,
    depth_mm: Sequence[float] = (),
) -> list[str]:
    """Write `mesh.vtu`, `membrane.vtp` and, of a press, `contact_000.vtp` ... and `contact.pvd`.

    Such files of an earlier run that this one does not replace go.

    Args:
        tets: What `mesh.vtu` holds where there are no hexahedra; without either it is not written.
        depth_mm: Depth of each frame of the contact [mm], shape (K,).

    Returns:
        Names of the files written.

    Raises:
        StoreError: If the folder cannot be written.
    """
    from geometry.workshop.vtk import contact_files

    files = vtk_files(solid, mesh, tets=tets)
    if contact is not None:
        files |= contact_files(mesh, contact, depth_mm)
    remove_stale(out, PATTERNS, keep=files)
    for name, content in files.items():
        write_atomically(out / name, content)
    return list(files)


def vtk_files(
    solid: Solid, mesh: MembraneMesh, *, tets: VolumeMesh | None = None
) -> dict[str, bytes]:
    """`mesh.vtu`, where there are cells, and `membrane.vtp`, by their names."""
    from geometry.workshop.vtk import membrane_file, volume_file

    volume = tets if mesh.hexes is None else mesh.hexes
    files = {} if volume is None else {"mesh.vtu": volume_file(volume)}
    return {**files, "membrane.vtp": membrane_file(mesh, solid.membrane)}
