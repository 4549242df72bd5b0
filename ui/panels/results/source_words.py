"""The sources of one press in words and numbers: a table of totals, and how far they are apart."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

import numpy as np

from sim.forces.peaks import DISC_MM, Triangles
from ui.page.colours import AMBER
from ui.page.plain import plain
from workbench.core.press.fem import DRAFT_MM, QUALITY_MM
from workbench.core.result.force_field import ForceField, Source
from workbench.view.force_sources import WORDS, Forces, disagreement, totals
from workbench.view.frame_words import number

NONE = (
    "Finite elements are the ground truth: the same press, on hexahedra of their own. A press of "
    "ten frames takes some ten seconds as a draft, and two to five times that at the quality mesh; "
    "what is wide and edged takes minutes."
)
COARSE = (
    f"**A mesh of {{:g}} mm is a draft**: forces are within 5 % at {DRAFT_MM:g} mm, from 0.3 mm of "
    f"depth on; {QUALITY_MM:g} mm is to be trusted"
)
STALE = "**stale**: {} of an earlier design or press; {} again"
AGAIN = {
    Source.FEM: ("finite elements are", "solve"),
    Source.LEARNED: ("learned forces are", "predict"),
}
WHOSE = {
    Source.MPM: "The contact solver's",
    Source.FEM: "Finite elements'",
    Source.LEARNED: "The network's",
}
HEAD = (
    f"| source | normal N | tangential N | peak kPa | {DISC_MM:g} mm disc mN |",
    "|---|---|---|---|---|",
)
"""The disc: the largest force that passes through one of that diameter anywhere on the skin."""


def sources_text(
    found: Mapping[Source, Forces],
    frame: int,
    skin: Triangles,
    *,
    stale: Collection[Source] = (),
    advice: str = "",
) -> str:
    """What is said of all sources in a frame, counted from 0, as Markdown.

    Args:
        found: The sources that there are, the contact solver among them.
        frame: Which.
        skin: Of the design, at rest.
        stale: Those of an earlier design or press.
        advice: Errors of the sources on presses like this one, where they are not told above.
    """
    rows = [
        f"| {WORDS[row.source].value} | {number(row.normal_N, '.3f')} | "
        f"{number(row.tangential_N, '.3f')} | {number(1e3 * row.peak_MPa, '.1f')} | "
        f"{number(1e3 * row.peak_disc_N, '.0f')} |"
        for row in (totals(source, forces, frame, skin) for source, forces in found.items())
    ]
    parts = [
        *(STALE.format(*AGAIN[source]) for source in stale),
        "\n".join((*HEAD, *rows)),
        *_apart(found, frame),
        *_solvers(found),
        *([f"<small>{plain(advice)}</small>"] if advice else []),
    ]
    return "\n\n".join(parts)


def _apart(found: Mapping[Source, Forces], frame: int) -> Iterator[str]:
    """How far each source is from the best there is."""
    truth = Source.FEM if Source.FEM in found else Source.MPM
    other = "that of finite elements" if truth is Source.FEM else "that of the contact solver"
    for source, forces in found.items():
        if source is truth:
            continue
        apart = disagreement(forces, found[truth], frame)
        moved = (
            f"its displacement {number(1e3 * apart.displacement_mm, '.0f')} µm (rms) of "
            f"{number(1e3 * apart.farthest_mm, '.0f')}"
        )
        if source is Source.LEARNED and apart.displacement_mm == 0.0 and truth is Source.MPM:
            moved = "its displacement is the contact solver's"
        share = number(100 * apart.normal_share, "+.1f")
        yield f"{WHOSE[source]} normal force is {share} % from {other}, {moved}."


def _solvers(found: Mapping[Source, Forces]) -> Iterator[str]:
    """What solved or predicted each, and what one should know of it."""
    solved, learned = found.get(Source.FEM), found.get(Source.LEARNED)
    if isinstance(solved, ForceField):
        text = f"{plain(solved.solver)}, residual {number(solved.residual.max(), '.0e')}"
        at_end = solved.force_error[-1:]
        if np.isfinite(at_end).any():
            text += f", estimated error of the last force {number(100 * at_end[0], '+.1f')} %"
        coarse = solved.spacing_mm > QUALITY_MM
        yield f"{text}. {COARSE.format(solved.spacing_mm)}" if coarse else text
    if isinstance(learned, ForceField):
        yield f"<small>{plain(learned.solver)}</small>"
        if learned.note:
            yield f"<small>Note: {plain(learned.note)}</small>"


def doubt_text(notice: str, advice: str) -> str:
    """Why learned forces may be wrong, and what was measured of that, before their numbers."""
    said = f"**Not known to the network:** {plain(notice)}"
    return f"<span style='color:{AMBER}'>{said}</span>\n\n{plain(advice)}"
