"""Reading a deck that was written here: nodes, elements, sets, surfaces, and what it carries.

No reader of any deck: keywords that `deck` does not write are passed over.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from workbench.core.base.errors import StoreError

CARRIED, END = "**| ", " |"
"""Around the pieces of text that the workbench itself reads again."""
PIECE = 100
"""Characters to a line: programs cut long lines."""
NODES_OF = {"C3D6": 6, "C3D8": 8, "C3D8I": 8, "C3D20R": 20}


@dataclass(kw_only=True)
class DeckText:
    """What a deck says; all numbers are the deck's own, from 1."""

    nodes: dict[str, np.ndarray] = field(default_factory=dict)
    """Number, x, y, z [mm] of the nodes of each set that is made of nodes, (N, 4)."""
    elements: dict[str, np.ndarray] = field(default_factory=dict)
    """Number and nodes of the elements of each set that is made of elements, (M, 1 + C)."""
    kinds: dict[str, str] = field(default_factory=dict)
    """Type of the elements of each such set."""
    sets: dict[str, np.ndarray] = field(default_factory=dict)
    """Members of sets that are lists."""
    surfaces: dict[str, np.ndarray] = field(default_factory=dict)
    """Element and face, 1 to 6, of each surface, shape (Q, 2)."""
    steps: int = 0


def carried_lines(text: str) -> list[str]:
    """Text as comment lines."""
    pieces = [text[begin : begin + PIECE] for begin in range(0, len(text), PIECE)]
    return [f"{CARRIED}{piece}{END}" for piece in pieces]


def carried_text(deck: str) -> str:
    """The text that a deck carries.

    Raises:
        StoreError: If it carries none.
    """
    lines = [line.rstrip() for line in deck.splitlines() if line.startswith(CARRIED)]
    found = "".join(line[len(CARRIED) :].removesuffix(END) for line in lines)
    if not found:
        raise StoreError(
            "the deck does not say which design and press it was written for",
            hint="take the file that `workbench fem export` wrote, comments included",
        )
    return found


def read_deck(deck: str) -> DeckText:
    """Nodes, elements, sets and surfaces of a deck.

    Raises:
        StoreError: If a line is not what its keyword asks for.
    """
    found, keyword, lines = DeckText(), {}, []
    for line in [*deck.splitlines(), "*END"]:
        if line.startswith("**") or not line.strip():
            continue
        if not line.startswith("*"):
            lines.append(line)
            continue
        try:
            _take(found, keyword, lines)
        except (ValueError, KeyError) as error:
            raise StoreError(
                f"the deck is damaged after *{keyword[''].upper()}: {error}",
                hint="export it again",
            ) from error
        keyword, lines = _keyword(line), []
    return found


def _keyword(line: str) -> dict[str, str]:
    """Name, under "", and parameters of a keyword line, in capitals."""
    head, *parameters = line[1:].upper().split(",")
    pairs = (parameter.partition("=") for parameter in parameters)
    return {"": head.strip()} | {name.strip(): value.strip() for name, _, value in pairs}


def _take(found: DeckText, keyword: dict[str, str], lines: list[str]) -> None:
    name = keyword.get("", "")
    if name == "NODE":
        found.nodes[keyword["NSET"]] = np.array(_rows(lines, 4), dtype=np.float64)
    elif name == "ELEMENT":
        rows = _rows(lines, 1 + NODES_OF[keyword["TYPE"]])
        found.elements[keyword["ELSET"]] = np.array(rows, dtype=np.float64).astype(np.int64)
        found.kinds[keyword["ELSET"]] = keyword["TYPE"]
    elif name in ("NSET", "ELSET"):
        found.sets[keyword[name]] = np.array([int(line) for line in lines], dtype=np.int64)
    elif name == "SURFACE":
        pairs = [line.replace("S", "").split(",") for line in lines]
        found.surfaces[keyword["NAME"]] = np.array(pairs).astype(np.int64)
    elif name == "STEP":
        found.steps += 1


def _rows(lines: list[str], width: int) -> list[list[float]]:
    """Numbers of lines, each `width` of them, which may go on in the next line."""
    numbers = [float(word) for line in lines for word in line.split(",") if word.strip()]
    if len(numbers) % width:
        raise ValueError(f"{len(numbers)} numbers do not make rows of {width}")
    return [numbers[begin : begin + width] for begin in range(0, len(numbers), width)]
