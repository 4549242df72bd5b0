"""An indenter as a table of a design file; its arrays are kept beside the designs by their hash.

A mesh and the picture of a texture are too large for TOML. The project keeps each under
`indenters/`, so that a restart finds the same results.
"""

from __future__ import annotations

import dataclasses
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import from_table, to_table
from workbench.core.press.indenter import OF_TRIANGLES, Indenter, IndenterMesh
from workbench.core.press.soft_body import SoftBody
from workbench.core.press.texture import HeightImage, Pattern, Texture
from workbench.project.project import Project
from workbench.system.array_files import read_arrays
from workbench.system.whole_files import write_atomically

AT = "press_case.indenter"


def indenter_table(indenter: Indenter, project: Project) -> dict[str, Any]:
    """The table; arrays are written where they are not yet kept.

    Raises:
        StoreError: If an array cannot be written.
    """
    plain = {f.name: getattr(indenter, f.name) for f in dataclasses.fields(indenter)}
    mesh, texture = plain.pop("mesh"), plain.pop("texture")
    table: dict[str, Any] = to_table({n: v for n, v in plain.items() if v is not None})
    if mesh is not None:
        table["mesh_key"] = _keep(project, mesh, points_mm=mesh.points_mm, faces=mesh.faces)
    if texture.raised:
        fields = {f.name: getattr(texture, f.name) for f in dataclasses.fields(texture)}
        image = fields.pop("image")
        table["texture"] = to_table(fields)
        if image is not None:
            table["image_key"] = _keep(project, image, heights=image.heights)
    return table


def read_indenter(table: Any, project: Project) -> Indenter:
    """The indenter of a table.

    Raises:
        DesignError: If the table is not valid, or names an array this project does not have.
    """
    if not isinstance(table, Mapping):
        return from_table(Indenter, table, at=AT)
    plain = {str(name): value for name, value in table.items()}
    mesh_key, image_key = plain.pop("mesh_key", None), plain.pop("image_key", None)
    texture = plain.pop("texture", {}) if image_key is not None else {}
    if mesh_key is None:
        found = from_table(Indenter, plain, at=AT)
    else:
        found = _of_mesh(_kept(project, mesh_key, IndenterMesh), plain)
    if image_key is None:
        return found
    if not isinstance(texture, Mapping):
        return from_table(Texture, texture, at=f"{AT}.texture")
    image = _kept(project, image_key, HeightImage)
    sizes = {name: texture[name] for name in ("height_mm", "pitch_mm") if name in texture}
    pictured = Texture(pattern=Pattern.IMAGE, image=image, **sizes)
    return dataclasses.replace(found, texture=pictured)


def kept_arrays(table: Mapping[str, Any], project: Project) -> dict[str, bytes]:
    """The files that an indenter's table names, by path relative to the project's folder.

    Raises:
        DesignError: If one is gone.
    """
    keys = [str(table[name]) for name in ("mesh_key", "image_key") if name in table]
    files = {}
    for key in keys:
        path = _path(project, key)
        try:
            files[f"{path.parent.name}/{path.name}"] = path.read_bytes()
        except OSError as error:
            raise DesignError(
                f"a file of this press's indenter is gone: {error}", hint="load it again", at=AT
            ) from error
    return files


def _of_mesh(mesh: IndenterMesh, plain: Mapping[str, Any]) -> Indenter:
    """An indenter of triangles with the fields of a table that such a one has."""
    sizes = ("size_mm", "edge_radius_mm", "mesh_rounding_mm")
    numbers = {name: plain[name] for name in sizes if name in plain}
    if "turn_deg" in plain:
        turned = from_table(Indenter, {"turn_deg": plain["turn_deg"]}, at=AT)
        numbers["turn_deg"] = turned.turn_deg
    parts = {
        name: from_table(kind, plain[name], at=f"{AT}.{name}")
        for name, kind in (("texture", Texture), ("soft", SoftBody))
        if name in plain
    }
    return Indenter(kind=OF_TRIANGLES, mesh=mesh, **numbers, **parts)


def _keep(project: Project, value: Any, **arrays: np.ndarray) -> str:
    key = digest(value)
    path = _path(project, key)
    if not path.exists():
        buffer = io.BytesIO()
        np.savez_compressed(buffer, allow_pickle=False, **arrays)
        write_atomically(path, buffer.getvalue())
    return key


def _kept(project: Project, key: Any, kind: type[Any]) -> Any:
    """A mesh or a picture of the project; a file that was cut short is as good as none."""
    path = _path(project, str(key))
    try:
        arrays: dict[str, Any] = {**read_arrays(path.name, path.read_bytes())}
        if kind is IndenterMesh:
            _check_faces(**arrays)
        return kind(**arrays)
    except (OSError, TypeError, ValueError) as error:
        raise DesignError(
            f"the mesh or picture of this press's indenter is not in the project: {error}",
            hint="load the file again",
            at=AT,
        ) from error


def _check_faces(*, points_mm: np.ndarray, faces: np.ndarray) -> None:
    """Refuse triangles between points that there are not.

    Raises:
        ValueError: If the numbers are not whole, or a corner is none of the points.
    """
    if faces.dtype.kind not in "iu" or not np.isfinite(points_mm).all():
        raise ValueError("its triangles are not made of points")
    if faces.size and not (0 <= faces.min() and faces.max() < len(points_mm)):
        raise ValueError("a triangle has a corner that is none of its points")


def _path(project: Project, key: str) -> Path:
    if not key.isalnum():
        raise DesignError(f"{shown(key)} is not the key of a mesh", hint="load it again", at=AT)
    return project.folder / "indenters" / f"{key}.npz"
