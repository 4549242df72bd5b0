"""What slides by converged finite elements, recorded: a press of them takes minutes.

`python -m workbench.proof.validation.fem.slip_record [JOBS]` makes the record: hexahedra of 0.45
mm, halved three times under the contact. Cases are .2, .4 and .6 mm straight into the finger, then
1 mm along it in frames of .1 mm, or 1.2 mm where a part still sticks; and the ball of
`sim.contact.studies.sliding` on its flat layer.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.design.design import Elastomer
from workbench.core.press.fem import QUALITY_MM, FemSettings
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.motion import slide
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import ForceField
from workbench.core.result.sensing import Contact
from workbench.proof.validation.contact.finger_record import FEM_APART
from workbench.proof.validation.contact.presses import tip_target
from workbench.proof.validation.fem.fem_presses import finger
from workbench.system.record import Record

KINDS = (IndenterKind("cube"), IndenterKind("sphere"), IndenterKind("flower"))
RECORD = Record(
    path=Path(__file__).with_name("slip_record.json"),
    command="python -m workbench.proof.validation.fem.slip_record",
    sources=(
        "workbench.proof.validation.fem.slip_record",
        "designs.finger",
        *(f"workbench.core.objects.kinds.{kind.value}" for kind in KINDS),
    ),
    apart=(*FEM_APART, "sim.contact.press", "sim.contact.studies.specimens"),
)
PLACES = {"tip": tip_target(0.0, 0.0), "side": (15.0, 0.0, 12.0)}
"""Targets on the finger [mm]: the end of its round tip, and its cylinder by the base."""
DEPTH_MM, PRESSED = 0.6, 3
FRAME_MM = 0.1
"""Depth of the press and its frames; way of each frame of the slide."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SlipCase:
    """An object on the finger."""

    kind: IndenterKind
    place: str
    slid: int = 10
    """Frames of the slide."""

    @property
    def name(self) -> str:
        """As in the file."""
        return f"{self.kind.value}_{self.place}"

    @property
    def press(self) -> Press:
        """In, then along U."""
        return Press(
            target_mm=PLACES[self.place],
            depth_mm=DEPTH_MM,
            frames=PRESSED,
            strokes=(slide(self.slid * FRAME_MM, 0.0, frames=self.slid),),
        )


LATE = {("side", "cube"): 12}
"""Frames of slides after which a part would still stick."""
CASES = tuple(
    SlipCase(kind=kind, place=place, slid=LATE.get((place, kind.value), 10))
    for place in PLACES
    for kind in KINDS
)
LAYER_MM = 0.5
"""Edge of the cells of the flat layer, before they are halved."""
BALL = "ball_on_layer"
"""Name of the ball that slides on a flat layer."""


def solved(case: SlipCase, *, hex_mm: float = QUALITY_MM) -> ForceField:
    """A case by finite elements."""
    from sim.fem.press import solve_press

    return solve_press(
        finger(hex_mm),
        Elastomer(),
        PressCase(
            indenter=Indenter(kind=case.kind),
            press=case.press,
            fem=FemSettings(hex_mm=hex_mm, error=False),
        ),
    )


def ball_on_layer() -> ForceField:
    """The ball that slides 3 mm on a flat layer, by finite elements, in frames of .1 mm."""
    from sim.contact.studies import sliding
    from sim.fem.press import solve_press
    from sim.fem.studies.blocks import flat_membrane

    path = sliding.path((slide(sliding.SLIDE_MM, 0.0, frames=30),))
    case = PressCase(
        indenter=Indenter(size_mm=sliding.BALL_MM),
        press=path,
        fem=FemSettings(error=False, radius_mm=0.0),
    )
    layer = flat_membrane(
        width_mm=sliding.LENGTH_MM, height_mm=sliding.HEIGHT_MM, edge_mm=LAYER_MM, layers=4
    )
    return solve_press(layer, Elastomer(friction=sliding.FRICTION), case)


@functools.cache
def recorded(name: str) -> dict[str, Any]:
    """Figures of a case: `sliding_share`, `normal_N`, `tangential_N` and `gross_slip_mm`.

    Raises:
        StoreError: If the record cannot be read.
    """
    return RECORD.figures()["cases"][name]


def figures(found: ForceField | Contact) -> dict[str, Any]:
    """What is recorded of a result."""
    from workbench.view.forces import gross_slip

    gross = gross_slip(found)
    across_N = found.reaction_N - np.outer(found.normal_N, found.normal)
    return {
        "sliding_share": _rounded(found.sliding_share),
        "normal_N": _rounded(found.normal_N),
        "tangential_N": _rounded(np.linalg.norm(across_N, axis=1)),
        "gross_slip_mm": None if gross is None else round(gross.way_mm, 5),
    }


def _rounded(values: np.ndarray) -> list[float]:
    return [round(float(value), 5) for value in values]


def every_case(jobs: int = 1) -> dict[str, Any]:
    """All cases solved, for JSON.

    Args:
        jobs: Processes that solve them.
    """
    with ProcessPoolExecutor(max_workers=jobs, mp_context=get_context("spawn")) as pool:
        ball = pool.submit(_solved_ball)
        found = dict(zip(CASES, pool.map(_solved_case, CASES), strict=True))
    return {
        "hex_mm": QUALITY_MM,
        "halvings": FemSettings().halvings,
        "cases": {BALL: ball.result(), **{case.name: found[case] for case in CASES}},
    }


def _solved_case(case: SlipCase) -> dict[str, Any]:
    return figures(solved(case))


def _solved_ball() -> dict[str, Any]:
    return figures(ball_on_layer())


def main(words: Sequence[str]) -> int:
    """Make the record."""
    RECORD.make(functools.partial(every_case, int(words[0]) if words else 1))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
