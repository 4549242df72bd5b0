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

from workbench.core.digest import digest
from workbench.core.errors import DesignError
from workbench.core.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.core.mapping import from_table, to_table
from workbench.core.soft_body import SoftBody
from workbench.core.texture import HeightImage, Pattern, Texture
from workbench.project import Project, write_atomically

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
    if image_key is not None:
        plain.pop("texture", None)
    if mesh_key is None:
        found = from_table(Indenter, plain, at=AT)
    else:
        arrays = _kept(project, mesh_key, ("points_mm", "faces"))
        mesh = IndenterMesh(points_mm=arrays["points_mm"], faces=arrays["faces"])
        numbers = {
            n: plain[n] for n in ("size_mm", "edge_radius_mm", "mesh_rounding_mm") if n in plain
        }
        found = Indenter(kind=IndenterKind.MESH, mesh=mesh, **numbers)
        if "texture" in plain:
            texture = from_table(Texture, plain["texture"], at=f"{AT}.texture")
            found = dataclasses.replace(found, texture=texture)
        if "soft" in plain:
            soft = from_table(SoftBody, plain["soft"], at=f"{AT}.soft")
            found = dataclasses.replace(found, soft=soft)
    if image_key is None:
        return found
    sizes = {n: v for n, v in dict(table.get("texture", {})).items() if n.endswith("_mm")}
    image = HeightImage(heights=_kept(project, image_key, ("heights",))["heights"])
    texture = Texture(pattern=Pattern.IMAGE, image=image, **sizes)
    return dataclasses.replace(found, texture=texture)


def _keep(project: Project, value: Any, **arrays: np.ndarray) -> str:
    key = digest(value)
    path = _path(project, key)
    if not path.exists():
        buffer = io.BytesIO()
        np.savez_compressed(buffer, allow_pickle=False, **arrays)
        write_atomically(path, buffer.getvalue())
    return key


def _kept(project: Project, key: Any, names: tuple[str, ...]) -> dict[str, np.ndarray]:
    path = _path(project, str(key))
    try:
        with np.load(path) as arrays:
            return {name: arrays[name] for name in names}
    except (OSError, KeyError, ValueError) as error:
        raise DesignError(
            f"the mesh or picture of this press's indenter is not in the project: {error}",
            hint="load the file again",
            at=AT,
        ) from error


def _path(project: Project, key: str) -> Path:
    if not key.isalnum():
        raise DesignError(f"{key!r} is not the key of a mesh", hint="load it again", at="mesh")
    return project.folder / "indenters" / f"{key}.npz"
