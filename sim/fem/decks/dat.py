"""What CalculiX printed for a deck: its `.dat`, with forces, displacements and stresses.

Each block begins with a line that says what, of which set, and at which time; a step of ours lasts
one unit of time. Blocks that the deck does not ask for are passed over. Source: CalculiX CrunchiX
2.20, whose numbers are in columns apart.
"""

from __future__ import annotations

import re

import numpy as np

from sim.contact.readout.fields import VOIGT
from sim.fem.decks.deck import DeckCase, skin_cells
from sim.fem.decks.mesh import deck_mesh
from sim.fem.decks.results import OtherResult, expect_frames
from sim.fem.decks.stress_forces import stress_forces
from workbench.core.base.errors import StoreError

BLOCK = re.compile(r"^ *(total force|displacements|stresses) .*for set (\w+) and time +(\S+) *$")
WIDTHS = {"total force": 3, "displacements": 4, "stresses": 8}
"""Numbers on each line of a block."""
WHOLE = 1e-6
"""A time nearer than this to a whole number is the end of a step."""
DAT_VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""Order of stresses in CalculiX: xx, yy, zz, xy, xz, yz."""


def read_dat(text: str, case: DeckCase) -> OtherResult:
    """What CalculiX printed.

    Args:
        text: Its `.dat`.
        case: What the deck was written for.

    Raises:
        StoreError: If the file is no such file, truncated, or of another deck.
        SolveError: If it has fewer steps than the press has frames.
    """
    blocks = _blocks(text)
    count = case.approach.frame_count
    if not blocks:
        raise StoreError(
            "the file holds no results of a deck: no forces and no displacements",
            hint="name the .dat that CalculiX wrote beside the deck, or a .csv; the .dat is empty "
            "where the program ended before the first frame",
        )
    expect_frames(len({frame for _, frame in blocks}), count)
    if not text.endswith("\n"):
        # Half a number may still read as a number.
        raise StoreError("the file is cut short in its last line", hint="run the program again")
    body = case.submodel.body
    mesh = deck_mesh(body.points_mm, body.elements.cells, case.element)
    rows, size = skin_cells(case.submodel), len(mesh.points_mm)
    numbers = np.arange(1, size + 1)
    points = np.stack([np.repeat(rows + 1, 8), np.tile(np.arange(1, 9), len(rows))], axis=1)
    loose = np.zeros(len(body.points_mm), dtype=bool)
    loose[body.faces.nodes] = True
    loose &= ~body.held
    members = mesh.members(loose)
    moved, forces, reactions = [], [], []
    for frame in range(1, count + 1):
        total = _block(blocks, "total force", frame, None, 1)
        shift = _block(blocks, "displacements", frame, numbers[:, None], size)
        stress = _block(blocks, "stresses", frame, points, len(points))
        order = [DAT_VOIGT.index(tuple(sorted(pair))) for pair in VOIGT]
        tensors = _tensors(stress[:, order]).reshape(len(rows), 8, 3, 3)
        places_mm = mesh.points_mm + (0.0 if body.elements.linear else shift)
        found = stress_forces(places_mm, mesh.cells[rows], tensors) * members[:, None]
        moved.append(shift[: len(body.points_mm)])
        forces.append(mesh.gathered(found))
        reactions.append(-total[0])
    return OtherResult(
        displacement_mm=np.stack(moved),
        contact_N=np.stack(forces),
        reaction_N=np.stack(reactions),
        program="CalculiX",
    )


def _blocks(text: str) -> dict[tuple[str, int], np.ndarray]:
    """Numbers of the blocks at the ends of steps, by what they are and the step."""
    found: dict[tuple[str, int], list[list[float]]] = {}
    rows: list[list[float]] | None = None
    width = 0
    for number, line in enumerate(text.splitlines(), start=1):
        head = BLOCK.match(line)
        words = line.split()
        if head is not None:
            what, name, time = head.groups()
            step = float(time)
            rows, width = [], WIDTHS[what]
            if abs(step - round(step)) < WHOLE and (what != "total force" or name == "NOBJ"):
                found[what, round(step)] = rows
        elif rows is not None and words:
            try:
                values = [float(word) for word in words]
            except ValueError:
                # A heading of something that was asked for beside what the deck asks for.
                rows = None
                continue
            if len(values) != width or not np.isfinite(values).all():
                raise StoreError(
                    f"line {number} of the results is damaged: {line.strip()[:60]!r}",
                    hint="run the program again; a full disk cuts files short",
                )
            rows.append(values)
    return {key: np.array(values, dtype=np.float64) for key, values in found.items()}


def _block(
    blocks: dict[tuple[str, int], np.ndarray],
    what: str,
    frame: int,
    numbers: np.ndarray | None,
    count: int,
) -> np.ndarray:
    """Values of a block without the numbers that each line begins with."""
    found = blocks.get((what, frame), np.zeros((0, WIDTHS[what])))
    if len(found) != count:
        raise StoreError(
            f"step {frame} has {len(found)} lines of {what} where the deck asks for {count}: the "
            "file is cut short, or belongs to another deck",
            hint="name the results of this very deck, or run it again",
        )
    if numbers is None:
        return found
    lead = numbers.shape[1]
    order = np.lexsort(found[:, lead - 1 :: -1].T)
    found = found[order]
    if not np.array_equal(found[:, :lead], numbers[np.lexsort(numbers[:, ::-1].T)]):
        raise StoreError(
            f"step {frame} has {what} of other nodes or elements than the deck asks for",
            hint="name the results of this very deck",
        )
    return found[:, lead:]


def _tensors(stress: np.ndarray) -> np.ndarray:
    """Symmetric tensors (P, 3, 3) of components in our order (P, 6)."""
    found = np.zeros((len(stress), 3, 3))
    for place, (row, column) in enumerate(VOIGT):
        found[:, row, column] = found[:, column, row] = stress[:, place]
    return found
