"""Bodies that were released with the paper: outer skins of membranes, heads of indenters.

`docs/released_bodies.py` made `released.npz` of the files; `NOTICE.md` says whose they are.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

FILE = Path(__file__).parent / "released.npz"
STEP_MM = 1e-3
"""Places are kept in steps of a micrometre."""


class Cut(NamedTuple):
    """A flat face by which a body is held."""

    way: tuple[float, float, float]
    """Its outward unit normal, in the frame of the file."""
    offset_mm: float
    """How far it lies along that from the origin."""


# The ends of the released arm lean by 40 degrees.
_LEAN = (math.sin(math.radians(40.0)), math.cos(math.radians(40.0)))
CUTS = {
    "finger": (Cut((-1.0, 0.0, 0.0), 27.0),),
    "trunk": (Cut((0.0, 0.0, -1.0), 30.132),),
    "paw": (Cut((0.0, 0.0, -1.0), 0.0),),
    "thumb": (Cut((0.0, 0.0, -1.0), 0.0),),
    "tentacle": (
        Cut((0.0, _LEAN[0], -_LEAN[1]), 25.711),
        Cut((0.0, _LEAN[0], _LEAN[1]), 25.711),
    ),
    "digitac": (Cut((0.0, 0.0, -1.0), 9.25),),
}
"""By the family whose membrane the released one is."""


class Skin(NamedTuple):
    """A surface, open where the body is held."""

    points_mm: np.ndarray
    """Vertices, shape (N, 3)."""
    faces: np.ndarray
    """Triangles counter-clockwise from outside, shape (M, 3)."""
    cuts: tuple[Cut, ...] = ()


def membrane(family: str) -> Skin:
    """The outer skin of a released membrane, in the frame of its file."""
    return _read(f"membranes/{family}")._replace(cuts=CUTS[family])


def indenter(name: str) -> Skin:
    """The head of a released indenter, in the frame of its file: its tip toward -x."""
    return _read(f"indenters/{name}")


def _read(name: str) -> Skin:
    with np.load(FILE) as kept:
        places, faces = kept[f"{name}/places"], kept[f"{name}/faces"]
    return Skin(points_mm=places * STEP_MM, faces=faces.astype(np.int32))
