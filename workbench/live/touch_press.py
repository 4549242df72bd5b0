"""What follows the hand at once while the designer drags: fast contact and its image, in a lane.

A `TouchCall` is a `workbench.live.preview_call`. The lane keeps the part of the skin's compliance
that was touched, and the scene of the last image. Each call is a press by itself, straight in and
then aside, so its answer does not depend on where the hand came from.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core.base.digest import digest
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.design import Elastomer, SensorDesign
from workbench.core.design.optics import Optics
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import Method, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.condensed import Hardening
from workbench.core.result.results import MembraneMesh
from workbench.live.kept_studio import KeptStudio
from workbench.live.live_press import PressPreview, live_design, live_press, small
from workbench.pipeline.fast.condensed import CondensedInputs
from workbench.pipeline.stage import Ref
from workbench.pipeline.store import Store
from workbench.planning.planned import planned
from workbench.planning.tile_columns import tile_finder

if TYPE_CHECKING:
    from sim.condensed.growing import GrowingContact
    from sim.condensed.surface import Surface
    from sim.contact.objects.collider import Collider

NEEDED = ("mesh", "bake", "table")
"""Stages that must be stored before, beside the nodes; `table` only of models that have it."""
STEPS = 2
"""Poses from first touch to full depth, and as many aside: 1, 2, 4 and 8 agree to 1e-4 of the force
of a ball 1 mm deep."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TouchCall:
    """One press."""

    skin: CondensedInputs
    law: Ref
    mesh: Ref
    light: Ref
    table: Ref | None
    material: Elastomer
    optics: Optics
    indenter: Indenter
    press: Press

    @property
    def lane(self) -> str:
        """The worker that answers it: not the one in which presses settle."""
        return "look"

    @property
    def stage(self) -> str:
        """What messages call it."""
        return "touch"

    @property
    def needs(self) -> tuple[str, ...]:
        """Stages that must be stored before."""
        return (*NEEDED, self.nodes.stage)

    @property
    def nodes(self) -> Ref:
        """The mesh whose outer vertices are the skin's nodes."""
        assert isinstance(self.skin.mesh, Ref), "a plan's inputs hold references"
        return self.skin.mesh

    def answer(self, store: Store, kept: dict[str, Any], monitor: Monitor) -> PressPreview:
        """Press and look."""
        toucher: Toucher = kept.setdefault(self.stage, Toucher())
        return toucher.answer(store, self, monitor)


def touch_call(design: SensorDesign, case: PressCase) -> TouchCall | None:
    """The press of a state by fast contact; None where that does not know such presses.

    Raises:
        DesignError: As `plan`.
    """
    if case.indenter.soft is not None or case.settings.method is not Method.LATTICE:
        return None
    design = live_design(design)
    calls = planned(design, case)
    if "condensed" not in calls or "hardening" not in calls:
        return None
    return TouchCall(
        skin=calls["condensed"].inputs,
        law=calls["hardening"].ref,
        mesh=calls["mesh"].ref,
        light=calls["bake"].ref,
        table=calls["table"].ref if "table" in calls else None,
        material=design.material,
        optics=design.optics,
        indenter=case.indenter,
        press=live_press(case.press),
    )


class Toucher:
    """Answers touch calls in one process, and keeps what the next one may need."""

    def __init__(self) -> None:
        self._studio = KeptStudio()
        self._monitor: Monitor = silent
        """Of the call that is answered: what is kept outlives the one that made it."""
        self._skin: tuple[str, GrowingContact] | None = None
        self._outer: tuple[Ref, Surface] | None = None
        self._object: tuple[Indenter, Collider] | None = None

    def answer(self, store: Store, call: TouchCall, monitor: Monitor) -> PressPreview:
        """Press and look.

        Raises:
            WorkbenchError: Whatever placing, fast contact or rendering raises.
        """
        from workbench.pipeline.devices import open_device

        begun = time.perf_counter()
        self._monitor = monitor
        open_device()
        from sim.condensed.placing import placed_near
        from sim.condensed.told import contact_of
        from workbench.core.base.poses import pose_rows

        mesh: MembraneMesh = store.load(call.mesh.stage, call.mesh.key)
        fast = self._contact(store, call)
        thing = self._collider(call.indenter)
        approach = placed_near(mesh.outer, thing, call.press)
        count = STEPS * call.press.approach_frames
        poses = pose_rows(*approach.poses(np.arange(count + 1) / STEPS))
        fast.reset(1)
        touch = [fast.step(thing, pose[None]) for pose in poses][-1]
        outer = self._followed(call, mesh, fast)
        contact = contact_of(touch, approach, poses[-1], outer)
        studio = self._studio.open(store, mesh, call.light, call.table, small(call.optics))
        images = studio.shoot(mesh.seen_displacement_mm(contact)).rgb
        seconds = time.perf_counter() - begun
        return PressPreview(
            contact=contact, images=images, seconds=seconds, words=_words(fast.law, seconds)
        )

    def _tell(self, fraction: float, note: str = "") -> None:
        self._monitor(fraction, note)

    def _contact(self, store: Store, call: TouchCall) -> GrowingContact:
        from sim.condensed.general_law import general_law
        from sim.condensed.growing import GrowingContact

        fitted = store.has(call.law.stage, call.law.key)
        key = digest((call.skin, call.material, fitted and call.law))
        if self._skin is None or self._skin[0] != key:
            law: Hardening = store.load(call.law.stage, call.law.key) if fitted else general_law()
            fast = GrowingContact(
                store.load(call.nodes.stage, call.nodes.key),
                call.skin.wall_mm,
                law,
                call.material,
                tile_finder(store, call.skin, self._tell),
            )
            self._skin = key, fast
        return self._skin[1]

    def _collider(self, indenter: Indenter) -> Collider:
        from sim.condensed.lessons import collider_of

        if self._object is None or self._object[0] != indenter:
            self._object = indenter, collider_of(indenter)
        return self._object[1]

    def _followed(self, call: TouchCall, mesh: MembraneMesh, fast: GrowingContact) -> Surface:
        """How the outer skin that is drawn follows the nodes."""
        from sim.condensed.surface import surface_of

        if self._outer is None or self._outer[0] != call.mesh:
            nodes, outer = fast.nodes, mesh.outer
            surface = surface_of(nodes.points_mm, nodes.normals, outer.points_mm, outer.normals)
            self._outer = call.mesh, surface
        return self._outer[1]


def _words(law: Hardening, seconds: float) -> str:
    """How an answer was reached, and how far its force was off where that was measured."""
    worst = max((law.errors or {"": np.nan}).values())
    return f"at once, in {seconds:.2f} s (±{worst:.0%}); settles when the hand rests"
