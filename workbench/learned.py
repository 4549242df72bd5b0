"""The stage `learned`: forces of a press by trained networks, and how well these know it."""

from __future__ import annotations

import importlib
import threading

from sim.forces.acquaintance import Membrane, acquaintance
from workbench.calls import Call
from workbench.chosen_weights import about, read_weights
from workbench.core.design import Elastomer
from workbench.core.errors import WorkbenchError
from workbench.core.force_field import ForceField
from workbench.core.indenter import Indenter
from workbench.core.monitor import Monitor
from workbench.core.press import ContactSettings, Press
from workbench.core.results import MembraneMesh, Solid
from workbench.core.sensing import Contact
from workbench.force_calls import Trained

LOOK_S = 0.1
"""How often somebody is asked whether to go on while PyTorch loads [s]."""


def learned(
    mesh: MembraneMesh,
    solid: Solid,
    contact: Contact,
    material: Elastomer,
    indenter: Indenter,
    path: Press,
    settings: ContactSettings,
    force: Trained,
    displacement: Trained | None,
    source: MembraneMesh,
    *,
    monitor: Monitor,
) -> ForceField:
    """Forces by a network, found on the mesh `source`, on the skin of the design."""
    import numpy as np

    networks = [force] if displacement is None else [force, displacement]
    read = [read_weights(network.file) for network in networks]
    load_torch(monitor)
    from sim.forces.learned import Known, learned_forces
    from workbench.devices import torch_device

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
                material,
                indenter,
                path,
                settings,
                largest_mm=largest_mm,
            ),
        )
        for network, weights in zip(networks, read, strict=True)
    ]
    return learned_forces(
        mesh,
        contact,
        source,
        *used,
        solvable=source.hexes is not None and indenter.soft is None,
        device=torch_device(),
        monitor=monitor,
    )


def foreknown(call: Call) -> tuple[str, ...]:
    """What the networks of a call `learned` do not know of its press, before it is computed.

    What only results tell is left out: the largest displacement, and the mesh.
    """
    _, _, _, *case, force, displacement = call.inputs
    reasons: dict[str, None] = {}
    for network in (force, displacement):
        if network is not None:
            try:
                said = about(network.file)
            except WorkbenchError as error:
                return (f"{error.message}; {error.hint}",)
            membrane = Membrane(differences=network.differences)
            found = acquaintance(said.card, said.target, membrane, *case)
            reasons |= dict.fromkeys(found.reasons)
    return tuple(reasons)


def load_torch(monitor: Monitor) -> None:
    """Import PyTorch: two seconds the first time, in which one may still be stopped.

    Raises:
        Cancelled: If the monitor says so; the import goes on and is of use to the next.
    """
    loading = threading.Thread(target=importlib.import_module, args=("torch",), daemon=True)
    loading.start()
    while loading.is_alive():
        monitor(0.0, "loading the network")
        loading.join(LOOK_S)
