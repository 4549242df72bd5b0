"""Forces of one press from several sources, side by side: totals, and how far they disagree.

Finite elements are what others are judged by; without them the network is held against the contact
solver.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sim.forces.peaks import Peaks, Triangles, largest_disc_N, peaks
from workbench.core.result.force_field import ForceField, Source
from workbench.core.result.sensing import Contact

Forces = Contact | ForceField
"""What can be shown on the skin: the fields of both have the same names."""
MOVED_MM = 0.1
"""Displacements below this take no part in the comparison: they are nearly all zero."""


class Shown(enum.StrEnum):
    """What the skin shows, in words for people."""

    MPM = "contact solver"
    FEM = "finite elements"
    LEARNED = "learned"
    FEM_DIFFERENCE = "difference: finite elements − contact solver"
    LEARNED_DIFFERENCE = "difference: learned − finite elements"
    LEARNED_CONTACT = "difference: learned − contact solver"


PAIRS = {
    Shown.MPM: (Source.MPM, None),
    Shown.FEM: (Source.FEM, None),
    Shown.LEARNED: (Source.LEARNED, None),
    Shown.FEM_DIFFERENCE: (Source.FEM, Source.MPM),
    Shown.LEARNED_DIFFERENCE: (Source.LEARNED, Source.FEM),
    Shown.LEARNED_CONTACT: (Source.LEARNED, Source.MPM),
}
"""What each shows, and what that is held against."""
WORDS = {Source.MPM: Shown.MPM, Source.FEM: Shown.FEM, Source.LEARNED: Shown.LEARNED}


@dataclass(frozen=True, kw_only=True, slots=True)
class Totals:
    """One source's numbers of one frame."""

    source: Source
    normal_N: float
    tangential_N: float
    peak_MPa: float
    """Largest contact pressure at a vertex."""
    peak_disc_N: float
    """Largest force through a disc of `DISC_MM` anywhere on the skin at rest."""
    residual: float
    """NaN where nothing is solved for."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Disagreement:
    """Two sources of one frame on the same vertices."""

    displacement_mm: float
    """Root mean square of the difference where either moves by more than `MOVED_MM`."""
    farthest_mm: float
    """Largest displacement of the second."""
    normal_share: float
    """Difference of the normal force over that of the second [1]."""


def source_of(forces: Forces | None) -> Source:
    """Where forces come from."""
    return forces.source if isinstance(forces, ForceField) else Source.MPM


def choices(found: Mapping[Source, Forces]) -> list[Shown]:
    """What can be shown of the sources that there are, one difference for each pair of interest."""
    possible = [
        shown
        for shown, (source, against) in PAIRS.items()
        if source in found and (against is None or against in found)
    ]
    if Shown.LEARNED_DIFFERENCE in possible:
        possible.remove(Shown.LEARNED_CONTACT)
    return possible


def totals(source: Source, forces: Forces, frame: int, skin: Triangles) -> Totals:
    """Numbers of frame `frame`, counted from 0, on the skin at rest."""
    reaction_N = np.asarray(forces.reaction_N[frame])
    along_N = float(reaction_N @ forces.normal)
    found = frame_peaks(forces, frame, skin)
    return Totals(
        source=source,
        normal_N=along_N,
        tangential_N=float(np.linalg.norm(reaction_N - along_N * np.asarray(forces.normal))),
        peak_MPa=found.peak_MPa,
        peak_disc_N=found.peak_disc_N,
        residual=float(forces.residual[frame]),
    )


def frame_peaks(forces: Forces, frame: int, skin: Triangles) -> Peaks:
    """Peaks of frame `frame`, counted from 0; NaN where the source knows no forces of vertices.

    The pressure is the source's own, where it has one.
    """
    if not len(forces.contact_force_N):
        return Peaks(peak_MPa=float("nan"), peak_disc_N=float("nan"))
    force_N = np.asarray(forces.contact_force_N[frame], np.float64)
    if not len(forces.pressure_MPa):
        return peaks(skin, force_N, np.asarray(forces.displacement_mm[frame]))
    peak_MPa = float(np.max(forces.pressure_MPa[frame], initial=0.0))
    return Peaks(peak_MPa=peak_MPa, peak_disc_N=largest_disc_N(skin, force_N))


def disagreement(one: Forces, other: Forces, frame: int) -> Disagreement:
    """How far a source is from another, which is taken for the truth, in a frame from 0."""
    first, second = (np.asarray(f.displacement_mm[frame], np.float64) for f in (one, other))
    size_mm = np.linalg.norm(second, axis=1)
    moved = np.maximum(np.linalg.norm(first, axis=1), size_mm) > MOVED_MM
    away_mm = np.linalg.norm(first - second, axis=1)[moved]
    force_N = float(other.reaction_N[frame] @ other.normal)
    missing_N = float(one.reaction_N[frame] @ one.normal) - force_N
    return Disagreement(
        displacement_mm=float(np.sqrt((away_mm**2).mean())) if len(away_mm) else 0.0,
        farthest_mm=float(size_mm.max(initial=0.0)),
        normal_share=missing_N / force_N if force_N else float("nan"),
    )
