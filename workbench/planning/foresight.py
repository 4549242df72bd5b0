"""What will be refused, told before anything long is computed: `misfits` for whoever asks.

A `ForesightCall` is a `workbench.live.preview_call`: nothing of it is stored, since the body is and
the answer takes a moment.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor
from workbench.core.design.design import SensorDesign
from workbench.core.design.optics import Optics
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import Solid
from workbench.pipeline.stage import Ref
from workbench.pipeline.store import Store
from workbench.planning.planned import planned


@dataclass(frozen=True, kw_only=True, slots=True)
class ForesightCall:
    """What of a state does not fit its body; a `PreviewCall`."""

    solid: Ref
    optics: Optics
    indenter: Indenter
    press: Press

    @property
    def lane(self) -> str:
        """The worker that answers it: the one that neither meshes nor presses."""
        return "look"

    @property
    def stage(self) -> str:
        """What messages call it."""
        return "foresight"

    @property
    def needs(self) -> tuple[str, ...]:
        """Stages that must be stored before."""
        return ("build",)

    def answer(
        self, store: Store, kept: dict[str, Any], monitor: Monitor
    ) -> tuple[DesignError, ...]:
        """Everything that will be refused."""
        from workbench.planning.misfits import misfits

        solid = store.load(self.solid.stage, self.solid.key)
        return tuple(misfits(solid, self.optics, self.indenter, self.press))


def foresight_call(design: SensorDesign, case: PressCase) -> ForesightCall:
    """The question for a state."""
    build = planned(design, case)["build"]
    return ForesightCall(
        solid=build.ref, optics=design.optics, indenter=case.indenter, press=case.press
    )


def expect_fit(solid: Solid, optics: Optics | None, case: PressCase) -> None:
    """Refuse what does not fit the body, with everything that does not in one message.

    Args:
        solid: The built body.
        optics: Lights and cameras; None leaves them out.
        case: The press.

    Raises:
        DesignError: The first misfit; its hint names the others.
    """
    from workbench.planning.misfits import misfits

    found = misfits(solid, optics, case.indenter, case.press)
    if not found:
        return
    first, others = found[0], found[1:]
    if first.at.startswith("optics"):
        first.hint += "; --fit brings LEDs and cameras inside the body"
    if others:
        first.hint += "; also: " + "; ".join(error.message for error in others)
    raise first


def optical_misfits(solid: Solid, optics: Optics) -> list[str]:
    """What is wrong with the places of lights and cameras, with its remedy, in words."""
    from workbench.planning.misfits import misfits

    return [f"{error.message}; {error.hint}, or use --fit" for error in misfits(solid, optics)]
