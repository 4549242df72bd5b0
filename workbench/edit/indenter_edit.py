"""Changes of an object one at a time, as widgets make them, and the gallery they choose from."""

from __future__ import annotations

import dataclasses

from workbench.core.base.errors import DesignError
from workbench.core.design.design import SensorDesign
from workbench.core.design.imported import IMPORTED, ImportedBody, body_file
from workbench.core.objects.kind import Group, kind_of
from workbench.core.press.indenter import (
    DEFAULT_EDGE_RADIUS_MM,
    OF_TRIANGLES,
    Indenter,
    IndenterKind,
    widest_edge_mm,
)
from workbench.core.press.press_case import PressCase
from workbench.core.press.texture import Pattern, Texture
from workbench.edit.indenter_choice import (
    MOST_PICTURE_BYTES,
    SMALLER_PICTURE,
    choose_indenter,
    load_heights,
    of_mesh,
)
from workbench.pipeline.store import Store
from workbench.planning.plan import plan
from workbench.system.uploads import MOST_BYTES, check_upload, own_name, uploaded_file
from workbench.view.object_words import heading, object_words

AT = "indenter"
SMALLER_MESH = "reduce the mesh, or use workbench run --indenter FILE"

SAFE = 1.0 / 1.01
"""Share of the largest edge radius that a shrunk object takes."""


def gallery() -> dict[str, str]:
    """Names of all objects by their words: the paper's by group, then the others."""
    from geometry.objects.everyday import EVERYDAY

    found = {
        object_words(kind.value, kind_of(kind)): kind.value
        for group in Group
        for kind in IndenterKind
        if kind_of(kind).group is group and kind is not OF_TRIANGLES
    }
    return {**found, **{object_words(name): name for name in EVERYDAY}}


def gallery_heading(name: str) -> str:
    """Under which an object of the gallery stands."""
    return heading(kind_of(name) if name in set(IndenterKind) else None)


def another(name: str, now: Indenter) -> Indenter:
    """An object of the gallery with the texture and softness of this one.

    Also with its size, where both are shapes that any size does for.

    Raises:
        DesignError: If the texture does not fit it.
    """
    sized = {kind.value for kind in IndenterKind if kind_of(kind).own_mm is None}
    keeps = name in sized and now.kind in sized and now.mesh is None
    size_mm = now.size_mm if keeps else None
    chosen = choose_indenter(name, size_mm=size_mm, texture=now.texture)
    return dataclasses.replace(chosen, soft=now.soft)


def resized(indenter: Indenter, size_mm: float) -> Indenter:
    """The same object of another size; its edge radius shrinks with it where it must.

    Raises:
        DesignError: If the size is refused.
    """
    from geometry.objects.indenters import scaled

    if indenter.mesh is not None:
        rounding_mm = min(indenter.mesh_rounding_mm, SAFE * size_mm / 4)
        mesh = scaled(indenter.mesh, size_mm)
        return dataclasses.replace(
            indenter, size_mm=size_mm, mesh=mesh, mesh_rounding_mm=rounding_mm
        )
    edge_mm = indenter.edge_radius_mm
    widest = widest_edge_mm(indenter.kind, size_mm)
    if widest is not None:
        edge_mm = min(edge_mm, widest)
    return dataclasses.replace(indenter, size_mm=size_mm, edge_radius_mm=edge_mm)


def edge_mm(indenter: Indenter) -> float:
    """Its rounding [mm]: of a mesh that of its convex edges, 0 for what has no edges."""
    if indenter.mesh is not None:
        return indenter.mesh_rounding_mm
    return 0.0 if indenter.record.edge_share is None else indenter.edge_radius_mm


def rounded(indenter: Indenter, radius_mm: float) -> Indenter:
    """The same object with other edges.

    Raises:
        DesignError: If it has no edges, or the radius does not fit it.
    """
    if indenter.mesh is not None:
        return dataclasses.replace(indenter, mesh_rounding_mm=radius_mm)
    if indenter.record.edge_share is None:
        raise DesignError(
            f"a {object_words(indenter.kind.value)} has no edges to round",
            hint=f"the radius is for objects with edges; {DEFAULT_EDGE_RADIUS_MM:g} mm is usual",
            at="indenter.edge_radius_mm",
        )
    return dataclasses.replace(indenter, edge_radius_mm=radius_mm)


def textured(indenter: Indenter, texture: Texture) -> Indenter:
    """The same object with another texture.

    Raises:
        DesignError: If the texture is too high for it.
    """
    return dataclasses.replace(indenter, texture=texture)


def pictured(indenter: Indenter, name: str, content: bytes) -> Indenter:
    """The same object with an uploaded picture as its texture.

    Raises:
        DesignError: If the picture is too large or cannot be read.
    """
    limit, at = MOST_PICTURE_BYTES, "indenter.texture.image"
    with uploaded_file(name, content, limit_bytes=limit, hint=SMALLER_PICTURE, at=at) as path:
        image = load_heights(path)
    texture = indenter.texture
    width_mm = max(texture.pitch_mm, indenter.size_mm)
    shown = Texture(
        pattern=Pattern.IMAGE, image=image, height_mm=texture.height_mm, pitch_mm=width_mm
    )
    return textured(indenter, shown)


def uploaded(name: str, content: bytes) -> Indenter:
    """An uploaded STL or OBJ file as an object, in its own size in mm.

    Raises:
        DesignError: If it is too large or no usable closed mesh.
    """
    limit = MOST_BYTES
    with uploaded_file(name, content, limit_bytes=limit, hint=SMALLER_MESH, at=AT) as path:
        return choose_indenter(str(path))


def needs_cad(name: str) -> bool:
    """Whether a file can only be read by the CAD kernel, which belongs in a worker."""
    return name.lower().endswith((".step", ".stp"))


def cad_trial(name: str, content: bytes) -> SensorDesign:
    """A design whose stage `intake` reads an uploaded STEP file; see `cad_object`.

    Raises:
        DesignError: If the file is too large.
    """
    check_upload(name, content, limit_bytes=MOST_BYTES, hint=SMALLER_MESH, at=AT)
    file = body_file(own_name(name), content)
    return SensorDesign(name="object", family=IMPORTED, body=ImportedBody(outer=file))


def cad_object(trial: SensorDesign, store: Store) -> Indenter:
    """The object that the worker read for a `cad_trial`, in its own size in mm.

    Raises:
        DesignError: If it encloses nothing, or its size is refused.
    """
    from geometry.objects.indenters import mesh_of_body

    call = plan(trial, PressCase())["intake"]
    name = trial.body.outer.name if trial.body is not None else ""
    return of_mesh(mesh_of_body(store.load(call.stage, call.key), name))
