"""The calls of forces by finite elements, on the skin of the design too, and by a trained network.

All find the mesh that they need as a part of their own: it is not the design's.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from workbench.calls import Call, Ref
from workbench.chosen_weights import about, weights_files
from workbench.core.design import Elastomer, Meshing, SensorDesign
from workbench.core.errors import WorkbenchError
from workbench.core.fem import FemSettings
from workbench.core.indenter import Indenter
from workbench.core.learned import LearnedSettings, WeightsFile
from workbench.core.press import ContactSettings, Press
from workbench.known_membrane import membrane_differences
from workbench.store import Store


@dataclass(frozen=True, kw_only=True, slots=True)
class Trained:
    """A network, and what its data card says of the membrane; the name of the file is the key."""

    file: WeightsFile
    hex_mm: float = field(default=0.0, metadata={"cosmetic": True})
    """Spacing of the mesh that it was trained on [mm]; 0 where the file cannot be read."""
    differences: tuple[str, ...] | None = field(default=None, metadata={"cosmetic": True})
    """How the membrane differs from that of the training; None where the card has no design."""


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


def learned_calls(
    design: SensorDesign,
    build: Ref,
    mesh: Ref,
    pressed: Ref,
    material: Elastomer,
    indenter: Indenter,
    press: Press,
    settings: ContactSettings,
    learned: LearnedSettings,
) -> tuple[Call, ...]:
    """The call `learned`; none where no force network is chosen and none is shipped.

    Args:
        design: What the membrane is compared by.
        build: The body.
        mesh: Meshes of the design, on whose skin forces are shown.
        pressed: What the contact solver found.
        material: The elastomer without what statics do not read.
        indenter: The object.
        press: Its path.
        settings: Of the contact solver.
        learned: Which networks.
    """
    force, displacement = weights_files(learned)
    if force is None:
        return ()
    second = None if displacement is None else _trained(displacement, design)
    case = (material, indenter, press, settings)
    return (Call("learned", (mesh, build, pressed, *case, _trained(force, design), second)),)


def _trained(file: WeightsFile, design: SensorDesign) -> Trained:
    try:
        known = about(file)
    except WorkbenchError:
        # Planning goes on; who runs the network is told.
        return Trained(file=file)
    differences = membrane_differences(known.card, design)
    return Trained(file=file, hex_mm=known.hex_mm, differences=differences)


def learned_parts(store: Store, inputs: tuple[Any, ...]) -> tuple[Call, ...]:
    """The mesh of a call `learned`: that of the weights' training.

    Raises:
        StoreError: If the weights cannot be read.
    """
    _, build, *_, force, _ = inputs
    return (_mesh(build, force.hex_mm or about(force.file).hex_mm),)


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
