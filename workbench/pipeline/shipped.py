"""The trained networks that come with the workbench: a newcomer has learned forces at once."""

from __future__ import annotations

from pathlib import Path

from sim.forces.network.spec import Target
from sim.forces.network.weights import SUFFIX
from workbench.core.base.errors import StoreError

FOLDER = Path(__file__).parent / "shipped_weights"
HELD_OUT = "held_out"
"""Folder of the presses that the shipped networks are scored on, in it."""
FIRST = "geltip"
"""The membrane whose skin is meant where none is named."""
RETRAIN = "workbench train make DATA --preset small --target {target} --out DIR"
"""The command that makes such weights."""


def shipped_weights(target: Target) -> Path:
    """The file of the shipped network for a target.

    Raises:
        StoreError: If none is shipped.
    """
    found = sorted(FOLDER.glob(f"*-{target.value}-*{SUFFIX}"))
    if not found:
        raise StoreError(
            f"no trained network for {target.value} comes with this version",
            hint=f"train one: {RETRAIN.format(target=target.value)}",
            at="learned.weights",
        )
    return found[0]


def held_out_sets() -> dict[str, list[Path]]:
    """Held-out sets of the shipped networks by the name of their membrane, `FIRST` first.

    A file is `MEMBRANE-DATASET.npz`: one for each data set that it was pressed in.
    """
    found: dict[str, list[Path]] = {}
    for path in sorted((FOLDER / HELD_OUT).glob("*.npz")):
        found.setdefault(path.stem.split("-")[0], []).append(path)
    return {name: found[name] for name in sorted(found, key=lambda name: (name != FIRST, name))}


def held_out_set(membrane: str = FIRST) -> Path:
    """The first held-out set of a membrane: it has its skin.

    Raises:
        StoreError: If none is shipped.
    """
    found = held_out_sets()
    if membrane not in found:
        raise StoreError(
            f"the shipped networks were not trained on a membrane {membrane!r}"
            if found
            else "no held-out set comes with this version",
            hint=f"name one of {', '.join(found)}"
            if found
            else "make one with workbench evaluate DATA --pack FILE, or name a set with --data",
            at="skin",
        )
    return found[membrane][0]


def is_shipped(target: Target) -> bool:
    """Whether there is one."""
    return any(FOLDER.glob(f"*-{target.value}-*{SUFFIX}"))
