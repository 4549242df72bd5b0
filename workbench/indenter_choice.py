"""An indenter by name or by STL file, as the command line and the browser choose it."""

from __future__ import annotations

from pathlib import Path

from workbench.core.errors import DesignError
from workbench.core.indenter import DEFAULT_EDGE_RADIUS_MM, DEFAULT_SIZE_MM, Indenter, IndenterKind
from workbench.core.mapping import suggest

ALIASES = {"cylinder": "cylinder_end", "cylinder-end": "cylinder_end"} | {
    "cylinder-side": "cylinder_side"
}


def choose_indenter(
    name: str, *, size_mm: float | None = None, edge_radius_mm: float | None = None
) -> Indenter:
    """A primitive by name, or the closed mesh of an STL file scaled to `size_mm`.

    Without a size a primitive has 6 mm, and a file its own size in mm. The edge radius shrinks
    with small primitives so that the default always fits.

    Raises:
        DesignError: If the name is unknown or the file is not a usable closed mesh.
    """
    kind = ALIASES.get(name, name)
    primitives = [k.value for k in IndenterKind if k is not IndenterKind.MESH]
    if kind in primitives:
        size = DEFAULT_SIZE_MM if size_mm is None else size_mm
        if kind == IndenterKind.SPHERE:
            # It has no edge; a value here would only split one press into two keys.
            return Indenter(kind=IndenterKind.SPHERE, size_mm=size)
        edge = min(DEFAULT_EDGE_RADIUS_MM, size / 4) if edge_radius_mm is None else edge_radius_mm
        return Indenter(kind=IndenterKind(kind), size_mm=size, edge_radius_mm=max(edge, 0.0))
    if name.lower().endswith(".stl") or Path(name).exists():
        from geometry.indenters import largest_width, load_stl, scaled

        mesh = load_stl(Path(name))
        size = largest_width(mesh) if size_mm is None else size_mm
        # Checked before scaling, so that a size of zero is refused by name.
        Indenter(size_mm=size)
        return Indenter(kind=IndenterKind.MESH, size_mm=size, mesh=scaled(mesh, size))
    raise DesignError(
        f"there is no indenter {name!r}",
        hint=f"{suggest(kind, primitives)}; or give the path of an STL file",
        at="indenter",
    )
