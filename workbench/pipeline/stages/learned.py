"""The stage `learned`: forces of a press by trained networks, and how well these know it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from sim.forces.acquaintance import BETWEEN, Membrane, acquaintance
from workbench.core.base.errors import WorkbenchError
from workbench.core.base.monitor import Monitor
from workbench.core.design.design import Elastomer, SensorDesign
from workbench.core.press.indenter import Indenter
from workbench.core.press.learned import WeightsFile
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import ForceField
from workbench.core.result.results import MembraneMesh, Solid
from workbench.core.result.sensing import Contact
from workbench.pipeline.chosen_weights import about, read_weights, weights_files
from workbench.pipeline.devices import load_torch, torch_device
from workbench.pipeline.known_membrane import membrane_differences
from workbench.pipeline.stage import PART, Call, Chain, Stage
from workbench.pipeline.stages.mesh import mesh_at
from workbench.pipeline.stages.press import elastic
from workbench.pipeline.store import Store


@dataclass(frozen=True, kw_only=True, slots=True)
class Trained:
    """A network, and what its data card says of the membrane; the name of the file is the key."""

    file: WeightsFile
    hex_mm: float = field(default=0.0, metadata={"cosmetic": True})
    """Spacing of the mesh that it was trained on [mm]; 0 where the file cannot be read."""
    differences: tuple[str, ...] | None = field(default=None, metadata={"cosmetic": True})
    """How the membrane differs from that of the training; None where the card has no design."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LearnedInputs:
    """What learned forces depend on."""

    mesh: MembraneMesh
    """Of the design, on whose skin forces are shown."""
    solid: Solid
    contact: Contact
    material: Elastomer
    indenter: Indenter
    path: Press
    settings: ContactSettings
    force: Trained
    displacement: Trained | None
    source: MembraneMesh | None = field(default=None, metadata=PART)
    """The body at the spacing of the training."""

    @property
    def case(self) -> PressCase:
        """What is pressed, where, and by which settings of the contact solver."""
        return PressCase(indenter=self.indenter, press=self.path, settings=self.settings)


def inputs(chain: Chain) -> LearnedInputs | None:
    """The press and the networks; None where none is chosen and none is shipped."""
    design, case = chain.design, chain.case
    force, displacement = weights_files(case.learned)
    if force is None:
        return None
    return LearnedInputs(
        mesh=chain.result("mesh"),
        solid=chain.result("build"),
        contact=chain.result("press"),
        material=elastic(design.material),
        indenter=case.indenter,
        path=case.press,
        settings=case.settings,
        force=_trained(force, design),
        displacement=None if displacement is None else _trained(displacement, design),
    )


def _trained(file: WeightsFile, design: SensorDesign) -> Trained:
    try:
        known = about(file)
    except WorkbenchError:
        # Planning goes on; who runs the network is told.
        return Trained(file=file)
    differences = membrane_differences(known.card, design)
    return Trained(file=file, hex_mm=known.hex_mm, differences=differences)


def parts(given: LearnedInputs, store: Store) -> dict[str, Call]:
    """The mesh of the weights' training.

    Raises:
        StoreError: If the weights cannot be read.
    """
    hex_mm = given.force.hex_mm or about(given.force.file).hex_mm
    return {"source": mesh_at(given.solid, hex_mm)}


def learned(given: LearnedInputs, *, monitor: Monitor) -> ForceField:
    """Forces by a network, found on the mesh of its training, on the skin of the design."""
    import numpy as np

    mesh, contact, source = given.mesh, given.contact, given.source
    assert source is not None, "found as a part of the call"
    force, displacement = given.force, given.displacement
    networks = [force] if displacement is None else [force, displacement]
    read = [read_weights(network.file) for network in networks]
    load_torch(monitor)
    from sim.forces.learned import Known, Pair, learned_forces

    points_mm, gel = source.outer.points_mm, source.backing_mm > 0.0
    largest_mm = float(np.linalg.norm(contact.displacement_mm, axis=2).max(initial=0.0))
    used = [
        Known(
            name=network.file.name,
            weights=weights,
            acquaintance=acquaintance(
                weights.card,
                weights.target,
                Membrane(differences=network.differences, points_mm=points_mm, gel=gel),
                given.material,
                given.case,
                largest_mm=largest_mm,
            ),
        )
        for network, weights in zip(networks, read, strict=True)
    ]
    return learned_forces(
        mesh,
        contact,
        source,
        Pair(*used),
        device=torch_device(),
        monitor=monitor,
    )


def foreknown(given: LearnedInputs) -> tuple[str, ...]:
    """What the networks do not know of a press, before it is computed.

    What only results tell is left out: the largest displacement, and the mesh.
    """
    return tuple(dict.fromkeys(reason for reason, _ in _foreknown(given)))


def unmeasured(given: LearnedInputs, notice: str = "") -> tuple[str, ...]:
    """Those of what the networks do not know whose error no held-out press shows.

    Args:
        given: The press.
        notice: Of its result, once there is one.
    """
    known = dict(_foreknown(given))
    found = dict.fromkeys(reason for reason, covered in known.items() if not covered)
    later = (reason for reason in notice.split(BETWEEN) if reason and reason not in known)
    return tuple(found | dict.fromkeys(later))


def _foreknown(given: LearnedInputs) -> Iterator[tuple[str, bool]]:
    """Each reason, and whether held-out presses show its error."""
    for network in (given.force, given.displacement):
        if network is not None:
            try:
                said = about(network.file)
            except WorkbenchError as error:
                yield f"{error.message}; {error.hint}", False
                return
            found = acquaintance(
                said.card,
                said.target,
                Membrane(differences=network.differences),
                given.material,
                given.case,
            )
            yield from ((reason, reason in found.covered) for reason in found.reasons)


STAGE = Stage(
    name="learned",
    label="Learned forces",
    version=3,
    place=11,
    lane="sim",
    run=learned,
    inputs=inputs,
    parts=parts,
    heavy=True,
)
