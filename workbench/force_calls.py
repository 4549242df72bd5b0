"""The calls of forces by finite elements: the solution, and the same on the skin of the design.

Both find the mesh of the finite elements as a part of their own: it is not the design's.
"""

from __future__ import annotations

from typing import Any

from workbench.calls import Call, Ref
from workbench.core.design import Elastomer, Meshing
from workbench.core.fem import FemSettings
from workbench.core.indenter import Indenter
from workbench.core.press import Press
from workbench.store import Store


def fem_calls(
    build: Ref,
    mesh: Ref,
    material: Elastomer,
    indenter: Indenter,
    press: Press,
    settings: FemSettings,
) -> tuple[Call, Call]:
    """The calls `fem` and `forces`.

    Args:
        build: The body.
        mesh: Meshes of the design, on whose skin forces are shown.
        material: The elastomer without what statics do not read.
        indenter: The object.
        press: Its path.
        settings: Numerical choices.
    """
    solved = Call("fem", (build, material, indenter, press, settings))
    return solved, Call("forces", (mesh, build, settings.hex_mm, solved.ref))


def fem_parts(store: Store, inputs: tuple[Any, ...]) -> tuple[Call, ...]:
    """The mesh of a call `fem`, and the object's distance where that takes long to sample."""
    from sim.fem.press import sampling_grid_mm

    build, _, indenter, _, settings = inputs
    calls = [_mesh(build, settings.hex_mm)]
    if indenter.mesh is not None or indenter.texture.raised:
        calls.append(Call("object", (indenter, sampling_grid_mm(settings))))
    return tuple(calls)


def shown_parts(store: Store, inputs: tuple[Any, ...]) -> tuple[Call, ...]:
    """The mesh that the result of a call `forces` was found on."""
    _, build, hex_mm, _ = inputs
    return (_mesh(build, hex_mm),)


def _mesh(build: Ref, hex_mm: float) -> Call:
    return Call("mesh", (build, Meshing(hex_mm=hex_mm)))
